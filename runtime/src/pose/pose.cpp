// SPDX-License-Identifier: MIT
#include "runtime/src/pose/pose.h"

#include <cmath>

#include "runtime/src/base/status.h"

namespace spherechain {
namespace {

// Memory of `count` entries of `size` bytes.
MemoryRange range_of(const float* first, std::size_t count, std::size_t stride, std::size_t size) {
  if (first == nullptr || count == 0) {
    return {};
  }
  const auto begin = reinterpret_cast<std::uintptr_t>(first);
  return {begin, begin + (count - 1) * stride + size};
}

}  // namespace

Status check_matrices(const Pose& pose) {
  const std::size_t size = size_of(pose.bone_layout), stride = bone_stride(pose);
  return pose.bones == nullptr                          ? refuse(SC_NULL, SC_FIELD_BONES)
         : any_misaligned(pose.bones)                   ? refuse(SC_MISALIGNED, SC_FIELD_BONES)
         : size == 0                                    ? refuse(SC_BAD_VALUE, SC_FIELD_BONE_LAYOUT)
         : stride < size || stride % sizeof(float) != 0 ? refuse(SC_BAD_STRIDE, SC_FIELD_BONE_STRIDE)
                                                        : done();
}

Status check_bones(const AssetView& asset, const Pose& pose) {
  const Status status = check_matrices(pose);
  if (status != SC_OK) {
    return status;
  }
  const bool has_weights = pose.morph_weights != nullptr;
  return asset.bone_count() == 0                                        ? refuse(SC_NOT_IN_ASSET, SC_FIELD_BONES)
         : pose.bone_count < asset.bone_count()                         ? refuse(SC_TOO_SMALL, SC_FIELD_BONE_COUNT)
         : !has_weights && pose.morph_weight_count > 0                  ? refuse(SC_NULL, SC_FIELD_MORPH_WEIGHTS)
         : any_misaligned(pose.morph_weights)                           ? refuse(SC_MISALIGNED, SC_FIELD_MORPH_WEIGHTS)
         : has_weights && pose.morph_weight_count < asset.morph_count() ? refuse(SC_TOO_SMALL, SC_FIELD_MORPH_WEIGHTS)
                                                                        : done();
}

Status check_vertices(const Pose& pose, std::size_t wanted) {
  const std::size_t stride = vertex_stride(pose);
  return pose.vertices == nullptr                                ? refuse(SC_NULL, SC_FIELD_VERTICES)
         : any_misaligned(pose.vertices)                         ? refuse(SC_MISALIGNED, SC_FIELD_VERTICES)
         : stride < kPackedVertex || stride % sizeof(float) != 0 ? refuse(SC_BAD_STRIDE, SC_FIELD_VERTEX_STRIDE)
         : pose.vertex_count < wanted                            ? refuse(SC_TOO_SMALL, SC_FIELD_VERTEX_COUNT)
                                                                 : done();
}

Status check_skin_pose(const AssetView& asset, const Pose& pose) {
  if (pose.vertices != nullptr) {
    const Status status = check_vertices(asset, pose);
    if (status != SC_OK || pose.bones == nullptr) {
      return status;
    }
  }
  return check_bones(asset, pose);
}

double scale_of(const AssetView& asset, const Pose& pose) {
  constexpr double kRounding = 1e-3;
  std::size_t root = 0;
  while (root < asset.part_count() && (asset.part(root).parent >= 0 || asset.part(root).bone < 0)) {
    ++root;
  }
  if (pose.bones == nullptr || root == asset.part_count()) {
    return 1;
  }
  const BoneMatrices matrices = matrices_of(pose);
  const float* const matrix = matrices.data + static_cast<std::size_t>(asset.part(root).bone) * matrices.stride;
  double squares = 0;  // of a turn three
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      const double element = double{matrix[row * matrices.row + column * matrices.column]};
      squares += element * element;
    }
  }
  const double scale = std::sqrt(squares / 3);
  return !(scale > 0) || !std::isfinite(scale) || std::abs(scale - 1) < kRounding ? 1 : scale;
}

MemoryRange range_of_bones(const AssetView& asset, const Pose& pose) {
  return range_of(pose.bones, asset.bone_count(), bone_stride(pose), size_of(pose.bone_layout));
}

MemoryRange range_of_vertices(const AssetView& asset, const Pose& pose) {
  return range_of(pose.vertices, asset.vertex_count(), vertex_stride(pose), kPackedVertex);
}

MemoryRange range_of_morph_weights(const AssetView& asset, const Pose& pose) {
  return range_of(pose.morph_weights, asset.morph_count(), sizeof(float), sizeof(float));
}

}  // namespace spherechain

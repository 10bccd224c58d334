// SPDX-License-Identifier: MIT
#include "pose/pose.h"

#include "asset/status.h"
#include "asset/stride.h"

namespace spherechain {

Status check_bones(const AssetView& asset, const Pose& pose) {
  if (pose.bones == nullptr) {
    return refuse(SC_NULL, SC_FIELD_BONES);
  }
  if (any_misaligned(pose.bones)) {
    return refuse(SC_MISALIGNED, SC_FIELD_BONES);
  }
  if (size_of(pose.bone_layout) == 0) {
    return refuse(SC_BAD_VALUE, SC_FIELD_BONE_LAYOUT);
  }
  if (bone_stride(pose) < size_of(pose.bone_layout) || bone_stride(pose) % sizeof(float) != 0) {
    return refuse(SC_BAD_STRIDE, SC_FIELD_BONE_STRIDE);
  }
  if (asset.bone_count() == 0) {
    return refuse(SC_NOT_IN_ASSET, SC_FIELD_BONES);
  }
  if (pose.bone_count < asset.bone_count()) {
    return refuse(SC_TOO_SMALL, SC_FIELD_BONE_COUNT);
  }
  if (pose.morph_weights == nullptr) {
    return pose.morph_weight_count == 0 ? done() : refuse(SC_NULL, SC_FIELD_MORPH_WEIGHTS);
  }
  if (any_misaligned(pose.morph_weights)) {
    return refuse(SC_MISALIGNED, SC_FIELD_MORPH_WEIGHTS);
  }
  return pose.morph_weight_count >= asset.morph_count() ? done() : refuse(SC_TOO_SMALL, SC_FIELD_MORPH_WEIGHTS);
}

Status check_vertices(const AssetView& asset, const Pose& pose) {
  if (pose.vertices == nullptr) {
    return refuse(SC_NULL, SC_FIELD_VERTICES);
  }
  if (any_misaligned(pose.vertices)) {
    return refuse(SC_MISALIGNED, SC_FIELD_VERTICES);
  }
  if (!is_valid_stride(vertex_stride(pose))) {
    return refuse(SC_BAD_STRIDE, SC_FIELD_VERTEX_STRIDE);
  }
  return pose.vertex_count >= asset.vertex_count() ? done() : refuse(SC_TOO_SMALL, SC_FIELD_VERTEX_COUNT);
}

MemoryRange range_of_bones(const AssetView& asset, const Pose& pose) {
  if (pose.bones == nullptr || asset.bone_count() == 0) {
    return {};
  }
  const auto first = reinterpret_cast<std::uintptr_t>(pose.bones);
  return {first, first + (asset.bone_count() - 1) * bone_stride(pose) + size_of(pose.bone_layout)};
}

MemoryRange range_of_vertices(const AssetView& asset, const Pose& pose) {
  if (pose.vertices == nullptr || asset.vertex_count() == 0) {
    return {};
  }
  const auto first = reinterpret_cast<std::uintptr_t>(pose.vertices);
  return {first, first + (asset.vertex_count() - 1) * vertex_stride(pose) + 3 * sizeof(float)};
}

MemoryRange range_of_morph_weights(const AssetView& asset, const Pose& pose) {
  return range_of(Span<const float>{pose.morph_weights, pose.morph_weights == nullptr ? 0 : asset.morph_count()});
}

}  // namespace spherechain

// SPDX-License-Identifier: MIT
#include "crowd_access.h"

namespace spherechain::cuda {
namespace {

constexpr std::size_t kMostInstances = 0x7FFFFFFF;

template <typename T>
bool is_aligned(const T* pointer, std::size_t to) {
  return reinterpret_cast<std::uintptr_t>(pointer) % to == 0;
}

template <typename... T>
bool all_aligned(const T*... pointers) {
  return (is_aligned(pointers, alignof(T)) && ...);
}

Status check_bones(const CrowdGroup& group) {
  const std::size_t bones = group.tables->bone_count(), size = size_of(group.bones.layout);
  if (bones == 0) {
    return Status::kNotInAsset;
  }
  if (size == 0) {
    return Status::kBadArgument;
  }
  if (group.bones.count < bones) {
    return Status::kTooFewBones;
  }
  constexpr std::size_t kMostBytes = 0xFFFFFFFFU;
  const bool is_short = group.bones.stride < size || group.bones.stride > kMostBytes / bones ||
                        group.instance_stride < (bones - 1) * group.bones.stride + size;
  return is_short || group.bones.stride % sizeof(float) != 0 || group.instance_stride > kMostBytes ||
                 group.instance_stride % sizeof(float) != 0
             ? Status::kBadStride
             : Status::kOk;
}

Status check(const CrowdGroup& group) {
  if (group.tables == nullptr) {
    return Status::kNullArgument;
  }
  if (!group.tables->is_built()) {
    return Status::kNotOpen;
  }
  const bool from_bones = group.bones.data != nullptr;
  if (group.device_tables == nullptr || (group.instance_count > 0 && group.spheres == nullptr && !from_bones) ||
      (group.pairs != nullptr && group.pair_count == nullptr) ||
      (group.pairs != nullptr && group.instance_count > 0 && (group.counts == nullptr || group.starts == nullptr))) {
    return Status::kNullArgument;
  }
  if ((from_bones && group.spheres != nullptr) || (!from_bones && group.refitted != nullptr) ||
      (!from_bones && group.morph_weights != nullptr) || group.instance_count > kMostInstances ||
      group.stride > kMostInstances) {
    return Status::kBadArgument;
  }
  if (!is_aligned(group.device_tables, 16) ||
      !all_aligned(group.spheres, group.bones.data, group.morph_weights, group.refitted, group.bounds, group.counts,
                   group.bits, group.pairs, group.starts, group.pair_count)) {
    return Status::kMisaligned;
  }
  if (!from_bones && group.stride != 0 && group.stride < group.tables->sphere_count()) {
    return Status::kTooFewSpheres;
  }
  return from_bones ? check_bones(group) : Status::kOk;
}

MatrixSteps steps_of(MatrixLayout layout) {
  switch (layout) {
    case MatrixLayout::kColumnMajor4x4:
      return {1, 4};
    case MatrixLayout::kColumnMajor3x4:
      return {1, 3};
    default:
      return {4, 1};
  }
}

}  // namespace

Status view_group(const CrowdGroup& group, GroupView& view) {
  const Status status = check(group);
  if (status != Status::kOk) {
    return status;
  }
  view = Access::view(*group.tables, group.device_tables);
  view.instance_count = static_cast<std::uint32_t>(group.instance_count);
  view.spheres = group.spheres;
  view.sphere_stride = group.stride == 0 ? view.sphere_count : group.stride;
  view.wide_spheres = is_aligned(group.spheres, alignof(Float4));
  view.matrices = group.bones.data;
  view.morph_weights = view.morph_counts == nullptr ? nullptr : group.morph_weights;
  view.bone_stride = group.bones.stride / sizeof(float);
  view.instance_stride = group.instance_stride / sizeof(float);
  view.steps = steps_of(group.bones.layout);
  view.wide_matrices = view.steps.column == 1 && is_aligned(group.bones.data, alignof(Float4)) &&
                       group.bones.stride % sizeof(Float4) == 0 && group.instance_stride % sizeof(Float4) == 0;
  view.refitted = group.refitted;
  view.wide_refitted = is_aligned(group.refitted, alignof(Float4));
  view.bounds = group.bounds;
  view.counts = group.counts;
  view.bits = group.bits;
  view.pairs = group.pairs;
  view.pair_capacity = group.pair_capacity;
  view.starts = group.starts;
  view.pair_count = group.pair_count;
  return Status::kOk;
}

}  // namespace spherechain::cuda

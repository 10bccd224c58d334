// SPDX-License-Identifier: MIT
#include <algorithm>

#include "crowd_access.h"
#include "crowd_own.h"

namespace spherechain::cuda {
namespace {

constexpr std::size_t kMostInstances = 0x7FFFFFFF;
constexpr std::size_t kMostBlockBytes = 0xFFFFFFFF;  // which SharedLayout's places reach

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
  const bool has_covers = group.tables->leaf_count() > 0;
  if ((has_covers ? group.spheres != nullptr : group.leaves != nullptr) || (from_bones && group.spheres != nullptr) ||
      (!from_bones && group.refitted != nullptr) || (!from_bones && group.morph_weights != nullptr) ||
      group.instance_count > kMostInstances || group.stride > kMostInstances) {
    return Status::kBadArgument;
  }
  if (!is_aligned(group.device_tables, 16) || !is_aligned(static_cast<const char*>(group.scratch), 16) ||
      !all_aligned(group.spheres, group.bones.data, group.morph_weights, group.refitted, group.leaves, group.bounds,
                   group.counts, group.bits, group.pairs, group.starts, group.pair_count)) {
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

// One thing after another.
struct Bytes {
  std::size_t used = 0;

  void take(std::uint32_t& at, std::size_t bytes) {
    at = static_cast<std::uint32_t>(used);
    used += (bytes + 15) / 16 * 16;
  }
};

SharedLayout layout_of_bones(const GroupView& v) {
  constexpr std::size_t kFigures = kPitch * sizeof(float);
  const std::size_t table = half_words(v) * kFigures;
  SharedLayout out{};
  Bytes before, after;
  before.take(out.matrices, std::size_t{3} * v.used_bone_count * kPitch * sizeof(Float4));
  before.take(out.morph_weights, v.morph_weights != nullptr ? v.morph_count * kFigures : 0);
  before.take(out.bone_sizes, v.cover_entries != nullptr ? v.used_bone_count * kPitch * sizeof(BoneSize) : 0);
  before.take(out.reference, v.runs != nullptr ? 3 * kFigures : 0);
  after.take(out.powers, sphere_places(v) * kFigures);
  after.take(out.bits, v.bits != nullptr ? table : 0);
  after.take(out.ordered_bits, v.pairs != nullptr ? table : 0);
  const bool queues = has_queue(v.sphere_count, v.cover_entries != nullptr);
  after.take(out.queue, queues ? kBlockQueued * sizeof(std::uint32_t) : 0);
  Bytes all{std::max(before.used, after.used)};
  all.take(out.spheres, std::size_t{sphere_places(v)} * kPitch * sizeof(Float4));
  all.take(out.counts, kLanes * sizeof(std::uint32_t));
  all.take(out.dealt, 3 * sizeof(std::uint32_t));
  all.take(out.parts, v.pairs != nullptr ? (kMostWarps * kLanes + 4) * sizeof(std::uint32_t) : 0);
  all.take(out.boxes, v.bounds != nullptr ? 6 * kMostWarps * kLanes * sizeof(float) : 0);
  all.take(out.radii, v.bounds != nullptr ? kLanes * sizeof(std::uint32_t) : 0);
  out.size = all.used;
  return out;
}

SharedLayout layout_of_spheres(const GroupView& v) {
  const std::size_t places = lanes_of(v.sphere_count);
  SharedLayout out{};
  Bytes own{sizeof(OwnState)};
  own.take(out.own_seen, std::size_t{4} * seen_pitch(v) * sizeof(float));
  own.take(out.own_powers, 2 * places * sizeof(float));
  own.take(out.own_bits, v.bits != nullptr ? v.bit_words * sizeof(std::uint64_t) : 0);
  own.take(out.own_ordered_bits, v.pairs != nullptr ? v.bit_words * sizeof(std::uint64_t) : 0);
  own.take(out.own_boxes, v.bounds != nullptr ? kBoxFigures * kLanes * sizeof(float) : 0);
  own.take(out.own_parts, v.pairs != nullptr ? kLanes * sizeof(std::uint32_t) : 0);
  own.take(out.own_spheres, places * sizeof(Float4));
  out.own_size = static_cast<std::uint32_t>(own.used);
  out.size = kMostWarps * own.used;
  return out;
}

}  // namespace

SharedLayout layout_of(const GroupView& v) { return v.matrices != nullptr ? layout_of_bones(v) : layout_of_spheres(v); }

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
  view.morph_weights = view.has_morphs ? group.morph_weights : nullptr;
  view.bone_stride = static_cast<std::uint32_t>(group.bones.stride / sizeof(float));
  view.instance_stride = static_cast<std::uint32_t>(group.instance_stride / sizeof(float));
  view.steps = steps_of(group.bones.layout);
  view.wide_matrices = view.steps.column == 1 && is_aligned(group.bones.data, alignof(Float4)) &&
                       group.bones.stride % sizeof(Float4) == 0 && group.instance_stride % sizeof(Float4) == 0;
  view.refitted = group.refitted;
  view.wide_refitted = is_aligned(group.refitted, alignof(Float4));
  view.leaves = group.leaves;
  view.wide_leaves = is_aligned(group.leaves, alignof(Float4));
  view.bounds = group.bounds;
  view.counts = group.counts;
  view.bits = group.bits;
  view.pairs = group.pairs;
  view.pair_capacity = group.pair_capacity;
  view.starts = group.starts;
  view.pair_count = group.pair_count;
  view.scratch = static_cast<unsigned char*>(group.scratch);
  view.scratch_bytes = group.scratch_bytes;
  view.layout = layout_of(view);
  return Status::kOk;
}

Status view_groups(Span<const CrowdGroup> groups, Launch& all) {
  if (groups.data == nullptr && groups.size > 0) {
    return Status::kNullArgument;
  }
  if (groups.size > CrowdJob::kMostGroups) {
    return Status::kBadArgument;
  }
  all.count = 0;
  for (const CrowdGroup& group : groups) {
    const Status status = view_group(group, all.views[all.count]);
    if (status != Status::kOk) {
      return status;
    }
    all.count += group.instance_count > 0 ? 1U : 0U;
  }
  return Status::kOk;
}

Status plan_launches(const Launch& all, std::size_t most_shared_bytes, LaunchPlan& plan) {
  plan = {};
  for (std::uint32_t g = 0; g < all.count; ++g) {
    GroupView view = all.views[g];
    const std::size_t bytes = view.layout.size;
    if (bytes <= most_shared_bytes) {
      view.first_block = plan.shared_blocks;
      plan.shared_blocks += blocks_of(view);
      plan.shared_bytes = std::max(plan.shared_bytes, bytes);
      plan.in_shared.views[plan.in_shared.count++] = view;
      continue;
    }
    if (view.scratch == nullptr || bytes > kMostBlockBytes) {
      return Status::kDeviceTooSmall;
    }
    if (view.scratch_bytes < bytes) {
      return Status::kContextTooSmall;
    }
    const std::size_t blocks = std::min<std::size_t>(view.scratch_bytes / bytes, blocks_of(view));
    view.wide_matrices = view.wide_spheres = false;  // those are copied into shared memory by an instruction of its own
    view.scratch_blocks = static_cast<std::uint32_t>(blocks);
    view.first_block = plan.scratch_blocks;
    plan.scratch_blocks += view.scratch_blocks;
    plan.in_scratch.views[plan.in_scratch.count++] = view;
  }
  return Status::kOk;
}

}  // namespace spherechain::cuda

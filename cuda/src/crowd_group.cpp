// SPDX-License-Identifier: MIT
// Checks groups and deals them to kernels: all of CrowdJob::run that needs no device.
#include <algorithm>
#include <type_traits>

#include "crowd_launch.h"

namespace spherechain::cuda {
namespace {

constexpr std::size_t kInstancesMax = 0x7FFFFFFF;
constexpr std::size_t kUintMax = 0xFFFFFFFF;  // what strides and BlockLayout's offsets hold

template <typename... Pointers>
bool are_aligned(std::size_t to, Pointers... pointers) {
  return ((reinterpret_cast<std::uintptr_t>(pointers) % to == 0) && ...);
}

Status check_bones(const CrowdGroup& group) {
  const std::size_t bones = header_of(*group.tables).bone_count, size = size_of(group.bones.layout);
  const std::size_t stride = group.bones.stride, instance_stride = group.instance_stride;
  if (bones == 0) {
    return Status::kNotInAsset;
  }
  if (size == 0) {
    return Status::kBadArgument;
  }
  if (group.bones.count < bones) {
    return Status::kTooFewBones;
  }
  const bool is_right = stride % sizeof(float) == 0 && stride >= size && stride <= kUintMax / bones &&
                        instance_stride % sizeof(float) == 0 && instance_stride >= (bones - 1) * stride + size &&
                        instance_stride <= kUintMax;
  return is_right ? Status::kOk : Status::kBadStride;
}

Status check(const CrowdGroup& group) {
  if (group.tables == nullptr) {
    return Status::kNullArgument;
  }
  if (group.tables->words.size == 0) {
    return Status::kNotOpen;
  }
  const bool from_bones = group.bones.data != nullptr, has_list = group.pairs != nullptr;
  if (group.device_tables == nullptr || (has_list && group.pair_count == nullptr) ||
      (group.instance_count > 0 && ((group.spheres == nullptr && !from_bones) ||
                                    (has_list && (group.counts == nullptr || group.starts == nullptr))))) {
    return Status::kNullArgument;
  }
  if ((from_bones ? group.spheres != nullptr : group.refitted != nullptr) || group.instance_count > kInstancesMax ||
      group.stride > kInstancesMax) {
    return Status::kBadArgument;
  }
  if (!are_aligned(16, group.device_tables, group.spheres, group.refitted, group.scratch) ||
      !are_aligned(8, group.bits, group.starts, group.pair_count) ||
      !are_aligned(4, group.bones.data, group.counts, group.pairs)) {
    return Status::kMisaligned;
  }
  if (!from_bones && group.stride != 0 && group.stride < header_of(*group.tables).sphere_count) {
    return Status::kTooFewSpheres;
  }
  return from_bones ? check_bones(group) : Status::kOk;
}

MatrixSteps steps_of(MatrixLayout layout) {
  return layout == MatrixLayout::kColumnMajor4x4   ? MatrixSteps{1, 4}
         : layout == MatrixLayout::kColumnMajor3x4 ? MatrixSteps{1, 3}
                                                   : MatrixSteps{4, 1};
}

// Places one after another.
struct Bytes {
  std::size_t used = 0;

  void take(std::uint32_t& at, std::size_t bytes) {
    at = static_cast<std::uint32_t>(used);
    used += (bytes + 15) / 16 * 16;
  }
};

BlockLayout layout_of_bones(const GroupView& v) {
  constexpr std::size_t kFigures = kPitch * sizeof(float);
  const std::size_t bits = half_words(v) * kFigures;
  BlockLayout out{};
  Bytes before, after;
  before.take(out.matrices, std::size_t{3} * v.used_bone_count * kPitch * sizeof(Float4));
  before.take(out.reference, 3 * kFigures);
  after.take(out.powers, sphere_places(v) * kFigures);
  after.take(out.bits, v.bits != nullptr ? bits : 0);
  after.take(out.ordered_bits, v.pairs != nullptr ? bits : 0);
  after.take(out.queue, has_queue(v.sphere_count) ? kBlockQueued * sizeof(std::uint32_t) : 0);
  Bytes all{std::max(before.used, after.used)};
  all.take(out.spheres, std::size_t{sphere_places(v)} * kPitch * sizeof(Float4));
  all.take(out.counts, kLanes * sizeof(std::uint32_t));
  all.take(out.dealt, 3 * sizeof(std::uint32_t));
  all.take(out.parts, v.pairs != nullptr ? (kWarpsMax * kLanes + 4) * sizeof(std::uint32_t) : 0);
  out.size = all.used;
  return out;
}

BlockLayout layout_of_spheres(const GroupView& v) {
  const std::size_t places = lanes_of(v.sphere_count);
  BlockLayout out{};
  Bytes warp{sizeof(WarpState)};
  warp.take(out.warp_seen, std::size_t{4} * seen_pitch(v) * sizeof(float));
  warp.take(out.warp_powers, 2 * places * sizeof(float));
  warp.take(out.warp_bits, v.bits != nullptr ? v.bit_words * sizeof(std::uint64_t) : 0);
  warp.take(out.warp_ordered_bits, v.pairs != nullptr ? v.bit_words * sizeof(std::uint64_t) : 0);
  warp.take(out.warp_parts, v.pairs != nullptr ? kLanes * sizeof(std::uint32_t) : 0);
  warp.take(out.warp_spheres, places * sizeof(Float4));
  out.warp_size = static_cast<std::uint32_t>(warp.used);
  out.size = kWarpsMax * warp.used;
  return out;
}

// The tables' entries, of the copy that lies at `words`.
void view_tables(const TableHeader& header, const std::uint64_t* words, GroupView& v) {
  const auto point = [&](auto*& to, std::uint32_t place) {
    to = reinterpret_cast<std::remove_reference_t<decltype(to)>>(words + place);
  };
  point(v.paddings, header.paddings);
  point(v.items, header.items);
  point(v.unit_places, header.unit_places);
  point(v.wanted, header.wanted);
  point(v.rest_pairs, header.rest_pairs);
  point(v.used_bones, header.used_bones);
  point(v.runs, header.runs);
  point(v.moment_steps, header.moment_steps);
  point(v.moments, header.moments);
  point(v.run_bones, header.run_bones);
  point(v.run_spheres, header.run_spheres);
  point(v.center_terms, header.center_terms);
  v.origin = header.origin;
  v.sphere_count = header.sphere_count;
  v.used_bone_count = header.used_bone_count;
  v.item_count = header.item_count;
  v.rest_pair_count = header.rest_pair_count;
  v.run_count = header.run_count;
  v.bit_words = header.bit_words;
  v.reference = header.reference;
  v.origin_sphere = header.origin_sphere;
  v.has_padding = header.has_padding != 0;
}

}  // namespace

BlockLayout layout_of(const GroupView& v) { return v.matrices != nullptr ? layout_of_bones(v) : layout_of_spheres(v); }

std::size_t CrowdTables::block_bytes(bool from_bones, bool with_bits, bool with_pairs) const noexcept {
  alignas(16) static std::uint64_t something[2];  // it only matters what is null
  if (words.size == 0) {
    return 0;
  }
  GroupView v{};
  view_tables(header_of(*this), something, v);
  v.matrices = from_bones ? reinterpret_cast<const float*>(something) : nullptr;
  v.bits = with_bits ? something : nullptr;
  v.pairs = with_pairs ? reinterpret_cast<CrowdPair*>(something) : nullptr;
  return layout_of(v).size;
}

Status view_group(const CrowdGroup& group, GroupView& view) {
  const Status status = check(group);
  if (status != Status::kOk) {
    return status;
  }
  view = {};
  view_tables(header_of(*group.tables), group.device_tables, view);
  view.instance_count = static_cast<std::uint32_t>(group.instance_count);
  view.spheres = group.spheres;
  view.sphere_stride = group.stride == 0 ? view.sphere_count : group.stride;
  view.matrices = group.bones.data;
  view.bone_stride = static_cast<std::uint32_t>(group.bones.stride / sizeof(float));
  view.instance_stride = static_cast<std::uint32_t>(group.instance_stride / sizeof(float));
  view.steps = steps_of(group.bones.layout);
  view.wide_matrices = view.steps.column == 1 && are_aligned(16, group.bones.data) &&
                       group.bones.stride % sizeof(Float4) == 0 && group.instance_stride % sizeof(Float4) == 0;
  view.refitted = group.refitted;
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
  if (groups.size > CrowdJob::kGroupsMax) {
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

Status plan_launches(const Launch& all, std::size_t shared_bytes_max, LaunchPlan& plan) {
  plan = {};
  for (std::uint32_t g = 0; g < all.count; ++g) {
    GroupView view = all.views[g];
    const std::size_t bytes = view.layout.size;
    const bool in_scratch = bytes > shared_bytes_max;
    std::size_t blocks = blocks_of(view);
    if (in_scratch) {
      if (view.scratch == nullptr || bytes > kUintMax) {
        return Status::kDeviceTooSmall;
      }
      if (view.scratch_bytes < bytes) {
        return Status::kContextTooSmall;
      }
      blocks = std::min(view.scratch_bytes / bytes, blocks);
      view.scratch_blocks = static_cast<std::uint32_t>(blocks);
      view.in_scratch = true;
    }
    Launch& launch = plan[in_scratch ? Kernel::kScratch : view.matrices == nullptr ? Kernel::kSpheres : Kernel::kBones];
    view.first_block = launch.blocks;
    launch.blocks += static_cast<std::uint32_t>(blocks);
    launch.shared_bytes = std::max(launch.shared_bytes, in_scratch ? 0 : bytes);
    launch.views[launch.count++] = view;
  }
  return Status::kOk;
}

}  // namespace spherechain::cuda

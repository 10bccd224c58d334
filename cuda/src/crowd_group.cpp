// SPDX-License-Identifier: MIT
// Checks groups and deals them to kernels: all of enqueue_crowds() that needs no device.
#include <algorithm>
#include <type_traits>

#include "asset/status.h"
#include "crowd_launch.h"
#include "pose/pose.h"

namespace spherechain::cuda {
namespace {

constexpr std::size_t kInstancesMax = 0x7FFFFFFF;
constexpr std::size_t kUintMax = 0xFFFFFFFF;  // what strides and BlockLayout's offsets hold

bool is_aligned(const void* pointer, std::size_t to) { return reinterpret_cast<std::uintptr_t>(pointer) % to == 0; }

// As a whole, where it is 0 in the group.
std::size_t stride_of(const CrowdGroup& group) {
  const TableHeader& header = header_of(group.table);
  return group.instance_stride != 0    ? group.instance_stride
         : group.pose.bones != nullptr ? header.bone_count * bone_stride(group.pose)
                                       : header.sphere_count;
}

Status check_bones(const CrowdGroup& group) {
  const std::size_t bones = header_of(group.table).bone_count, size = size_of(group.pose.bone_layout);
  const std::size_t stride = bone_stride(group.pose), instance_stride = stride_of(group);
  if (bones == 0) {
    return refuse(SC_NOT_IN_ASSET, SC_FIELD_BONES);
  }
  if (size == 0) {
    return refuse(SC_BAD_VALUE, SC_FIELD_BONE_LAYOUT);
  }
  if (group.pose.bone_count < bones) {
    return refuse(SC_TOO_SMALL, SC_FIELD_BONE_COUNT);
  }
  if (stride % sizeof(float) != 0 || stride < size || stride > kUintMax / bones) {
    return refuse(SC_BAD_STRIDE, SC_FIELD_BONE_STRIDE);
  }
  const bool is_right = instance_stride % sizeof(float) == 0 && instance_stride >= (bones - 1) * stride + size &&
                        instance_stride <= kUintMax;
  return is_right ? done() : refuse(SC_BAD_STRIDE, SC_FIELD_INSTANCE_STRIDE);
}

Status check_alignment(const CrowdGroup& group) {
  const struct {
    const void* pointer;
    std::size_t to;
    sc_field field;
  } all[] = {{group.device_table, 16, SC_FIELD_TABLE}, {group.spheres, 16, SC_FIELD_SPHERES},
             {group.pose.bones, 4, SC_FIELD_BONES},    {group.refitted, 16, SC_FIELD_OUTPUT},
             {group.counts, 4, SC_FIELD_COUNTS},       {group.bits, 8, SC_FIELD_BITS},
             {group.pairs, 4, SC_FIELD_PAIRS},         {group.starts, 8, SC_FIELD_PAIRS},
             {group.pair_count, 8, SC_FIELD_PAIRS},    {group.scratch, 16, SC_FIELD_SCRATCH}};
  for (const auto& one : all) {
    if (!is_aligned(one.pointer, one.to)) {
      return refuse(SC_MISALIGNED, one.field);
    }
  }
  return done();
}

Status check_list(const CrowdGroup& group) {
  const bool is_empty = group.instance_count == 0;
  if (group.pair_count == nullptr || (group.starts == nullptr && !is_empty)) {
    return refuse(SC_NULL, SC_FIELD_PAIRS);
  }
  return group.counts == nullptr && !is_empty ? refuse(SC_NULL, SC_FIELD_COUNTS) : done();
}

Status check(const CrowdGroup& group) {
  if (group.table == nullptr || group.device_table == nullptr) {
    return refuse(SC_NULL, SC_FIELD_TABLE);
  }
  if (header_of(group.table).magic != kTableMagic) {
    return refuse(SC_BAD_VALUE, SC_FIELD_TABLE);
  }
  const bool from_bones = group.pose.bones != nullptr;
  if (group.spheres == nullptr && !from_bones && group.instance_count > 0) {
    return refuse(SC_NULL, SC_FIELD_SPHERES);
  }
  const sc_field bad = group.instance_count > kInstancesMax              ? SC_FIELD_INSTANCES
                       : group.pose.vertices != nullptr                  ? SC_FIELD_VERTICES
                       : from_bones && group.spheres != nullptr          ? SC_FIELD_SPHERES
                       : !from_bones && group.refitted != nullptr        ? SC_FIELD_OUTPUT
                       : !from_bones && stride_of(group) > kInstancesMax ? SC_FIELD_INSTANCE_STRIDE
                                                                         : SC_FIELD_NONE;
  if (bad != SC_FIELD_NONE) {
    return refuse(SC_BAD_VALUE, bad);
  }
  Status status = check_alignment(group);
  if (status == SC_OK && group.pairs != nullptr) {
    status = check_list(group);
  }
  if (status == SC_OK && from_bones) {
    status = check_bones(group);
  }
  const bool is_right = from_bones || stride_of(group) >= header_of(group.table).sphere_count;
  return status != SC_OK || is_right ? status : refuse(SC_BAD_STRIDE, SC_FIELD_INSTANCE_STRIDE);
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

// The table's entries, of the copy that lies at `words`.
void view_table(const TableHeader& header, const std::uint64_t* words, GroupView& v) {
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
  static_cast<TableFigures&>(v) = header;
}

}  // namespace

BlockLayout layout_of(const GroupView& v) {
  return v.pose.bones != nullptr ? layout_of_bones(v) : layout_of_spheres(v);
}

std::size_t crowd_block_bytes(const std::uint64_t* table, bool from_bones, bool with_bits, bool with_pairs) noexcept {
  alignas(16) static std::uint64_t something[2];  // it only matters what is null
  if (table == nullptr || header_of(table).magic != kTableMagic) {
    return 0;
  }
  GroupView v{};
  view_table(header_of(table), something, v);
  v.pose.bones = from_bones ? reinterpret_cast<const float*>(something) : nullptr;
  v.bits = with_bits ? something : nullptr;
  v.pairs = with_pairs ? reinterpret_cast<CrowdPair*>(something) : nullptr;
  return layout_of(v).size;
}

Status view_group(const CrowdGroup& group, GroupView& view) {
  const Status status = check(group);
  if (status != SC_OK) {
    return status;
  }
  view = {};
  static_cast<CrowdGroup&>(view) = group;
  view_table(header_of(group.table), group.device_table, view);
  const BoneMatrices matrices = matrices_of(group.pose);
  const std::size_t stride = stride_of(group);
  view.instances = static_cast<std::uint32_t>(group.instance_count);
  view.sphere_stride = stride;
  view.bone_floats = static_cast<std::uint32_t>(matrices.stride);
  view.instance_floats = static_cast<std::uint32_t>(stride / sizeof(float));
  view.steps = {static_cast<std::uint32_t>(matrices.row), static_cast<std::uint32_t>(matrices.column)};
  view.wide_matrices = view.steps.column == 1 && is_aligned(matrices.data, 16) &&
                       matrices.stride * sizeof(float) % sizeof(Float4) == 0 && stride % sizeof(Float4) == 0;
  view.layout = layout_of(view);
  return done();
}

Status view_groups(const CrowdGroup* groups, std::size_t count, Launch& all) {
  if (count > kCrowdGroupsMax || (groups == nullptr && count > 0)) {
    return refuse(groups == nullptr ? SC_NULL : SC_BAD_VALUE, SC_FIELD_INSTANCES);
  }
  all.count = 0;
  for (std::size_t g = 0; g < count; ++g) {
    const Status status = view_group(groups[g], all.views[all.count]);
    if (status != SC_OK) {
      return status;
    }
    all.count += groups[g].instance_count > 0 ? 1U : 0U;
  }
  return done();
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
        return refuse(SC_DEVICE_TOO_SMALL, SC_FIELD_SCRATCH);
      }
      if (view.scratch_bytes < bytes) {
        return refuse(SC_TOO_SMALL, SC_FIELD_SCRATCH);
      }
      blocks = std::min(view.scratch_bytes / bytes, blocks);
      view.scratch_blocks = static_cast<std::uint32_t>(blocks);
      view.in_scratch = true;
    }
    Launch& launch = plan[in_scratch                   ? Kernel::kScratch
                          : view.pose.bones == nullptr ? Kernel::kSpheres
                                                       : Kernel::kBones];
    view.first_block = launch.blocks;
    launch.blocks += static_cast<std::uint32_t>(blocks);
    launch.shared_bytes = std::max(launch.shared_bytes, in_scratch ? 0 : bytes);
    launch.views[launch.count++] = view;
  }
  return done();
}

}  // namespace spherechain::cuda

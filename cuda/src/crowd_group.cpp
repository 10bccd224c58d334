// SPDX-License-Identifier: MIT
// Checks groups and deals them to kernels: all of enqueue_crowds() that needs no device.
#include <algorithm>
#include <type_traits>

#include "crowd_launch.h"
#include "runtime/src/base/status.h"
#include "runtime/src/pose/pose.h"

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
  return first_of({
      {size == 0, SC_BAD_VALUE, SC_FIELD_BONE_LAYOUT},
      {group.pose.bone_count < bones, SC_TOO_SMALL, SC_FIELD_BONE_COUNT},
      {stride % sizeof(float) != 0 || stride < size || stride > kUintMax / bones, SC_BAD_STRIDE, SC_FIELD_BONE_STRIDE},
      {instance_stride % sizeof(float) != 0 || instance_stride < (bones - 1) * stride + size ||
           instance_stride > kUintMax,
       SC_BAD_STRIDE, SC_FIELD_INSTANCE_STRIDE},
  });
}

Status check(const CrowdGroup& group) {
  if (group.table == nullptr || group.device_table == nullptr) {
    return refuse(SC_NULL, SC_FIELD_TABLE);
  }
  if (header_of(group.table).magic != kTableMagic) {
    return refuse(SC_BAD_VALUE, SC_FIELD_TABLE);
  }
  const bool from_bones = group.pose.bones != nullptr, has_list = group.pairs != nullptr;
  const bool has_instances = group.instance_count > 0;
  const Status status = first_of({
      {!from_bones && has_instances && group.spheres == nullptr, SC_NULL, SC_FIELD_SPHERES},
      {group.instance_count > kInstancesMax, SC_BAD_VALUE, SC_FIELD_INSTANCES},
      {group.pose.vertices != nullptr, SC_BAD_VALUE, SC_FIELD_VERTICES},
      {from_bones && group.spheres != nullptr, SC_BAD_VALUE, SC_FIELD_SPHERES},
      {!from_bones && group.refitted != nullptr, SC_BAD_VALUE, SC_FIELD_OUTPUT},
      {!from_bones && stride_of(group) > kInstancesMax, SC_BAD_VALUE, SC_FIELD_INSTANCE_STRIDE},
      {!is_aligned(group.device_table, 16), SC_MISALIGNED, SC_FIELD_TABLE},
      {!is_aligned(group.spheres, 16), SC_MISALIGNED, SC_FIELD_SPHERES},
      {!is_aligned(group.pose.bones, 4), SC_MISALIGNED, SC_FIELD_BONES},
      {!is_aligned(group.refitted, 16), SC_MISALIGNED, SC_FIELD_OUTPUT},
      {!is_aligned(group.counts, 4), SC_MISALIGNED, SC_FIELD_COUNTS},
      {!is_aligned(group.bits, 8), SC_MISALIGNED, SC_FIELD_BITS},
      {any_misaligned(group.pairs, group.starts, group.pair_count), SC_MISALIGNED, SC_FIELD_PAIRS},
      {!is_aligned(group.scratch, 16), SC_MISALIGNED, SC_FIELD_SCRATCH},
      {has_list && group.pair_count == nullptr, SC_NULL, SC_FIELD_PAIRS},
      {has_list && has_instances && group.starts == nullptr, SC_NULL, SC_FIELD_PAIRS},
      {has_list && has_instances && group.counts == nullptr, SC_NULL, SC_FIELD_COUNTS},
      {!from_bones && stride_of(group) < header_of(group.table).sphere_count, SC_BAD_STRIDE, SC_FIELD_INSTANCE_STRIDE},
  });
  return status == SC_OK && from_bones ? check_bones(group) : status;
}

// Places one after another, each at a multiple of 16.
struct Bytes {
  std::size_t used = 0;

  template <typename T>
  void take(Offset<T>& to, std::size_t count) {
    to.bytes = static_cast<std::uint32_t>(used);
    used += (count * sizeof(T) + 15) / 16 * 16;
  }
};

BlockLayout layout_of_bones(const TableFigures& t, const BlockUse& use) {
  const std::size_t bits = std::size_t{half_words(t)} * kPitch, places = std::size_t{sphere_places(t)} * kPitch;
  BlockLayout out{};
  Bytes before, after;
  before.take(out.matrices, std::size_t{3} * t.used_bone_count * kPitch);
  before.take(out.reference, 3 * kPitch);
  after.take(out.powers, places);
  after.take(out.bits, use.bits ? bits : 0);
  after.take(out.ordered_bits, use.pairs ? bits : 0);
  after.take(out.queue, has_queue(t.sphere_count) ? kBlockQueued : 0);
  Bytes all{std::max(before.used, after.used)};
  all.take(out.spheres, places);
  all.take(out.counts, kLanes);
  all.take(out.dealt, 3);
  all.take(out.start, use.pairs ? 1 : 0);
  all.take(out.parts, use.pairs ? kWarpsMax * kLanes : 0);
  out.size = all.used;
  return out;
}

BlockLayout layout_of_spheres(const TableFigures& t, const BlockUse& use) {
  const std::size_t places = lanes_of(t.sphere_count);
  BlockLayout out{};
  Bytes warp{sizeof(WarpState)};
  warp.take(out.seen, std::size_t{4} * seen_pitch(t));
  warp.take(out.powers, 2 * places);
  warp.take(out.bits, use.bits ? half_words(t) : 0);
  warp.take(out.ordered_bits, use.pairs ? half_words(t) : 0);
  warp.take(out.parts, use.pairs ? kLanes : 0);
  warp.take(out.spheres, places);
  out.warp_size = static_cast<std::uint32_t>(warp.used);
  out.size = kWarpsMax * warp.used;
  return out;
}

// The table's entries, of the copy that lies at `words`.
void view_table(const TableHeader& header, const std::uint64_t* words, GroupView& v) {
  const auto point = [&](auto*& to, std::uint32_t place) {
    to = reinterpret_cast<std::remove_reference_t<decltype(to)>>(words + place);
  };
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

BlockLayout layout_of(const TableFigures& table, const BlockUse& use) {
  return use.bones ? layout_of_bones(table, use) : layout_of_spheres(table, use);
}

std::size_t crowd_block_bytes(const std::uint64_t* table, bool from_bones, bool with_bits, bool with_pairs) noexcept {
  return table == nullptr || header_of(table).magic != kTableMagic
             ? 0
             : layout_of(header_of(table), {from_bones, with_bits, with_pairs}).size;
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
  view.instance_stride = stride;
  view.bone_floats = static_cast<std::uint32_t>(matrices.stride);
  view.instance_floats = static_cast<std::uint32_t>(stride / sizeof(float));
  view.row_step = static_cast<std::uint32_t>(matrices.row);
  view.column_step = static_cast<std::uint32_t>(matrices.column);
  view.wide_matrices = view.column_step == 1 && is_aligned(matrices.data, 16) &&
                       matrices.stride * sizeof(float) % sizeof(Float4) == 0 && stride % sizeof(Float4) == 0;
  view.layout = layout_of(view, {group.pose.bones != nullptr, group.bits != nullptr, group.pairs != nullptr});
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

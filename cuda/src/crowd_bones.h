// SPDX-License-Identifier: MIT
// The kernel for bones: from the caller's matrices to the ones that moments are multiplied with.
#pragma once

#include "crowd_primitives.h"
#include "runtime/src/asset/moment_tables.h"

namespace spherechain::cuda {

SPHERECHAIN_HD std::uint32_t instances_in(const GroupView& v, const Place& at) {
  const std::uint32_t most = block_instances(v), left = static_cast<std::uint32_t>(v.instance_count) - at.block * most;
  return left < most ? left : most;
}

// Step 1. Each warp takes some instances and reads their figures in the order in which they lie. Lanes past the last
// instance repeat it; their results are not written.
SPHERECHAIN_HD void load_matrices(const GroupView& v, const Shared& shared, const Place& at) {
  if (at.thread < 3) {
    shared.dealt[at.thread] = 0;
  }
  const std::uint32_t last = instances_in(v, at) - 1;
  const float* const first = v.pose.bones + std::size_t{at.block} * kLanes * v.instance_floats;
  if (v.wide_matrices && !v.in_scratch) {
    for (std::uint32_t i = at.lane(); i < 3 * v.used_bone_count; i += kLanes) {
      const float* const row = first + (v.used_bones[i / 3] * v.bone_floats + i % 3 * v.row_step);
      Float4* const to = shared.matrices + i * kPitch;
      SPHERECHAIN_UNROLL
      for (std::uint32_t turn = 0; turn * at.warps() < kLanes; ++turn) {
        const std::uint32_t place = turn * at.warps() + at.warp();
        if (place < kLanes) {
          copy_past_cache(to + place, row + std::size_t{place < last ? place : last} * v.instance_floats);
        }
      }
    }
  } else {
    for (std::uint32_t i = at.lane(); i < 12 * v.used_bone_count; i += kLanes) {
      const std::uint32_t figure =
          v.used_bones[i / 12] * v.bone_floats + i / 4 % 3 * v.row_step + i % 4 * v.column_step;
      for (std::uint32_t to = at.warp(); to < kLanes; to += at.warps()) {
        (&shared.matrices[i / 4 * kPitch + to].x)[i % 4] =
            first[std::size_t{to < last ? to : last} * v.instance_floats + figure];
      }
    }
  }
  wait_for_copies();
}

SPHERECHAIN_HD float move_origin(const GroupView& v, const Float4& row) {
  return fused(row.z, v.origin.z, fused(row.y, v.origin.y, fused(row.x, v.origin.x, row.w)));
}

// Step 2. Where the reference bone has the origin.
SPHERECHAIN_HD void find_reference(const GroupView& v, const Shared& shared, const Place& at) {
  if (at.warp() == 0) {
    for (std::uint32_t i = 0; i < 3; ++i) {
      shared.reference[i * kPitch + at.lane()] =
          move_origin(v, shared.matrices[(3 * v.reference + i) * kPitch + at.lane()]);
    }
  }
}

// Figures nearer to 0 than that become 0. NaN stays.
SPHERECHAIN_HD float without_tiny(float x) { return fabsf(x) < kMinMatrixFigure ? 0.0F : x; }

// Step 3, a warp a bone. A translation becomes the origin's image, relative to the reference bone's.
SPHERECHAIN_HD void center_matrices(const GroupView& v, const Shared& shared, const Place& at) {
  for (std::uint32_t bone = at.warp(); bone < v.used_bone_count; bone += at.warps()) {
    SPHERECHAIN_UNROLL
    for (std::uint32_t i = 0; i < 3; ++i) {
      Float4& row = shared.matrices[(3 * bone + i) * kPitch + at.lane()];
      const float w = move_origin(v, row) - shared.reference[i * kPitch + at.lane()];
      row = {without_tiny(row.x), without_tiny(row.y), without_tiny(row.z), without_tiny(w)};
    }
  }
}

struct Matrix {
  float at[3][4];
};

// `place`: of MomentRun's steps or bones.
SPHERECHAIN_HD Matrix matrix_at(const Shared& shared, std::uint32_t lane, std::uint32_t place) {
  const auto* bytes = reinterpret_cast<const unsigned char*>(shared.matrices + lane);
  const auto* rows = reinterpret_cast<const Float4*>(bytes + (place & kMatrixMask));
  const Float4 x = rows[0], y = rows[kPitch], z = rows[2 * kPitch];
  return {{{x.x, x.y, x.z, x.w}, {y.x, y.y, y.z, y.w}, {z.x, z.y, z.z, z.w}}};
}

}  // namespace spherechain::cuda

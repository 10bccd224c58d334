// SPDX-License-Identifier: MIT
// Lays a skin in a pose out in the scratch memory of a job.
#pragma once

#include <cstddef>

#include "runtime/src/base/filter.h"
#include "runtime/src/clusters/posed_clusters.h"
#include "runtime/src/pose/pose.h"
#include "runtime/src/skin/job_body.h"

namespace spherechain {

// Is it open, with a skin?
Status check_asset(const Asset* asset);
// Checks the skin of a job: it exists, the pose fits it, and the table was made from it.
Status check_skin(const Asset* asset, const Pose& pose, const std::uint64_t* skin_table, Surface& surface);

bool has_skin(const AssetView& asset);

struct Bounds3 {
  float low[3], high[3];
};
// Bounds all of the skin in a checked pose of bones. `boxes`, if not null, receives the bounds of the skin that each
// bone moves, in six floats: the low corner, then the high one.
Bounds3 bound_bones(const AssetView& asset, const Surface& surface, const Pose& pose, float* boxes);
Bounds3 bound_vertices(const Surface& surface, const Pose& pose);
// Bounds the bones of two bodies that are both moved by bones.
void bound_bones_of_two(const AssetView& asset_a, PosedClusters& a, const AssetView& asset_b, PosedClusters& b,
                        const Pose& pose_a, const Pose& pose_b, WordMemory& memory);

// The memory that a job reads of a body.
struct BodyRanges {
  MemoryRange vertices, bones, morph_weights, skin_table, ignored_parts;

  explicit BodyRanges(const JobBody& body);
};

// Takes the memory of `posed`; set_pose() then gives it a pose.
void lay_out(const AssetView& asset, WordMemory& memory, PosedClusters& posed);
void set_pose(const AssetView& asset, const Surface& surface, const Pose& pose, const Filter* filter,
              PosedClusters& posed);
// Lays out and sets a checked pose; there must be enough words. No cluster is bounded yet. All pairs of spheres are
// paired but those that the asset or the filter, which may be null, ignores or disables.
PosedClusters posed_clusters_of(const AssetView& asset, const Surface& surface, const Pose& pose, const Filter* filter,
                                WordMemory& memory);

}  // namespace spherechain

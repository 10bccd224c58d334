// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "runtime/src/asset/asset_view.h"
#include "spherechain/crowd.h"

namespace spherechain {

std::size_t part_pair_words(const AssetView& asset);  // of an instance
// Entries from one instance's spheres to the next's; bytes from one instance's bones.
std::size_t sphere_stride(const AssetView& asset, const CrowdJob& job);
std::size_t bone_stride(const AssetView& asset, const CrowdJob& job);
inline std::size_t task_count(const CrowdJob& job) { return job.task_count == 0 ? 1 : job.task_count; }

// Checks a job on an open asset, except for the job's target.
Status check_crowd(const AssetView& asset, const CrowdJob& job);

}  // namespace spherechain

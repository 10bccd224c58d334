// SPDX-License-Identifier: MIT
// From checked arguments to what the kernel reads.
#pragma once

#include "crowd_view.h"

namespace spherechain::cuda {

struct Access {
  // The entries of tables whose words lie at `words`, in the memory of the host or of a device.
  static GroupView view(const CrowdTables& tables, const std::uint64_t* words);
};

// kOk and the group as the kernel sees it, `first_block` aside; or what is wrong with it, as CrowdJob::run says.
Status view_group(const CrowdGroup& group, GroupView& view);

// Where a group's blocks have what.
SharedLayout layout_of(const GroupView& view);

// What one kernel is launched with.
struct Launch {
  GroupView views[CrowdJob::kMostGroups];
  std::uint32_t count;
};

// The groups that have instances, by where their blocks' memory is.
struct LaunchPlan {
  Launch in_shared, in_scratch;
  std::uint32_t shared_blocks, scratch_blocks;
  std::size_t shared_bytes;  // the most that a block of the first needs
};

// Checks the groups, as CrowdJob::run says.
Status view_groups(Span<const CrowdGroup> groups, Launch& all);

// Where a block has `most_shared_bytes`. kOk, kDeviceTooSmall, kContextTooSmall.
Status plan_launches(const Launch& all, std::size_t most_shared_bytes, LaunchPlan& plan);

}  // namespace spherechain::cuda

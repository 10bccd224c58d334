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

inline std::uint32_t blocks_of(const GroupView& view) { return (view.instance_count + kLanes - 1) / kLanes; }

}  // namespace spherechain::cuda

// SPDX-License-Identifier: MIT
// From a caller's groups to the launches of kernels.
#pragma once

#include <algorithm>
#include <initializer_list>

#include "crowd_view.h"
#include "runtime/src/base/status.h"

namespace spherechain::cuda {

inline const TableHeader& header_of(const std::uint64_t* table) { return *reinterpret_cast<const TableHeader*>(table); }

// Something wrong with what the caller gave.
struct Fault {
  bool is_there;
  sc_code code;
  sc_field field;
};

inline Status first_of(std::initializer_list<Fault> faults) {
  const Fault* const found = std::find_if(faults.begin(), faults.end(), [](const Fault& one) { return one.is_there; });
  return found == faults.end() ? done() : refuse(found->code, found->field);
}

// Which inputs and outputs a group has.
struct BlockUse {
  bool bones, bits, pairs;
};

// The memory of a block.
BlockLayout layout_of(const TableFigures& table, const BlockUse& use);

// Checks a group as enqueue_crowds() says and fills in the view, except for its place in a launch.
Status view_group(const CrowdGroup& group, GroupView& view);

// The kernels: for groups of spheres, for groups of bones, and for groups of either whose memory is scratch.
enum class Kernel : std::uint32_t { kSpheres, kBones, kScratch };
inline constexpr std::uint32_t kKernels = 3;

// The arguments of a kernel.
struct Launch {
  GroupView views[kCrowdGroupsMax];
  std::uint32_t count, blocks;
  std::size_t shared_bytes;  // of a block: what the group that needs most takes
};

struct LaunchPlan {
  Launch launches[kKernels];

  Launch& operator[](Kernel kernel) { return launches[static_cast<std::uint32_t>(kernel)]; }
};

// Fills in the views of the groups that have instances.
Status view_groups(const CrowdGroup* groups, std::size_t count, Launch& all);

// Deals them to the kernels. `shared_bytes_max`: what a block of the device may have. SC_OK, SC_DEVICE_TOO_SMALL or
// SC_TOO_SMALL.
Status plan_launches(const Launch& all, std::size_t shared_bytes_max, LaunchPlan& plan);

struct DeviceLimits {
  std::size_t shared_bytes_max;  // of a block
  std::size_t multiprocessors;
};
Status find_limits(DeviceLimits& limits);  // of the current device

// Enqueues a kernel. SC_OK, SC_NO_DEVICE or SC_DEVICE_FAILED.
Status enqueue(Kernel kernel, const Launch& launch, std::size_t shared_bytes_max, CUstream_st* stream);

// The same for a cudaError_t, which last_device_error() then tells.
Status status_of(int cuda_error);

}  // namespace spherechain::cuda

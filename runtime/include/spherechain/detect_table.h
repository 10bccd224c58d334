// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "spherechain/abi.h"
#include "spherechain/asset.h"
#include "spherechain/filter.h"
#include "spherechain/status.h"
#include "spherechain/types.h"

namespace spherechain {

// Which pairs of an asset are looked at, worked out once for any number of DetectJobs, which then need not: they take
// less than half the time. In memory of the caller's, which stays as prepare_detect left it; any number of jobs may
// share one.
struct SPHERECHAIN_API DetectTable {
  Span<std::uint64_t> words;

  // Words needed for `asset`: some 16 a sphere; few where it has more than 128 spheres, for which a table saves
  // nothing. 0 where it is not open.
  static std::size_t words_needed(const Asset& asset) noexcept;
};

// Fills `table` for jobs with this asset and `radius`, and with the ignored pairs and disabled spheres of `filter`
// (null: the asset's ignored pairs). Where a filter is edited later the table stays as it was: prepare it again.
// Allocates nothing. kOk; kNotOpen, kNullArgument, kMisaligned, kBadArgument (no such radius), kContextTooSmall (too
// few words), kBadFilter, kSharedMemory: nothing is written.
SPHERECHAIN_API Status prepare_detect(const Asset& asset, RadiusKind radius, const Filter* filter,
                                      DetectTable& table) noexcept;

}  // namespace spherechain

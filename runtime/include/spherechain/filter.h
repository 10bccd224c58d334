// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "spherechain/abi.h"
#include "spherechain/asset.h"
#include "spherechain/status.h"
#include "spherechain/types.h"

namespace spherechain {

// What a detection leaves out and how much it adds to each sphere: the caller's own, begun as what the asset says and
// edited at run time. The buffers are the caller's; the functions below change what they hold and allocate nothing. A
// job reads a Filter while it runs: do not edit it then. Any number of jobs may share one.
struct SPHERECHAIN_API Filter {
  // The asset's table of ignored pairs, edited: bit b(b-1)/2 + a for a < b. ignored_words() words exactly.
  Span<std::uint64_t> ignored;
  // Bit i: sphere i touches nothing. disabled_words() words exactly, or empty: all are enabled.
  Span<std::uint64_t> disabled;
  // Added to each sphere's radius, in the spheres' units; as many as the asset has spheres, or empty: none. May be
  // negative. A radius that is below 0 or not finite after it touches nothing; a near pair's reach counts with it. With
  // one such radius DetectJob and CrowdJob take several times as long: disable what is to touch nothing.
  Span<float> padding;

  // 0 where the asset is not open.
  static std::size_t ignored_words(const Asset& asset) noexcept;
  static std::size_t disabled_words(const Asset& asset) noexcept;
};

// All of these: kOk; kNotOpen; kNullArgument where a buffer has a size and no memory; kMisaligned; kBadFilter where one
// has not the size the asset asks for, or is empty and the function writes to it; kBadArgument where a sphere, region
// or figure does not exist. Those that write: kSharedMemory where one of the buffers overlaps another, or the asset's
// table. Nothing is written unless kOk. kOk from check_filter is all that DetectJob asks.
SPHERECHAIN_API Status check_filter(const Asset& asset, const Filter& filter) noexcept;

// The asset's own pairs; every sphere enabled, no padding.
SPHERECHAIN_API Status reset_filter(const Asset& asset, Filter& filter) noexcept;

// The rest of the pairs stay as they are. `ignored` false reports the pairs again, those the asset itself ignores too.
// Costs: one pair, all pairs of the asset, and the chains' pairs at most `hops` apart.
SPHERECHAIN_API Status ignore_pair(const Asset& asset, Filter& filter, std::uint32_t a, std::uint32_t b,
                                   bool ignored = true) noexcept;

// Each pair of a sphere of one region with a sphere of the other; with the same region twice, the pairs within it.
SPHERECHAIN_API Status ignore_regions(const Asset& asset, Filter& filter, std::size_t region, std::size_t other,
                                      bool ignored = true) noexcept;

// Each pair that some chain holds at most `hops` places apart: 1 for next ones. 0 changes nothing.
SPHERECHAIN_API Status ignore_hops(const Asset& asset, Filter& filter, std::size_t hops, bool ignored = true) noexcept;

SPHERECHAIN_API Status disable_sphere(const Asset& asset, Filter& filter, std::uint32_t sphere,
                                      bool disabled = true) noexcept;

// `padding` finite, in the spheres' units; replaces what was added before.
SPHERECHAIN_API Status pad_sphere(const Asset& asset, Filter& filter, std::uint32_t sphere, float padding) noexcept;

}  // namespace spherechain

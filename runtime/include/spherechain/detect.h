// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "spherechain/asset.h"
#include "spherechain/status.h"
#include "spherechain/types.h"

namespace spherechain {

// Scratch memory of one DetectJob at a time, owned by the caller. Only M1 needs it (to report each pair once).
struct DetectContext {
  Span<std::uint64_t> words;

  // Words needed for `asset`: one bit a pair of spheres.
  static std::size_t words_needed(const Asset& asset) noexcept;
};

// One overlap found by M1 as the paper counts it: a pair shows up once for every chain that holds both spheres.
struct ChainPair {
  std::uint32_t chain;
  Pair pair;
};

// Which spheres touch: the overlap test of the paper's section 5.2, (|ca - cb|)^2 < (ra + rb)^2, ignored pairs left out.
// Pairs that overlap at rest without being neighbours are reported where |ca - cb| < reach * (ra + rb).
// The arithmetic is fixed: ((dx*dx + dy*dy) + dz*dz) < s*s, s = (ra + rb) or reach * (ra + rb), single precision, no
// contraction; every backend reports the same pairs, bit for bit.
//
// Fill in the fields and call run(). Allocates nothing, takes no lock; jobs with other outputs and contexts may run at
// the same time.
struct DetectJob {
  const Asset* asset = nullptr;  // open
  Span<const Sphere> spheres;    // at least asset->spheres().size, from RefitJob with the same `radius`
  RadiusKind radius = RadiusKind::kDetect;
  Method method = Method::kM2;
  DetectContext* context = nullptr;  // M1: required
  Span<Pair> pairs;                  // out: sorted by (a, b), each once; may be empty to count only
  Span<ChainPair> chain_pairs;       // out, M1: the raw list, chain by chain, sorted within a chain; may be empty

  // Out. Counts are what there is, also where a buffer was too small for it.
  std::size_t pair_count = 0;        // unique pairs
  std::size_t chain_pair_count = 0;  // M1: overlaps with their repeats; M2: equal to pair_count
  std::size_t test_count = 0;        // distance tests: pairs not ignored; M1: with repeats

  // kOk; kOverflow where `pairs` or `chain_pairs` was not empty and too small (the first entries are written, the counts
  // say what is needed); kNullArgument, kNotOpen, kTooFewSpheres, kContextTooSmall, kBadArgument: nothing is written.
  Status run() noexcept;
};

}  // namespace spherechain

// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "spherechain/abi.h"
#include "spherechain/asset.h"
#include "spherechain/detect_table.h"
#include "spherechain/filter.h"
#include "spherechain/simd.h"
#include "spherechain/status.h"
#include "spherechain/types.h"

namespace spherechain {

// Scratch memory of one DetectJob at a time, owned by the caller. Only M1 needs it (to report each pair once).
struct SPHERECHAIN_API DetectContext {
  Span<std::uint64_t> words;

  // Words needed for `asset`: one bit a pair of spheres. 0 where it is not open.
  static std::size_t words_needed(const Asset& asset) noexcept;
};

// One overlap found by M1 as the paper counts it: a pair shows up once for every chain that holds both spheres. Within
// a chain the first spheres' pairs come first: positions (0, 1), (0, 2) ... (1, 2) ..., whichever index is the smaller.
struct ChainPair {
  std::uint32_t chain;
  Pair pair;
};

// Which spheres touch: the overlap test of the paper's section 5.2, (|ca - cb|)^2 < (ra + rb)^2, ignored pairs left
// out. Pairs that touch at rest, or all but touch (near pairs), are reported where |ca - cb| < reach * (ra +
// rb).
//
// The arithmetic is fixed, in single precision without contraction, so that every backend reports the same pairs, bit
// for bit. With d2 = (dx*dx + dy*dy) + dz*dz, s = ra + rb:
//   every pair   d2 < s*s  and  s*s <= FLT_MAX: what is not finite touches nothing
//   a near pair  that, and  d2 < t*t  with  t = reach * s
// A filter's padding is added to each radius first: a sum below 0 touches nothing. Without padding a radius below 0,
// which no refit gives, is taken into s as it is.
//
// Ask for what you need: pairs, bits, both, or neither to count. Bits alone are the cheapest, for they need no order.
//
// Fill in the fields and call run(). Allocates nothing, takes no lock; jobs with other outputs and contexts may run at
// the same time.
struct SPHERECHAIN_API DetectJob {
  const Asset* asset = nullptr;  // open
  Span<const Sphere> spheres;    // at least asset->spheres().size, from RefitJob with the same `radius`
  RadiusKind radius = RadiusKind::kDetect;
  Method method = Method::kM2;
  Target target = Target::kBest;
  const Filter* filter = nullptr;  // null: the asset's ignored pairs, all spheres as they are
  // Null, or from prepare_detect with this asset and radius: faster, the same pairs. Then it, not `filter`, says which
  // pairs are ignored and spheres disabled; `filter` adds its padding.
  const DetectTable* table = nullptr;
  bool first_only = false;           // M2: stop at the first pair of the sorted list
  DetectContext* context = nullptr;  // M1: required
  Span<Pair> pairs;                  // out: sorted by (a, b), each once; may be empty to count only
  // Out: bit b(b-1)/2 + a of each pair found, as in Asset::ignored(), the rest 0; bit_words() words exactly, or empty.
  Span<std::uint64_t> bits;
  Span<ChainPair> chain_pairs;  // out, M1: the raw list, chain by chain, in chain order within one; may be empty

  // Out. Counts are what there is, also where a buffer was too small for it.
  std::size_t pair_count = 0;        // unique pairs; first_only: 0 or 1
  std::size_t chain_pair_count = 0;  // M1: overlaps with their repeats; M2: equal to pair_count
  std::size_t test_count = 0;        // pairs not ignored; M1: with repeats; first_only: up to where it stopped

  static std::size_t bit_words(const Asset& asset) noexcept;  // 0 where the asset is not open

  // Uses some 25 KiB of stack. kOk; kOverflow where `pairs` or `chain_pairs` was not empty and too small (the first
  // entries are written, the counts say what is needed); kNullArgument, kNotOpen, kTooFewSpheres, kContextTooSmall,
  // kBadArgument, kUnsupportedTarget, kBadFilter, kMisaligned, kSharedMemory (what is written overlaps another of these
  // buffers): nothing is written, the counts keep their values.
  Status run() noexcept;
};

}  // namespace spherechain

// SPDX-License-Identifier: MIT
// The tables that refit from bones reads: schemas/sphere_chains.fbs, Moments. docs/arithmetic.md has the arithmetic.
#pragma once

#include <cstddef>
#include <cstdint>

#include "runtime/src/base/span.h"
#include "spherechain/types.h"

namespace spherechain {

inline constexpr std::size_t kMomentSize = 16;
inline constexpr std::size_t kMaxMomentBones = 22;   // of a sphere
inline constexpr std::size_t kMaxMomentPairs = 256;  // of a batch

// A figure of a bone's relative matrix that is nearer to 0 than this counts as 0: bones that stand still have such
// rounding errors, and products of two of them may be subnormal, which costs processors some 150 cycles.
inline constexpr float kMinMatrixFigure = 0x1p-62F;

struct BonePair {
  std::uint16_t a, b;
};

struct Moment {
  float values[kMomentSize];
};

struct CenterTerm {
  float x, y, z, w;
};

struct MomentBatch {
  std::uint32_t pair_count, sphere_count;
};

struct MomentTables {
  Vec3 origin{};
  std::uint32_t reference = 0;
  Span<const MomentBatch> batches;
  Span<const BonePair> pairs;
  Span<const std::uint32_t> spheres;
  Span<const std::uint8_t> bone_counts;
  Span<const std::uint16_t> bones;
  Span<const CenterTerm> centers;
  Span<const std::uint8_t> pair_places;
  Span<const Moment> moments;  // 64-byte aligned where the asset's bytes are
};

}  // namespace spherechain

// SPDX-License-Identifier: MIT
// The overlap test of many pairs at once: a tile of up to 128 by 128 spheres, one bit a pair.
#pragma once

#include <cstddef>
#include <cstdint>

#include "spherechain/simd.h"
#include "spherechain/types.h"

namespace spherechain {

inline constexpr std::size_t kTileSize = 128;  // 8 KiB of stack a tile, all told
inline constexpr std::size_t kTileWords = kTileSize / 64;

// Spheres coordinate by coordinate, as vectors want them.
struct alignas(64) SphereColumns {
  float x[kTileSize], y[kTileSize], z[kTileSize], radius[kTileSize];
};

// Row r is sphere first_row + r, column c sphere first_column + c.
struct Tile {
  const SphereColumns* columns = nullptr;
  std::size_t first_column = 0, column_count = 0;
  const Sphere* rows = nullptr;
  std::size_t first_row = 0, row_count = 0;
  // Bits by ignored_bit(column's sphere, row's): pairs that are left out.
  const std::uint64_t* ignored = nullptr;
  std::size_t ignored_words = 0;
  std::uint64_t enabled_columns[kTileWords] = {};
  std::uint64_t enabled_rows[kTileWords] = {};
  bool any_huge = true;  // a radius above kHugeRadius in sight: s*s may pass FLT_MAX
  // Out: bit c % 64 of bits[r][c / 64] says that the column's sphere, which is the smaller of the two, touches the
  // row's.
  std::uint64_t (*bits)[kTileWords] = nullptr;
  std::uint64_t (*wanted)[kTileWords] = nullptr;  // the same for the pairs that are not left out; may be null
  std::size_t test_count = 0;                     // how many those are
};

// Of the spheres in `mask`, the bits of `wanted` and those of `bits` between two of them, counted.
struct MaskedCount {
  std::size_t wanted = 0, touching = 0;
};
MaskedCount count_masked(Target resolved, const Tile& tile, const std::uint64_t (&mask)[kTileWords]);

// Two radii up to this have a sum whose square is finite.
inline constexpr float kHugeRadius = 9e18F;

// Copies up to kTileSize spheres; true where a radius is above kHugeRadius, infinite included.
bool fill_columns(Target resolved, const Sphere* spheres, std::size_t count, SphereColumns& columns);

void test_tile(Target resolved, Tile& tile);

}  // namespace spherechain

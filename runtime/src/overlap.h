// SPDX-License-Identifier: MIT
// The overlap test of many pairs at once: a tile of up to 128 by 128 spheres, one bit a pair.
#pragma once

#include <cstddef>
#include <cstdint>

#include "spherechain/simd.h"
#include "spherechain/types.h"

namespace spherechain {

inline constexpr std::size_t kTileSize = 128;  // 9 KiB of stack a tile, all told
inline constexpr std::size_t kTileWords = kTileSize / 64;

// Spheres coordinate by coordinate, as vectors want them: seen from `origin`, with half of |center|^2 - radius^2. The
// entries up to the next multiple of kBlock are there too, and are 0.
struct alignas(64) SphereColumns {
  float x[kTileSize], y[kTileSize], z[kTileSize], radius[kTileSize], power[kTileSize];
  float extent;  // at least |center|^2 + radius^2 of each; not finite, or NaN, where one is not
};
inline constexpr std::size_t kBlock = 16;  // columns tested at a time: a multiple of each target's lanes

// Row r is sphere first_row + r, column c sphere first_column + c.
struct Tile {
  const SphereColumns* columns = nullptr;
  const SphereColumns* rows = nullptr;  // seen from the same origin
  const Sphere* column_spheres = nullptr;
  const Sphere* row_spheres = nullptr;
  std::size_t first_column = 0, column_count = 0;
  std::size_t first_row = 0, row_count = 0;
  // Bits by ignored_bit(column's sphere, row's): pairs that are left out.
  const std::uint64_t* ignored = nullptr;
  std::size_t ignored_words = 0;
  std::uint64_t enabled_columns[kTileWords] = {};
  std::uint64_t enabled_rows[kTileWords] = {};
  // Out: bit c % 64 of bits[r][c / 64] says that the column's sphere, which is the smaller of the two, touches the
  // row's.
  std::uint64_t (*bits)[kTileWords] = nullptr;
  std::uint64_t (*wanted)[kTileWords] = nullptr;  // the same for the pairs that are not left out; may be null
  std::size_t test_count = 0;                     // how many those are
  std::uint8_t hits[kTileSize * kTileWords];      // the words of bits that have some: kTileWords * r + word
  std::size_t hit_count = 0;
};

// What a test by multiply-adds may be off, and up to which extent it is of use: overlap.cpp has the proof.
inline constexpr float kMarginOfExtent = 0x1p-18F, kLeastMargin = 0x1p-120F, kMostExtent = 1e36F;

// Of the spheres in `mask`, the bits of `wanted` and those of `bits` between two of them, counted.
struct MaskedCount {
  std::size_t wanted = 0, touching = 0;
};
MaskedCount count_masked(Target resolved, const Tile& tile, const std::uint64_t (&mask)[kTileWords]);

// Up to kTileSize spheres.
void fill_columns(Target resolved, const Sphere* spheres, std::size_t count, const Sphere& origin,
                  SphereColumns& columns);

void test_tile(Target resolved, Tile& tile);

}  // namespace spherechain

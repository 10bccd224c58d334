// SPDX-License-Identifier: MIT
// The overlap test of many pairs at once: a tile of up to 128 by 128 spheres, one bit a pair.
#pragma once

#include <cstddef>
#include <cstdint>

#include "asset/asset_view.h"
#include "spherechain/types.h"

namespace spherechain {

inline constexpr std::size_t kTileSize = 128;  // 11 KiB of stack a tile, all told
inline constexpr std::size_t kTileWords = kTileSize / 64;

// A row's bits: bit c % 64 of words[c / 64] for column c.
struct TileWords {
  std::uint64_t words[kTileWords];
};

// Spheres coordinate by coordinate, as vectors want them: seen from `origin`, with half of |center|^2, less radius^2
// and a margin for what tests may be off. The entries up to the next multiple of kBlock are there too, and are 0.
struct alignas(64) SphereColumns {
  float x[kTileSize], y[kTileSize], z[kTileSize], power[kTileSize];
  bool is_finite;  // else of no use: |center|^2 + radius^2 of some sphere is not
};
inline constexpr std::size_t kBlock = 16;  // columns tested at a time: a multiple of each target's lanes

// Row r is sphere first_row + r, column c sphere first_column + c.
struct TilePlace {
  std::size_t first_column = 0, column_count = 0;
  std::size_t first_row = 0, row_count = 0;
};

// Rows are kept in groups of four, a wide register; the last ones' words are 0.
constexpr std::size_t padded_rows(std::size_t row_count) { return (row_count + 3) / 4 * 4; }

// The first row that has pairs with the column of the tile and those after it: of the pairs (a, b) only those with a <
// b.
constexpr std::size_t first_row_of(const TilePlace& place, std::size_t column) {
  const std::size_t after = place.first_column + column + 1;
  return after > place.first_row ? after - place.first_row : 0;
}

struct Tile {
  TilePlace place;
  const SphereColumns* columns = nullptr;
  const SphereColumns* rows = nullptr;  // seen from the same origin
  const Sphere* column_spheres = nullptr;
  const Sphere* row_spheres = nullptr;
  // The pairs to look at, a before b, and those of them that are no rest pairs; padded_rows(row_count) each.
  const TileWords* wanted = nullptr;
  const TileWords* plain = nullptr;
  Span<const RestPair> rest_pairs;  // those of the columns
  bool is_whole = false;            // columns and rows are all spheres there are
  // Out: the pairs that touch. padded_rows(row_count).
  TileWords* bits = nullptr;
  std::uint8_t hits[kTileSize * kTileWords];  // the words of bits that have some, upwards: kTileWords * r + word
  std::size_t hit_count = 0;
};

// What a sphere's |center|^2 + radius^2 adds to what a test by multiply-adds may be off: sphere_columns.h has the
// proof.
inline constexpr float kMarginOfExtent = 0x1p-18F, kMinMargin = 0x1p-120F;

// Up to kTileSize spheres.
void fill_columns(Target resolved, const Sphere* spheres, std::size_t count, const Sphere& origin,
                  SphereColumns& columns);

void test_tile(Target resolved, Tile& tile);

}  // namespace spherechain

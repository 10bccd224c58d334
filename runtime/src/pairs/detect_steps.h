// SPDX-License-Identifier: MIT
// The steps of a detection: the pairs to look at, a tile of them tested, and lists out of bits.
#pragma once

#include <cstddef>
#include <cstdint>

#include "pairs/overlap.h"
#include "pairs/padded_radius.h"
#include "pairs/pair_bits.h"
#include "pairs/pair_rows.h"
#include "spherechain/detect.h"

namespace spherechain {

// A list that counts on past its end.
template <typename T>
struct Output {
  Span<T> buffer;
  std::size_t count = 0;

  void add(const T& value) {
    put(count, value);
    ++count;
  }
  void put(std::size_t at, const T& value) const {
    if (at < buffer.size) {
      buffer[at] = value;
    }
  }
  // A caller who only wants the count brings no buffer.
  bool overflowed() const { return buffer.size > 0 && count > buffer.size; }
};

// What a job looks at, its filter taken into account.
struct Scene {
  const AssetView* asset;
  const Sphere* spheres;
  Span<const RestPair> rest_pairs;
  Span<const std::uint64_t> ignored;
  Span<const std::uint64_t> disabled;  // may be empty
  Span<const float> padding;           // may be empty
  Target target;                       // resolved
  const PairRows* rows;                // null: worked out tile by tile

  std::size_t size() const { return asset->spheres().size; }
  bool is_enabled(std::size_t i) const { return disabled.size == 0 || !test_bit(disabled, i); }
  Sphere sphere(std::size_t i) const {
    Sphere s = spheres[i];
    if (padding.size > 0) {
      s.radius = padded_radius(s.radius, padding[i]);
    }
    return s;
  }
  // Padded spheres: those of the scene where nothing is padded, or in `copy`.
  const Sphere* block(std::size_t first, std::size_t count, Sphere* copy) const;
};

struct Result {
  Output<Pair> pairs;
  Span<std::uint64_t> bits;
};

// All spheres from first_column on, at most kTileSize, against all from first_row on.
class TestedTile {
 public:
  explicit TestedTile(const Scene& scene) : scene_(scene) {}

  void set_columns(std::size_t first);
  void set_rows(std::size_t first);
  // Which pairs to look at, see Tile: those given, or what the scene clusters; then returns how many.
  void choose(const TileWords* wanted, const TileWords* plain);
  void choose_all();
  void run() { test_tile(scene_.target, tile_); }

  std::size_t first_column() const { return tile_.place.first_column; }
  std::size_t first_row() const { return tile_.place.first_row; }
  const TileWords* wanted() const { return tile_.wanted; }
  const TileWords* plain() const { return tile_.plain; }
  // See Tile.
  Span<const std::uint8_t> hits() const { return {tile_.hits, tile_.hit_count}; }
  const TileWords* bits() const { return bits_; }

 private:
  const Scene& scene_;
  Tile tile_;
  const Sphere* column_spheres_ = nullptr;
  SphereColumns columns_, rows_;  // rows_: where they are others
  Sphere padded_columns_[kTileSize], padded_rows_[kTileSize];
  TileWords wanted_[kTileSize], plain_[kTileSize], bits_[kTileSize];
};

// Orders a tile's bits by column, then row: the order of a sorted list.
class ColumnOrder {
 public:
  ColumnOrder() { clear(); }
  void clear();
  void count(const TileWords* bits, std::size_t rows) {
    for (std::size_t r = 0; r < rows; ++r) {
      for (std::size_t w = 0; w < kTileWords; ++w) {
        count_word(bits[r].words[w], w);
      }
    }
  }
  void count_word(std::uint64_t word, std::size_t w);
  std::size_t total() const { return total_; }
  // From counts to the place each column's entries begin at.
  void begin_at(std::size_t place);
  template <typename Put>
  void place(const TileWords* bits, std::size_t rows, const Put& put) {
    for (std::size_t r = 0; r < rows; ++r) {
      for (std::size_t w = 0; w < kTileWords; ++w) {
        place_word(bits[r].words[w], w, r, put);
      }
    }
  }
  template <typename Put>
  void place_word(std::uint64_t word, std::size_t w, std::size_t r, const Put& put) {
    for (; word != 0; word &= word - 1) {
      const std::size_t column = 64 * w + lowest_bit(word);
      put(at_[column]++, column, r);
    }
  }

 private:
  std::size_t total_ = 0;
  std::uint64_t columns_[kTileWords];
  std::uint32_t at_[kTileSize];
};

void detect_all(const Scene& scene, Result& result);

// The same for a scene with rows, where few pairs touch. False where there are too many pairs or spheres are too large:
// then `result` is as it was.
bool detect_listed(const Scene& scene, Result& result);

}  // namespace spherechain

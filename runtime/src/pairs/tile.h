// SPDX-License-Identifier: MIT
// The overlap test of a tile: up to 128 spheres, the columns, with as many, the rows.
#pragma once

#include <cstddef>
#include <cstdint>

#include "runtime/src/base/span.h"
#include "spherechain/types.h"

namespace spherechain {

inline constexpr std::size_t kTileSize = 128;
inline constexpr std::size_t kBlock = 16;  // columns tested at a time: a multiple of each target's lanes

// Rows are the columns, or all of them come after: then there are kTileSize columns.
struct TilePlace {
  std::size_t first_column, column_count, first_row, row_count;

  bool is_diagonal() const { return first_row == first_column; }
  // The first row that has pairs (a, b), a < b, with `column` as a.
  std::size_t first_row_of(std::size_t column) const { return is_diagonal() ? column + 1 : 0; }
};

// A column a and a row b, by the bytes from the tile's first ones: that spares a shift a load. As one number of 32
// bits, which vectors take it for, pairs are in order: the runtime knows machines of that byte order only, as the asset
// does.
struct ListedPair {
  std::uint16_t b, a;
};
constexpr ListedPair listed_pair(std::size_t a, std::size_t b) {
  return {static_cast<std::uint16_t>(b * sizeof(Sphere)), static_cast<std::uint16_t>(a * sizeof(Sphere))};
}

// A strip is a row and a block of kBlock columns, some of which have a pair with it. A tile's strips are in order by
// two blocks, then by row, then by block.
inline constexpr std::size_t kMaxStrips = kTileSize * kTileSize / kBlock;
inline constexpr std::size_t kStripGroup = 64;

// The strips of two blocks. A diagonal tile's first kBlock rows have none with the second block.
class TwoBlocks {
 public:
  explicit TwoBlocks(const TilePlace& place)
      : row_count_(place.row_count),
        step_(place.is_diagonal() ? 2 * kBlock : 0),
        single_rows_(place.is_diagonal() ? kBlock : 0),
        first_row_(place.first_row_of(0)) {
    set_end();
  }

  void advance() {
    first_column_ += 2 * kBlock;
    first_row_ += step_;
    begin_ = end_;
    set_end();
  }
  std::size_t first_column() const { return first_column_; }
  std::size_t first_row() const { return first_row_; }
  std::size_t single_rows() const { return single_rows_; }
  std::size_t begin() const { return begin_; }  // of the strips' numbers
  std::size_t strip_of(std::size_t column, std::size_t row) const {
    return begin_ + strips_of(row - first_row_) + (column - first_column_) / kBlock;
  }

 private:
  std::size_t strips_of(std::size_t rows) const { return rows + (rows > single_rows_ ? rows - single_rows_ : 0); }
  void set_end() { end_ = begin_ + (first_row_ < row_count_ ? strips_of(row_count_ - first_row_) : 0); }

  std::size_t row_count_, step_, single_rows_, first_row_, first_column_ = 0, begin_ = 0, end_ = 0;
};

// Which pairs of a tile to test.
struct PairLists {
  const std::uint16_t* wanted;  // by strip, a bit a column: pairs but rest pairs; 0 up to a multiple of kStripGroup
  const ListedPair* strips;     // the block's first column and the row
  std::size_t strip_count;
  const ListedPair* rest_pairs;  // rest_count is a multiple of kBlock, filled up by pairs that never touch
  const float* rest_scales;
  std::size_t rest_count;
};

struct Tile {
  TilePlace place;
  const Sphere *columns, *rows;
  const PairLists* lists;
};

struct FoundPairs;

// Collects the touching pairs: a list, a bit a pair, or their count alone.
class PairOutput {
 public:
  PairOutput(Span<Pair> list, Span<std::uint64_t> bits) : list_(list), bits_(bits) {}

  // Takes over what is found of a tile, and leaves `found` empty.
  void take(const TilePlace& place, FoundPairs& found);
  // The same at the end: then the list is in order.
  void finish(Target resolved, const TilePlace& place, FoundPairs& found);

  std::size_t count() const { return count_; }

 private:
  void add_to_list(std::size_t count, Pair pair);  // count: of those before

  Span<Pair> list_;  // where there are more pairs, the first of them
  Span<std::uint64_t> bits_;
  std::size_t count_ = 0;
};

inline constexpr std::size_t kMaxFound = 128;
struct alignas(64) FoundPairs {
  explicit FoundPairs(PairOutput& to) : output(to) {}

  ListedPair pairs[kMaxFound + kBlock];  // in any order
  std::size_t count = 0;
  PairOutput& output;  // takes them over when there are more than kMaxFound
};

// Adds the tile's pairs that touch.
void find_pairs(Target resolved, const Tile& tile, FoundPairs& found);

// Into the list, in order, as many as it holds.
void list_in_order(Target resolved, const FoundPairs& found, Span<Pair> list);

}  // namespace spherechain

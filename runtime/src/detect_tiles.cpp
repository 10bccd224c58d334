// SPDX-License-Identifier: MIT
// M2: tile by tile of 128 spheres; a character is a single one.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "arithmetic.h"
#include "detect_steps.h"

namespace spherechain {
namespace {

// The pairs (first + i, b) whose bits are in `word`, into a table in the order of Asset::ignored().
void copy_row(std::uint64_t word, std::size_t first, std::size_t b, Span<std::uint64_t> table) {
  const std::size_t at = ignored_bit(first, b);
  table[at / 64] |= word << (at % 64);
  const std::uint64_t rest = at % 64 == 0 ? 0 : word >> (64 - at % 64);
  if (rest != 0) {
    table[at / 64 + 1] |= rest;
  }
}

// A pair's column and row, given where the tile is.
Pair pair_of(const TestedTile& tile, std::size_t column, std::size_t row) {
  return {static_cast<std::uint32_t>(tile.first_column() + column), static_cast<std::uint32_t>(tile.first_row() + row)};
}

// The pairs of the columns set, which are sorted among themselves. Tiles are tested again where there are several:
// there is no memory for all their bits.
void list_columns(TestedTile& tile, std::size_t n, ColumnOrder& order, Output<Pair>& pairs) {
  order.begin_at(pairs.count);
  const bool is_one_tile = tile.first_row() == tile.first_column();
  for (std::size_t first_row = tile.first_column(); first_row < n; first_row += kTileSize) {
    if (!is_one_tile) {
      tile.run(first_row);
    }
    for (const std::size_t hit : tile.hits()) {
      const std::size_t r = hit / kTileWords, w = hit % kTileWords;
      order.place_word(tile.bits()[r][w], w, r, [&](std::size_t at, std::size_t column, std::size_t row) {
        pairs.put(at, pair_of(tile, column, row));
      });
    }
  }
}

}  // namespace

void copy_bits(const std::uint64_t (*bits)[kTileWords], std::size_t rows, std::size_t first_column,
               std::size_t first_row, Span<std::uint64_t> table) {
  for (std::size_t r = 0; r < rows; ++r) {
    for (std::size_t w = 0; w < kTileWords; ++w) {
      if (bits[r][w] != 0) {
        copy_row(bits[r][w], first_column + 64 * w, first_row + r, table);
      }
    }
  }
}

const Sphere* TestedTile::block(std::size_t first, std::size_t count, Sphere* copy) const {
  if (scene_.padding.size == 0) {
    return scene_.spheres + first;
  }
  for (std::size_t i = 0; i < count; ++i) {
    copy[i] = scene_.sphere(first + i);
  }
  return copy;
}

void TestedTile::enable(std::size_t first, std::uint64_t* words) const {
  for (std::size_t w = 0; w < kTileWords; ++w) {
    const std::size_t word = first / 64 + w;
    words[w] = word < scene_.disabled.size ? ~scene_.disabled[word] : ~std::uint64_t{0};
  }
}

void TestedTile::set_columns(std::size_t first) {
  tile_.first_column = first;
  tile_.column_count = std::min(scene_.size() - first, kTileSize);
  column_spheres_ = block(first, tile_.column_count, padded_columns_);
  fill_columns(scene_.target, column_spheres_, tile_.column_count, column_spheres_[0], columns_);
  enable(first, tile_.enabled_columns);
  const auto from = [](const NearPair& near, std::size_t a) { return near.a < a; };
  const NearPair* begin = std::lower_bound(scene_.near.begin(), scene_.near.end(), first, from);
  const NearPair* end = std::lower_bound(begin, scene_.near.end(), first + tile_.column_count, from);
  near_ = {begin, static_cast<std::size_t>(end - begin)};
}

void TestedTile::run(std::size_t first_row, std::uint64_t (*wanted)[kTileWords]) {
  tile_.columns = &columns_;
  tile_.column_spheres = column_spheres_;
  tile_.first_row = first_row;
  tile_.row_count = std::min(scene_.size() - first_row, kTileSize);
  if (first_row == tile_.first_column) {
    tile_.rows = &columns_;
    tile_.row_spheres = column_spheres_;
  } else {
    tile_.rows = &rows_;
    tile_.row_spheres = block(first_row, tile_.row_count, padded_rows_);
    fill_columns(scene_.target, tile_.row_spheres, tile_.row_count, column_spheres_[0], rows_);
  }
  enable(first_row, tile_.enabled_rows);
  tile_.ignored = scene_.ignored.data;
  tile_.ignored_words = scene_.ignored.size;
  tile_.bits = bits_;
  tile_.wanted = wanted;
  test_tile(scene_.target, tile_);
  drop_near();
}

// First which near pairs overlap, without a branch: about half of them do, ever other ones.
void TestedTile::drop_near() {
  constexpr std::size_t kAtATime = 64;
  for (std::size_t first = 0; first < near_.size; first += kAtATime) {
    const std::size_t end = std::min(near_.size, first + kAtATime);
    std::size_t overlapping[kAtATime];
    std::size_t count = 0;
    for (std::size_t i = first; i < end; ++i) {
      const std::size_t row = near_[i].b - tile_.first_row;
      if (row < tile_.row_count) {
        const std::size_t column = near_[i].a - tile_.first_column;
        overlapping[count] = i;
        count += (bits_[row][column / 64] >> (column % 64)) & 1U;
      }
    }
    for (std::size_t k = 0; k < count; ++k) {
      const NearPair& near = near_[overlapping[k]];
      const std::size_t row = near.b - tile_.first_row;
      const std::size_t column = near.a - tile_.first_column;
      const bool is_far = !within_reach(column_spheres_[column], tile_.row_spheres[row], near.reach);
      bits_[row][column / 64] &= ~(std::uint64_t{is_far} << (column % 64));
    }
  }
}

void ColumnOrder::clear() {
  total_ = 0;
  std::memset(columns_, 0, sizeof columns_);
  std::memset(at_, 0, sizeof at_);
}

void ColumnOrder::count_word(std::uint64_t word, std::size_t w) {
  columns_[w] |= word;
  for (; word != 0; word &= word - 1) {
    ++at_[64 * w + lowest_bit(word)];
    ++total_;
  }
}

void ColumnOrder::begin_at(std::size_t place) {
  for (std::size_t w = 0; w < kTileWords; ++w) {
    for (std::uint64_t word = columns_[w]; word != 0; word &= word - 1) {
      std::uint32_t& at = at_[64 * w + lowest_bit(word)];
      const std::size_t next = place + at;
      at = static_cast<std::uint32_t>(place);
      place = next;
    }
  }
}

void detect_all(const Scene& scene, Result& result) {
  const std::size_t n = scene.size();
  TestedTile tile(scene);
  ColumnOrder order;
  for (std::size_t first = 0; first < n; first += kTileSize) {
    tile.set_columns(first);
    order.clear();
    for (std::size_t first_row = first; first_row < n; first_row += kTileSize) {
      tile.run(first_row);
      result.tests += tile.test_count();
      const bool copies = result.bits.size > 0 && !result.first_only;
      for (const std::size_t hit : tile.hits()) {
        const std::size_t r = hit / kTileWords, w = hit % kTileWords;
        order.count_word(tile.bits()[r][w], w);
        if (copies && tile.bits()[r][w] != 0) {
          copy_row(tile.bits()[r][w], first + 64 * w, first_row + r, result.bits);
        }
      }
    }
    if (result.pairs.buffer.size > 0 && order.total() > 0) {
      list_columns(tile, n, order, result.pairs);
    }
    result.pairs.count += order.total();
    if (result.first_only && order.total() > 0) {
      break;
    }
  }
}

}  // namespace spherechain

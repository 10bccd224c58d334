// SPDX-License-Identifier: MIT
// All pairs: tile by tile of 128 spheres. A character is a single tile.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "pairs/detect_steps.h"
#include "simd/arithmetic.h"

namespace spherechain {

const Sphere* Scene::block(std::size_t first, std::size_t count, Sphere* copy) const {
  if (padding.size == 0) {
    return spheres + first;
  }
  for (std::size_t i = 0; i < count; ++i) {
    copy[i] = sphere(first + i);
  }
  return copy;
}

void TestedTile::set_columns(std::size_t first) {
  tile_.place.first_column = first;
  tile_.place.column_count = std::min(scene_.size() - first, kTileSize);
  column_spheres_ = scene_.block(first, tile_.place.column_count, padded_columns_);
  fill_columns(scene_.target, column_spheres_, tile_.place.column_count, column_spheres_[0], columns_);
  tile_.columns = &columns_;
  tile_.column_spheres = column_spheres_;
  tile_.bits = bits_;
  tile_.is_whole = scene_.size() <= kTileSize;
  tile_.rest_pairs = scene_.rest_pairs;
  if (!tile_.is_whole) {
    const auto from = [](const RestPair& pair, std::size_t a) { return pair.a < a; };
    const RestPair* begin = std::lower_bound(scene_.rest_pairs.begin(), scene_.rest_pairs.end(), first, from);
    const RestPair* end = std::lower_bound(begin, scene_.rest_pairs.end(), first + tile_.place.column_count, from);
    tile_.rest_pairs = {begin, static_cast<std::size_t>(end - begin)};
  }
}

void TestedTile::set_rows(std::size_t first) {
  tile_.place.first_row = first;
  tile_.place.row_count = std::min(scene_.size() - first, kTileSize);
  if (first == tile_.place.first_column) {
    tile_.rows = &columns_;
    tile_.row_spheres = column_spheres_;
  } else {
    tile_.rows = &rows_;
    tile_.row_spheres = scene_.block(first, tile_.place.row_count, padded_rows_);
    fill_columns(scene_.target, tile_.row_spheres, tile_.place.row_count, column_spheres_[0], rows_);
  }
}

void TestedTile::choose(const TileWords* wanted, const TileWords* plain) {
  tile_.wanted = wanted;
  tile_.plain = plain;
}

void TestedTile::choose_all() {
  choose(wanted_, plain_);
  fill_rows(scene_.target, {scene_.ignored, scene_.disabled, tile_.rest_pairs}, tile_.place, wanted_, plain_);
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

namespace {

// The pairs (first + i, b) whose bits are in `word`, into a table in the order of AssetView::ignored().
void copy_row(std::uint64_t word, std::size_t first, std::size_t b, Span<std::uint64_t> table) {
  const std::size_t at = ignored_bit(first, b);
  table[at / 64] |= word << (at % 64);
  const std::uint64_t rest = at % 64 == 0 ? 0 : word >> (64 - at % 64);
  if (rest != 0) {
    table[at / 64 + 1] |= rest;
  }
}

// A tested tile's pairs: into `order`.
void count_tile(const TestedTile& tile, ColumnOrder& order) {
  for (const std::size_t hit : tile.hits()) {
    order.count_word(tile.bits()[hit / kTileWords].words[hit % kTileWords], hit % kTileWords);
  }
}

void copy_tile(const TestedTile& tile, Span<std::uint64_t> table) {
  for (const std::size_t hit : tile.hits()) {
    const std::size_t r = hit / kTileWords, w = hit % kTileWords;
    copy_row(tile.bits()[r].words[w], tile.first_column() + 64 * w, tile.first_row() + r, table);
  }
}

// And into the list, once `order` knows where they begin.
void list_tile(const TestedTile& tile, ColumnOrder& order, Output<Pair>& pairs) {
  for (const std::size_t hit : tile.hits()) {
    const std::size_t r = hit / kTileWords, w = hit % kTileWords;
    order.place_word(tile.bits()[r].words[w], w, r, [&](std::size_t at, std::size_t column, std::size_t row) {
      pairs.put(at, {static_cast<std::uint32_t>(tile.first_column() + column),
                     static_cast<std::uint32_t>(tile.first_row() + row)});
    });
  }
}

// The pairs of the columns set, which are sorted among themselves. Tiles are tested again where there are several:
// there is no memory for all their bits.
void list_columns(TestedTile& tile, std::size_t n, ColumnOrder& order, Output<Pair>& pairs) {
  order.begin_at(pairs.count);
  const bool is_one_tile = tile.first_row() == tile.first_column();
  for (std::size_t first_row = tile.first_column(); first_row < n; first_row += kTileSize) {
    if (!is_one_tile) {
      tile.set_rows(first_row);
      tile.choose_all();
      tile.run();
    }
    list_tile(tile, order, pairs);
  }
}

// Few pairs, as most poses have, are put in order one by one. False where there are more.
bool list_few(const TestedTile& tile, Output<Pair>& out) {
  constexpr std::size_t kFew = 32, kShift = 16;
  std::uint32_t pairs[kFew];
  std::size_t count = 0;
  for (const std::size_t hit : tile.hits()) {
    const std::size_t b = tile.first_row() + hit / kTileWords, first = tile.first_column() + 64 * (hit % kTileWords);
    for (std::uint64_t word = tile.bits()[hit / kTileWords].words[hit % kTileWords]; word != 0; word &= word - 1) {
      if (count == kFew) {
        return false;
      }
      const auto pair = static_cast<std::uint32_t>((first + lowest_bit(word)) << kShift | b);
      std::size_t place = count++;
      for (; place > 0 && pairs[place - 1] > pair; --place) {
        pairs[place] = pairs[place - 1];
      }
      pairs[place] = pair;
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    out.put(i, {pairs[i] >> kShift, pairs[i] & ((std::uint32_t{1} << kShift) - 1)});
  }
  out.count = count;
  return true;
}

// The pairs of a tested tile, the only one: counted, listed and into the result's bits.
void report(const TestedTile& tile, Result& result) {
  if (result.bits.size > 0) {
    copy_tile(tile, result.bits);
  }
  if (result.pairs.buffer.size == 0) {
    for (const std::size_t hit : tile.hits()) {
      result.pairs.count += count_bits(tile.bits()[hit / kTileWords].words[hit % kTileWords]);
    }
  } else if (!list_few(tile, result.pairs)) {
    ColumnOrder order;
    count_tile(tile, order);
    order.begin_at(0);
    list_tile(tile, order, result.pairs);
    result.pairs.count = order.total();
  }
}

void detect_in_one_tile(const Scene& scene, Result& result) {
  TestedTile tile(scene);
  tile.set_columns(0);
  tile.set_rows(0);
  if (scene.rows != nullptr) {
    tile.choose(scene.rows->wanted, scene.rows->plain);
  } else {
    tile.choose_all();
  }
  tile.run();
  report(tile, result);
}

}  // namespace

void detect_all(const Scene& scene, Result& result) {
  const std::size_t n = scene.size();
  if (scene.rows != nullptr && detect_listed(scene, result)) {
    return;
  }
  if (n <= kTileSize) {
    return detect_in_one_tile(scene, result);
  }
  TestedTile tile(scene);
  ColumnOrder order;
  for (std::size_t first = 0; first < n; first += kTileSize) {
    tile.set_columns(first);
    order.clear();
    for (std::size_t first_row = first; first_row < n; first_row += kTileSize) {
      tile.set_rows(first_row);
      tile.choose_all();
      tile.run();
      count_tile(tile, order);
      if (result.bits.size > 0) {
        copy_tile(tile, result.bits);
      }
    }
    if (result.pairs.buffer.size > 0 && order.total() > 0) {
      list_columns(tile, n, order, result.pairs);
    }
    result.pairs.count += order.total();
  }
}

}  // namespace spherechain

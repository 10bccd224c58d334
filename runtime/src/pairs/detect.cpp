// SPDX-License-Identifier: MIT
#include "runtime/src/pairs/detect_job.h"

#include <algorithm>

#include "runtime/src/base/arithmetic.h"
#include "runtime/src/base/memory.h"
#include "runtime/src/base/pair_bits.h"
#include "runtime/src/base/status.h"
#include "runtime/src/pairs/filter.h"
#include "runtime/src/pairs/spheres_to_pair.h"
#include "runtime/src/pose/pose.h"
#include "runtime/src/simd/simd.h"

namespace spherechain {
namespace {

Status check(const DetectJob& job, Target& resolved, SpheresToPair& set) {
  if (job.asset == nullptr) {
    return refuse(SC_NULL, SC_FIELD_ASSET);
  }
  const AssetView& asset = view_of(*job.asset);
  if (!asset.is_open()) {
    return refuse(SC_NOT_OPEN, SC_FIELD_ASSET);
  }
  const Status spheres_status = check_list(job.spheres, 1, SC_FIELD_SPHERES);
  if (spheres_status != SC_OK) {
    return spheres_status;
  }
  const Span<const Sphere> spheres{job.spheres, asset.spheres().size};
  if (job.sphere_count < spheres.size) {
    return refuse(SC_TOO_SMALL, SC_FIELD_SPHERES);
  }
  set.spheres = spheres;
  fetch(range_of(spheres));
  const Span<Pair> pairs{job.pairs, job.pair_capacity};
  const Span<std::uint64_t> bits{job.bits, job.bit_words};
  for (const Status& status :
       {check_list(pairs.data, pairs.size, SC_FIELD_PAIRS), check_list(bits.data, bits.size, SC_FIELD_BITS)}) {
    if (status != SC_OK) {
      return status;
    }
  }
  if (bits.size > 0 && bits.size != words_for(pairs_of(spheres.size))) {
    return refuse(SC_BAD_VALUE, SC_FIELD_BITS);
  }
  if (!is_radius(job.radius)) {
    return refuse(SC_BAD_VALUE, SC_FIELD_RADIUS);
  }
  if (job.filter != nullptr) {
    // A table holds the filter that it was made with: another beside it would be ignored in silence.
    const Status status =
        job.table != nullptr ? refuse(SC_BAD_VALUE, SC_FIELD_IGNORED_PAIRS) : check_filter(asset, *job.filter);
    if (status != SC_OK) {
      return status;
    }
  }
  if (job.table != nullptr) {
    const Status status = read_detect_table(asset, job.radius, job.table, set);
    if (status != SC_OK) {
      return status;
    }
  } else {
    set.choice = choice_of(asset, job.radius, job.filter);
  }
  if (!resolve_target(job.target, resolved)) {
    return refuse(SC_UNSUPPORTED_TARGET, SC_FIELD_TARGET);
  }
  const bool is_aliased =
      any_shared({range_of(pairs), range_of(bits)},
                 {range_of(spheres), range_of(asset.ignored()),
                  range_of(Span<const std::uint64_t>{job.table, set.table_words}), range_of(job.filter)});
  return is_aliased ? refuse(SC_ALIASED, pairs.size > 0 ? SC_FIELD_PAIRS : SC_FIELD_BITS) : done();
}

// The rest pairs in the tile's columns.
Span<const RestPair> rest_pairs_of(const SpheresToPair& set, const TilePlace& place) {
  const Span<const RestPair> all = set.choice.rest_pairs;
  if (place.column_count == set.spheres.size) {
    return all;
  }
  const auto is_before = [](const RestPair& pair, std::size_t a) { return pair.a < a; };
  const RestPair* const begin = std::lower_bound(all.begin(), all.end(), place.first_column, is_before);
  const RestPair* const end = std::lower_bound(begin, all.end(), place.first_column + place.column_count, is_before);
  return {begin, static_cast<std::size_t>(end - begin)};
}

// The pairs of a tile for which no lists are prepared.
void find_unprepared(Target target, const SpheresToPair& set, Tile& tile, FoundPairs& found) {
  constexpr std::size_t kRestRoom = 256;
  std::uint16_t wanted[kMaxStrips];
  ListedPair strips[kMaxStrips], rest_pairs[kRestRoom];
  float rest_scales[kRestRoom];
  const PairListBuffers buffers{wanted, strips, rest_pairs, rest_scales, kRestRoom};
  const std::size_t strip_count = fill_strips(target, set.choice, tile.place, buffers);
  Span<const RestPair> left = rest_pairs_of(set, tile.place);
  do {  // strips come with the last rest pairs, once they have none of them
    const std::size_t rest_count = move_rest_pairs(left, tile.place, buffers);
    const PairLists lists{wanted, strips, left.size > 0 ? 0 : strip_count, rest_pairs, rest_scales, rest_count};
    tile.lists = &lists;
    find_pairs(target, tile, found);
  } while (left.size > 0);
}

void detect(Target target, const SpheresToPair& set, PairOutput& output) {
  const std::size_t n = set.spheres.size;
  FoundPairs found(output);
  Tile tile{};
  for (std::size_t first = 0; first < n; first += kTileSize) {
    const std::size_t column_count = std::min(n - first, kTileSize);
    tile.columns = set.spheres.data + first;
    for (std::size_t first_row = first; first_row < n; first_row += kTileSize) {
      tile.place = {first, column_count, first_row, std::min(n - first_row, kTileSize)};
      tile.rows = set.spheres.data + first_row;
      if (set.has_lists) {
        tile.lists = &set.lists;
        find_pairs(target, tile, found);
      } else {
        find_unprepared(target, set, tile, found);
      }
      if (n > kTileSize) {
        output.take(tile.place, found);
      }
    }
  }
  output.finish(target, tile.place, found);
}

}  // namespace

void PairOutput::take(const TilePlace& place, FoundPairs& found) {
  const auto pair_at = [&](std::size_t i) {
    return Pair{static_cast<std::uint32_t>(place.first_column + found.pairs[i].a / sizeof(Sphere)),
                static_cast<std::uint32_t>(place.first_row + found.pairs[i].b / sizeof(Sphere))};
  };
  const Span<std::uint64_t> bits = bits_;  // a copy: for all the compiler knows, setting bits could change the member
  const std::size_t count = found.count;
  for (std::size_t i = 0; i < count && bits.size > 0; ++i) {
    set_bit(bits, ignored_bit(pair_at(i).a, pair_at(i).b));
  }
  for (std::size_t i = 0; i < count && list_.size > 0; ++i) {
    add_to_list(count_ + i, pair_at(i));
  }
  count_ += count;
  found.count = 0;
}

// A full list is a heap, its last pair first.
void PairOutput::add_to_list(std::size_t count, Pair pair) {
  if (count < list_.size) {
    list_[count] = pair;
    return;
  }
  if (count == list_.size) {
    std::make_heap(list_.begin(), list_.end());
  }
  if (pair < list_[0]) {
    std::pop_heap(list_.begin(), list_.end());
    list_[list_.size - 1] = pair;
    std::push_heap(list_.begin(), list_.end());
  }
}

void PairOutput::finish(Target resolved, const TilePlace& place, FoundPairs& found) {
  if (count_ == 0 && list_.size > 0) {  // few pairs of an only tile, as most poses have
    list_in_order(resolved, found, list_);
    list_ = {};
  }
  take(place, found);
  std::sort(list_.begin(), list_.begin() + std::min(count_, list_.size));
}

Status DetectJob::run() noexcept {
  Target resolved{};
  SpheresToPair set;
  const Status status = check(*this, resolved, set);
  if (status != SC_OK) {
    return status;
  }
  const Span<std::uint64_t> out{bits, bit_words};
  std::fill(out.begin(), out.end(), std::uint64_t{0});
  PairOutput output({pairs, pair_capacity}, out);
  detect(resolved, set, output);
  pair_count = output.count();
  // A caller who only wants the count brings no list.
  return pair_capacity > 0 && pair_count > pair_capacity ? refuse(SC_OVERFLOW, SC_FIELD_PAIRS) : done();
}

}  // namespace spherechain

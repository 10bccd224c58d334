// SPDX-License-Identifier: MIT
// prepare_crowd(), and the pairs that are tested.
#include "crowd_tables.h"

#include <tuple>

#include "crowd_launch.h"
#include "crowd_units.h"
#include "runtime/src/pairs/filter.h"
#include "runtime/src/pose/pose.h"

namespace spherechain::cuda {
namespace {

// Pairs that the caller, or else the asset, does not ignore.
struct WantedPairs {
  Span<const std::uint64_t> ignored;

  WantedPairs(const AssetView& asset, const std::uint64_t* ignored_pairs) : ignored(asset.ignored()) {
    if (ignored_pairs != nullptr) {
      ignored.data = ignored_pairs;
    }
  }
  bool operator()(std::uint32_t a, std::uint32_t b) const { return !test_bit(ignored, ignored_bit(a, b)); }
};

bool is_rest_pair(Span<const RestPair> rest, std::uint32_t a, std::uint32_t b) {
  const auto before = [](const RestPair& l, const RestPair& r) { return Pair{l.a, l.b} < Pair{r.a, r.b}; };
  return std::binary_search(rest.begin(), rest.end(), RestPair{a, b, 0}, before);
}

// For either radius.
std::uint32_t rest_pairs_max(const AssetView& asset) {
  return lanes_of(static_cast<std::uint32_t>(
      std::max(asset.rest_pairs(SC_RADIUS_FIT).size, asset.rest_pairs(SC_RADIUS_DETECT).size)));
}

// Every block of rows with all columns past its first.
std::size_t items_max(std::size_t n) {
  constexpr std::size_t kAll = kColumns * kItemColumns;
  std::size_t out = 0;
  for (std::size_t row = 0; row + 1 < n; row += kRows) {
    out += (n - 1 - row + kAll - 1) / kAll;
  }
  return out;
}

// The wanted pairs of the eight spheres from `row` on and the eight from `column` on. The last rows and columns are the
// last eight spheres, some of them again; no pair is wanted twice.
template <typename Wanted>
PairColumns columns_of(std::uint32_t n, std::uint32_t row, std::uint32_t column, const Wanted& wanted) {
  const std::uint32_t last = n < kColumns ? 0 : n - kColumns, first_row = std::min(row, last);
  PairColumns out{std::min(column, last), {0, 0}, 0};
  for (std::uint32_t b = column; b < std::min(n, column + kColumns); ++b) {
    for (std::uint32_t a = row; a < std::min(b, row + kRows); ++a) {
      if (wanted(a, b)) {
        const std::uint32_t c = b - out.first, at = kRows * (c % kHalfColumns) + (a - first_row);
        out.wanted[c / kHalfColumns] |= 1U << (kHalfItem - 1 - at);
      }
    }
  }
  return out;
}

template <typename Wanted>
std::uint32_t fill_items(std::uint32_t n, PairItem* out, const Wanted& wanted) {
  std::uint32_t count = 0;
  for (std::uint32_t row = 0; row + 1 < n; row += kRows) {
    PairItem item{};
    for (std::uint32_t column = row + 1; column < n; column += kColumns) {
      const PairColumns columns = columns_of(n, row, column, wanted);
      if ((columns.wanted[0] | columns.wanted[1]) != 0) {
        item.columns[item.count++] = columns;
      }
      if (item.count > 0 && (item.count == kItemColumns || column + kColumns >= n)) {
        item.first_row = n < kRows ? 0 : std::min(row, n - kRows);
        out[count++] = item;
        item = {};
      }
    }
  }
  std::sort(out, out + count, [](const PairItem& l, const PairItem& r) {
    return l.count != r.count ? l.count > r.count
                              : std::tie(l.first_row, l.columns[0].first) < std::tie(r.first_row, r.columns[0].first);
  });
  return count;
}

// The places of the units, and for each lane which of their pairs it tests: those of two spheres a < b that exist.
template <typename Wanted>
void fill_units(std::uint32_t n, std::uint32_t* places, std::uint32_t* words, const Wanted& wanted) {
  std::uint32_t unit = 0;
  for (std::uint32_t column = 0; column < n; column += kUnit) {
    for (std::uint32_t row = 0; row <= column; row += kUnit, ++unit) {
      places[unit] = row / kUnit | column / kUnit << 16;
      for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
        for (std::uint32_t pair = 0; pair < kLanePairs; ++pair) {
          const std::uint32_t a = row + row_of(lane, pair), b = column + column_of(lane, pair);
          if (a < b && b < n && wanted(a, b)) {
            words[unit / kWordUnits * kLanes + lane] |= 1U << (31 - unit % kWordUnits * kLanePairs - pair);
          }
        }
      }
    }
  }
}

// The sphere from which the farthest other one is nearest: seen from there, positions lose least by rounding.
std::uint32_t middle_sphere(Span<const RestSphere> spheres) {
  std::uint32_t best = 0;
  float smallest = INFINITY;
  for (std::uint32_t i = 0; i < spheres.size; ++i) {
    float farthest = 0;
    for (const RestSphere& other : spheres) {
      const float dx = other.center.x - spheres[i].center.x, dy = other.center.y - spheres[i].center.y,
                  dz = other.center.z - spheres[i].center.z;
      farthest = std::max(farthest, dx * dx + dy * dy + dz * dz);
    }
    if (farthest < smallest) {
      best = i;
      smallest = farthest;
    }
  }
  return best;
}

Status check(const Asset& asset, Radius radius, const std::uint64_t* ignored_pairs, const std::uint64_t* words,
             std::size_t count) {
  const Status status = first_of({
      {!view_of(asset).is_open(), SC_NOT_OPEN, SC_FIELD_ASSET},
      {!is_radius(radius), SC_BAD_VALUE, SC_FIELD_RADIUS},
      {words == nullptr, SC_NULL, SC_FIELD_TABLE},
      {reinterpret_cast<std::uintptr_t>(words) % alignof(Float4) != 0, SC_MISALIGNED, SC_FIELD_TABLE},
      {count < crowd_table_words(asset), SC_TOO_SMALL, SC_FIELD_TABLE},
  });
  return status == SC_OK ? check_list(ignored_pairs, 0, SC_FIELD_IGNORED_PAIRS) : status;
}

// Without memory only counts its words.
void fill(const AssetView& asset, Radius radius, const std::uint64_t* ignored_pairs, TableMemory& memory) {
  const auto n = static_cast<std::uint32_t>(asset.spheres().size);
  std::uint32_t start = 0;
  TableHeader places{};
  TableHeader* const words = memory.take<TableHeader>(1, start);
  TableHeader& header = memory.is_null() ? places : *words;
  add_moments(asset, radius, memory, header);
  auto* const rest_pairs = memory.take<RestPairItem>(rest_pairs_max(asset), header.rest_pairs);
  auto* const items = memory.take<PairItem>(items_max(n), header.items);
  const std::size_t unit_words = words_of_units(units_of(n));
  auto* const unit_places = memory.take<std::uint32_t>(unit_words * kWordUnits, header.unit_places);
  auto* const unit_pairs = memory.take<std::uint32_t>(unit_words * kLanes, header.wanted);
  if (memory.is_null()) {
    return;
  }
  header.magic = kTableMagic;
  header.sphere_count = n;
  header.bit_words = static_cast<std::uint32_t>(words_for(pairs_of(n)));
  header.origin_sphere = middle_sphere(asset.spheres());
  const WantedPairs wanted(asset, ignored_pairs);
  const Span<const RestPair> rest = asset.rest_pairs(radius);
  const auto is_tested = [&](auto a, auto b) { return wanted(a, b) && !is_rest_pair(rest, a, b); };
  for (const RestPair& pair : rest) {
    if (wanted(pair.a, pair.b)) {
      rest_pairs[header.rest_pair_count++] = {pair.a, pair.b, pair.rest_scale, 0};
    }
  }
  header.item_count = fill_items(n, items, is_tested);
  fill_units(n, unit_places, unit_pairs, is_tested);
}

}  // namespace

std::size_t crowd_table_words(const Asset& asset) noexcept {
  TableMemory memory(nullptr);
  if (view_of(asset).is_open()) {
    fill(view_of(asset), SC_RADIUS_FIT, nullptr, memory);
  }
  return memory.used();
}

Status prepare_crowd(const Asset& asset, Radius radius, const std::uint64_t* ignored_pairs, std::uint64_t* words,
                     std::size_t word_count) noexcept {
  const Status status = check(asset, radius, ignored_pairs, words, word_count);
  if (status == SC_OK) {
    TableMemory memory(words);
    fill(view_of(asset), radius, ignored_pairs, memory);
  }
  return status;
}

}  // namespace spherechain::cuda

// SPDX-License-Identifier: MIT
// CrowdTables::build, and the pairs that are tested.
#include "crowd_tables.h"

#include <algorithm>
#include <tuple>

#include "crowd_units.h"
#include "spherechain/detect.h"

namespace spherechain::cuda {
namespace {

bool test_bit(Span<const std::uint64_t> words, std::size_t bit) { return (words[bit / 64] >> (bit % 64) & 1U) != 0; }

// Pairs that the filter, or without one the asset, does not ignore.
struct WantedPairs {
  Span<const std::uint64_t> ignored, disabled;

  WantedPairs(const Asset& asset, const Filter* filter) : ignored(asset.ignored()) {
    if (filter != nullptr) {
      ignored = {filter->ignored.data, filter->ignored.size};
      disabled = {filter->disabled.data, filter->disabled.size};
    }
  }
  bool is_enabled(std::size_t i) const { return disabled.size == 0 || !test_bit(disabled, i); }
  bool operator()(std::uint32_t a, std::uint32_t b) const {
    return !test_bit(ignored, std::size_t{b} * (b - 1) / 2 + a) && is_enabled(a) && is_enabled(b);
  }
};

std::size_t rest_places(std::size_t count) { return lanes_of(static_cast<std::uint32_t>(count)); }

bool is_rest_pair(Span<const NearPair> rest, std::uint32_t a, std::uint32_t b) {
  const auto before = [](const NearPair& pair, const Pair& at) { return Pair{pair.a, pair.b} < at; };
  const NearPair* found = std::lower_bound(rest.begin(), rest.end(), Pair{a, b}, before);
  return found != rest.end() && found->a == a && found->b == b;
}

std::uint32_t fill_rest_pairs(const WantedPairs& wanted, Span<const NearPair> rest, RestPair* out) {
  std::uint32_t count = 0;
  for (const NearPair& pair : rest) {
    if (wanted(pair.a, pair.b)) {
      out[count++] = {pair.a, pair.b, pair.reach, 0};
    }
  }
  return count;
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

std::size_t unit_words(std::size_t n) { return words_of_units(units_of(static_cast<std::uint32_t>(n))); }

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
  float least = INFINITY;
  for (std::uint32_t i = 0; i < spheres.size; ++i) {
    float most = 0;
    for (const RestSphere& other : spheres) {
      const float dx = other.center.x - spheres[i].center.x, dy = other.center.y - spheres[i].center.y,
                  dz = other.center.z - spheres[i].center.z;
      most = std::max(most, dx * dx + dy * dy + dz * dz);
    }
    if (most < least) {
      best = i;
      least = most;
    }
  }
  return best;
}

Status check(const Asset& asset, RadiusKind radius, const Filter* filter, Span<std::uint64_t> memory) {
  if (!asset.is_open()) {
    return Status::kNotOpen;
  }
  if (radius != RadiusKind::kFit && radius != RadiusKind::kDetect) {
    return Status::kBadArgument;
  }
  if (memory.data == nullptr) {
    return Status::kNullArgument;
  }
  if (reinterpret_cast<std::uintptr_t>(memory.data) % alignof(Float4) != 0) {
    return Status::kMisaligned;
  }
  const Status status = filter != nullptr ? check_filter(asset, *filter) : Status::kOk;
  return status == Status::kOk && memory.size < CrowdTables::words_needed(asset) ? Status::kContextTooSmall : status;
}

}  // namespace

std::size_t CrowdTables::words_needed(const Asset& asset) noexcept {
  if (!asset.is_open()) {
    return 0;
  }
  const std::size_t n = asset.spheres().size;
  const std::size_t rest =
      std::max(asset.near_pairs(RadiusKind::kFit).size, asset.near_pairs(RadiusKind::kDetect).size);
  return words_of(sizeof(TableHeader)) + moment_words(asset) + words_of(n * sizeof(float)) +
         words_of(rest_places(rest) * sizeof(RestPair)) + words_of(items_max(n) * sizeof(PairItem)) +
         words_of(unit_words(n) * kWordUnits * sizeof(std::uint32_t)) +
         words_of(unit_words(n) * kLanes * sizeof(std::uint32_t));
}

Status CrowdTables::build(const Asset& asset, RadiusKind radius, const Filter* filter,
                          Span<std::uint64_t> memory) noexcept {
  const Status status = check(asset, radius, filter, memory);
  if (status != Status::kOk) {
    return status;
  }
  const auto n = static_cast<std::uint32_t>(asset.spheres().size);
  TableMemory arrays(memory);
  std::uint32_t start = 0;
  TableHeader& header = *arrays.take<TableHeader>(1, start);
  header.sphere_count = n;
  header.bit_words = static_cast<std::uint32_t>(DetectJob::bit_words(asset));
  header.origin_sphere = middle_sphere(asset.spheres());
  header.has_padding = filter != nullptr && filter->padding.size > 0 ? 1 : 0;
  add_moments(asset, radius, arrays, header);
  auto* paddings = arrays.take<float>(n, header.paddings);
  if (header.has_padding != 0) {
    std::copy_n(filter->padding.begin(), n, paddings);
  }
  const WantedPairs wanted(asset, filter);
  const Span<const NearPair> rest = asset.near_pairs(radius);
  header.rest_pair_count =
      fill_rest_pairs(wanted, rest, arrays.take<RestPair>(rest_places(rest.size), header.rest_pairs));
  const auto is_tested = [&](auto a, auto b) { return wanted(a, b) && !is_rest_pair(rest, a, b); };
  header.item_count = fill_items(n, arrays.take<PairItem>(items_max(n), header.items), is_tested);
  auto* unit_places = arrays.take<std::uint32_t>(unit_words(n) * kWordUnits, header.unit_places);
  fill_units(n, unit_places, arrays.take<std::uint32_t>(unit_words(n) * kLanes, header.wanted), is_tested);
  words = {memory.data, arrays.used()};
  return Status::kOk;
}

}  // namespace spherechain::cuda

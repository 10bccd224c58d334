// SPDX-License-Identifier: MIT
// What all tables are built of: entries one after another, and the pairs that are tested.
#pragma once

#include <algorithm>
#include <tuple>

#include "crowd_units.h"
#include "spherechain/detect.h"

namespace spherechain::cuda {

constexpr std::size_t words_of(std::size_t bytes) { return (bytes + 15) / 16 * 2; }

// Entries one after another, zero where nothing is written.
class TableMemory {
 public:
  explicit TableMemory(Span<std::uint64_t> memory) : memory_(memory) {}

  template <typename T>
  T* take(std::size_t count, std::uint32_t& at) {
    at = static_cast<std::uint32_t>(used_);
    std::uint64_t* begin = memory_.data + used_;
    used_ += words_of(count * sizeof(T));
    std::fill(begin, memory_.data + used_, std::uint64_t{0});
    return reinterpret_cast<T*>(begin);
  }
  std::size_t used() const { return used_; }

 private:
  Span<std::uint64_t> memory_;
  std::size_t used_ = 0;
};

inline bool test_bit(Span<const std::uint64_t> words, std::size_t bit) {
  return ((words[bit / 64] >> (bit % 64)) & 1U) != 0;
}

// By the filter, or where there is none by what the asset ignores.
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

// Of each block of rows, with all columns that are past the first of them.
inline std::size_t most_items(std::size_t n) {
  constexpr std::size_t kAll = kColumns * kItemColumns;
  std::size_t out = 0;
  for (std::size_t row = 0; row + 1 < n; row += kRows) {
    out += (n - 1 - row + kAll - 1) / kAll;
  }
  return out;
}

// Which of the pairs of eight spheres from `row` on with eight from `column` on are wanted. The last rows and columns
// are those of the last eight spheres, some of them again: no pair is wanted twice.
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

inline std::size_t unit_words(std::size_t n) { return words_of_units(units_of(static_cast<std::uint32_t>(n))); }

inline std::size_t words_of_pairs(std::size_t n) {
  return words_of(unit_words(n) * kWordUnits * sizeof(std::uint32_t)) +
         words_of(unit_words(n) * kLanes * sizeof(std::uint32_t));
}

// Where the units are, and which of their pairs each lane is to find: only those of a < b, both of them spheres there
// are.
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

// The sphere in the middle: the nearer the others are to it, the less their distances lose by rounding.
inline std::uint32_t middle_sphere(Span<const RestSphere> spheres) {
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

inline void fill_paddings(const Filter* filter, float* out) {
  if (filter != nullptr && filter->padding.size > 0) {
    std::copy(filter->padding.begin(), filter->padding.end(), out);
  }
}

// The bones that an array of terms names, ascending, each once. Returns how many; `index_of_bone` is told of each.
template <typename Told>
std::uint32_t fill_bones(Span<const std::uint32_t> term_bones, std::size_t bone_count, std::uint32_t* used,
                         const Told& index_of_bone) {
  std::uint32_t count = 0;
  for (std::uint32_t bone = 0; bone < bone_count; ++bone) {
    bool is_used = false;
    for (std::size_t t = 0; t < term_bones.size; ++t) {
      if (term_bones[t] == bone) {
        index_of_bone(t, count);
        is_used = true;
      }
    }
    if (is_used) {
      used[count++] = bone;
    }
  }
  return count;
}

// Whether spheres follow bones by moments.
inline bool has_moments(const Asset& asset) {
  return asset.refit_rule() == RefitRule::kMoments && asset.moment_tables().spheres.size > 0;
}

// What may be wrong with the arguments of any build().
Status check_build(const Asset& asset, const Filter* filter, Span<std::uint64_t> memory, std::size_t words);

}  // namespace spherechain::cuda

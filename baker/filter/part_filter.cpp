// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/filter/part_filter.h"

#include <algorithm>
#include <utility>

#include "baker/filter/touching_parts.h"

namespace spherechain::baker {

const char* kind_name(PairKind kind) {
  switch (kind) {
    case PairKind::kAdjacent:
      return "adjacent";
    case PairKind::kAlways:
      return "always";
    case PairKind::kRest:
      return "rest";
    case PairKind::kSometimes:
      return "sometimes";
    case PairKind::kNever:
      break;
  }
  return "never";
}

const FilteredPair& PartFilter::of(std::size_t a, std::size_t b) const {
  if (a > b) std::swap(a, b);
  const std::size_t before = a * (2 * parts.size() - a - 1) / 2;  // pairs whose first part is before a
  return pairs[before + (b - a - 1)];
}

std::vector<Pair> idle_sphere_pairs(const OpenAsset& asset, const PartFilter& filter) {
  const std::vector<std::vector<std::uint8_t>> parts = parts_of_spheres(asset);
  const auto never_meet = [&](std::size_t p, std::size_t q) {
    if (p == q) return false;
    const FilteredPair& pair = filter.of(p, q);
    return pair.kind == PairKind::kNever ||
           (pair.kind == PairKind::kAdjacent && pair.clip_poses == 0 && pair.random_poses == 0);
  };
  const auto is_idle = [&](std::size_t a, std::size_t b) {
    return std::all_of(parts[a].begin(), parts[a].end(), [&](std::size_t p) {
      return std::all_of(parts[b].begin(), parts[b].end(), [&](std::size_t q) { return never_meet(p, q); });
    });
  };
  const auto is_ignored = [&](std::size_t a, std::size_t b) {
    const std::size_t bit = b * (b - 1) / 2 + a;
    return (asset->ignored()[bit / 64] >> (bit % 64) & 1) != 0;
  };
  std::vector<Pair> out;
  for (std::uint32_t a = 0; a < parts.size(); ++a) {
    for (std::uint32_t b = a + 1; b < parts.size(); ++b) {
      const bool have_skin = !parts[a].empty() && !parts[b].empty();
      if (have_skin && !is_ignored(a, b) && is_idle(a, b)) out.push_back({a, b});
    }
  }
  return out;
}

}  // namespace spherechain::baker

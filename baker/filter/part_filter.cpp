// SPDX-License-Identifier: GPL-3.0-or-later
#include "filter/part_filter.h"

#include <algorithm>
#include <utility>

#include "play/play.h"

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
  const BodyParts parts = parts_of(asset);
  std::vector<std::vector<std::uint8_t>> parts_of_sphere(asset->spheres().size);
  for (std::size_t s = 0; s < parts_of_sphere.size(); ++s) {
    std::vector<std::uint8_t>& own = parts_of_sphere[s];
    for (const std::uint32_t t : asset.triangles_of(s)) own.push_back(parts.of_triangle[t]);
    std::sort(own.begin(), own.end());
    own.erase(std::unique(own.begin(), own.end()), own.end());
  }
  const auto never_met = [&](std::size_t p, std::size_t q) {
    if (p == q) return false;
    const FilteredPair& pair = filter.of(p, q);
    return pair.kind == PairKind::kNever ||
           (pair.kind == PairKind::kAdjacent && pair.clip_poses == 0 && pair.random_poses == 0);
  };
  const auto is_ignored = [&](std::size_t a, std::size_t b) {
    const std::size_t bit = b * (b - 1) / 2 + a;
    return (asset->ignored()[bit / 64] >> (bit % 64) & 1) != 0;
  };
  std::vector<Pair> out;
  for (std::uint32_t a = 0; a < parts_of_sphere.size(); ++a) {
    for (std::uint32_t b = a + 1; b < parts_of_sphere.size(); ++b) {
      const std::vector<std::uint8_t>&of_a = parts_of_sphere[a], &of_b = parts_of_sphere[b];
      if (of_a.empty() || of_b.empty() || is_ignored(a, b)) continue;
      const bool is_idle = std::all_of(of_a.begin(), of_a.end(), [&](std::uint8_t p) {
        return std::all_of(of_b.begin(), of_b.end(), [&](std::uint8_t q) { return never_met(p, q); });
      });
      if (is_idle) out.push_back({a, b});
    }
  }
  return out;
}

}  // namespace spherechain::baker

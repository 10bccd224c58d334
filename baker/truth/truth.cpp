// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/truth/truth.h"

#include <algorithm>
#include <map>

namespace spherechain::baker {

FrameTruth frame_truth(const Intersections& found, const std::vector<Pair>& rest_pairs, const TruthSurface& surface,
                       const std::function<bool(std::uint32_t, std::uint32_t)>& is_ignored,
                       const std::function<bool(const Pair&)>& is_far) {
  FrameTruth out;
  out.raw_pairs = found.pairs.size();
  out.degenerate = found.degenerate;
  std::map<Pair, std::vector<Pair>> contacts;
  for (const Pair& pair : found.pairs) {
    const auto [a, b] =
        std::minmax({surface.sphere[surface.of_source[pair.a]], surface.sphere[surface.of_source[pair.b]]});
    if (std::binary_search(rest_pairs.begin(), rest_pairs.end(), pair)) {
      ++out.rest;
      continue;
    }
    if (is_far(pair)) out.far.push_back(pair);
    if (a == b) {
      ++out.same_sphere;
      out.neighbours.push_back(pair);
    } else if (is_ignored(a, b)) {
      ++out.ignored;
      out.neighbours.push_back(pair);
    } else {
      out.pairs.push_back(pair);
      contacts[{a, b}].push_back(pair);
    }
  }
  for (auto& [spheres, triangles] : contacts) out.contacts.push_back({spheres, std::move(triangles)});
  return out;
}

}  // namespace spherechain::baker

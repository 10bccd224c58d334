// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/truth/missed_depth.h"

#include <algorithm>

#include "baker/play/skin_player.h"

namespace spherechain::baker {

MissedDepth::MissedDepth(const std::vector<std::uint8_t>& part_of, const FrameTruth& truth,
                         const std::vector<Pair>& reported, const std::vector<Penetration>& penetrations)
    : part_of_(part_of) {
  for (const Penetration& found : penetrations) {
    if (is_fault(found.kind))
      depths_[{std::min(found.part, found.other), std::max(found.part, found.other)}] = double{found.measures.depth};
  }
  for (const TrueContact& contact : truth.contacts) {
    if (!std::binary_search(reported.begin(), reported.end(), contact.spheres)) continue;
    for (const Pair& triangles : contact.triangles) depths_.erase(part_pair_of(triangles));
  }
}

double MissedDepth::operator()(const TrueContact& contact) const {
  double deepest = 0;
  for (const Pair& triangles : contact.triangles) {
    const auto found = depths_.find(part_pair_of(triangles));
    if (found != depths_.end()) deepest = std::max(deepest, found->second);
  }
  return deepest;
}

Pair MissedDepth::part_pair_of(const Pair& triangles) const {
  const auto [a, b] = std::minmax(part_of_[triangles.a], part_of_[triangles.b]);
  return {a, b};
}

}  // namespace spherechain::baker

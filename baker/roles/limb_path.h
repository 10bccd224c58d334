// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/roles/names.h"
#include "baker/roles/skeleton.h"

namespace spherechain::baker {

// Which section of a limb a node belongs to, from the trunk outwards.
enum Rank { kGirdle, kUpper, kLower, kExtremity, kDigit };

// A limb by the hints: its joints from the trunk to the tip of its longest digit.
struct LimbPath {
  Family family;
  NamedSide side;
  Place place;
  std::vector<int> roots;  // where it leaves the trunk; several where an exporter tore the chain apart
  std::vector<int> nodes;
  std::vector<Rank> ranks;  // of `nodes`, ascending

  int first(Rank rank) const;  // position in `nodes`, -1 none
};

std::vector<LimbPath> find_limb_paths(const Skeleton& skeleton, const std::vector<Hint>& hints);

// The path from a node to a tip: by the children whose limb words go on farthest, then to the farthest tip.
std::vector<int> main_path(const Skeleton& skeleton, const std::vector<Hint>& hints, int top, Family family);

// In a chain of joints, the first of the two consecutive bones that are both long: upper arm or thigh.
// `lengths[i]` is the distance from joint i to the next.
std::size_t find_long_bones(const std::vector<double>& lengths);

}  // namespace spherechain::baker

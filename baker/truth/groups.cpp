// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/truth/groups.h"

#include <algorithm>

namespace spherechain::baker {
namespace {

bool contains(const std::vector<Pair>& sorted, const Pair& pair) {
  return std::binary_search(sorted.begin(), sorted.end(), pair);
}

void count(PairGroup& group, const TrueContact& contact, bool found) {
  group.true_pairs += contact.triangles.size();
  if (found) group.found_pairs += contact.triangles.size();
}

}  // namespace

RegionGroups::RegionGroups(const OpenAsset& asset) : regions_(asset->region_count()) {
  for (const RestSphere& sphere : asset->spheres()) region_of_.push_back(sphere.region);
  for (std::size_t a = 0; a < regions_; ++a) {
    for (std::size_t b = 0; b < regions_; ++b) {
      groups_.push_back({std::string(asset->region(a).name) + " - " + asset->region(b).name});
    }
  }
}

PairGroup& RegionGroups::of(const Pair& pair) {
  const auto [a, b] = std::minmax(region_of_[pair.a], region_of_[pair.b]);
  return groups_[a * regions_ + b];
}

void RegionGroups::add(const FrameTruth& truth, const std::vector<Pair>& reported) {
  for (const TrueContact& contact : truth.contacts) {
    count(of(contact.spheres), contact, contains(reported, contact.spheres));
  }
  for (const Pair& pair : reported) ++of(pair).reported;
}

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/segment/segment.h"

#include <algorithm>

namespace spherechain::baker {

std::vector<Index> triangles_of_region(const Regions& regions, std::uint8_t region) {
  std::vector<Index> triangles;
  for (Index t = 0; t < regions.of_triangle.size(); ++t) {
    if (regions.of_triangle[t] == region) triangles.push_back(t);
  }
  return triangles;
}

bool is_biped(const Regions& regions) {
  return regions.limbs.size() == kTorso && !regions.is_tree() &&
         std::equal(regions.limbs.begin(), regions.limbs.end(), kRegionNames.begin(),
                    [](const Limb& limb, const char* name) { return limb.name == name; });
}

}  // namespace spherechain::baker

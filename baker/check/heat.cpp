// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/check/heat.h"

#include <algorithm>
#include <map>

namespace spherechain::baker {

std::vector<HeatSpot> heat_of(const ClipEvents& found, double mm) {
  struct Heat {
    HeatSpot spot;
    int last;  // frame
  };
  std::vector<HeatSpot> out;
  for (std::uint32_t e = 0; e < found.spans.size(); ++e) {
    std::map<std::uint32_t, Heat> heat;
    for (const std::size_t m : found.spans[e].penetrations) {
      const auto& [frame, penetration] = found.penetrations[m];
      if (!is_fault(penetration.kind)) continue;
      for (const TrianglePair& pair : found.contacts[m]) {
        for (const std::uint32_t t : pair) {
          auto& [spot, last] = heat.try_emplace(t, Heat{{e, t, 0, 0}, -1}).first->second;
          spot.frames += last != frame ? 1 : 0;
          spot.depth_mm = std::max(spot.depth_mm, static_cast<float>(mm * double{penetration.measures.depth}));
          last = frame;
        }
      }
    }
    for (const auto& [triangle, one] : heat) out.push_back(one.spot);
  }
  return out;
}

}  // namespace spherechain::baker

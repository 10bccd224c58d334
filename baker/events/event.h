// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "baker/mesh/mesh.h"
#include "spherechain/contacts.h"

namespace spherechain::baker {

// One visible fault, or contact that is none: penetrations of the same two body parts, joined over frames.
struct Event {
  std::array<std::string, 2> parts;        // names; the part that goes in first
  PenetrationClass kind = SC_CLASS_REST;   // of the deepest frame, like all members below
  double from = 0, to = 0, deepest = 0;    // frames, with a fraction between two; from > to: over the seam of a loop
  int first_place = 0, place = 0;          // of `from` and `deepest` among the frames that were looked at
  double depth_mm = 0, depth_percent = 0;  // percent of the character's height
  double volume_ml = -1;                   // -1: not known
  double swallowed = 0;                    // the share of parts[0] that is inside parts[1]
  bool passes_through = false;             // and comes out again
  Vec3 direction = Vec3::Zero();           // the way out of parts[1] for parts[0]
  Vec3 point = Vec3::Zero();               // the point of parts[0] that is deepest; the pose's space, source units
  std::optional<Vec3> eye;                 // of a fault: from the point to an eye that sees it; unit length
  std::vector<float> depths_mm;            // of a fault: in each frame of it; 0 where it is none
  int picture = 0;                         // of the clip's pictures the one that shows it; 0: none does
};

// The frames in which it is a fault.
inline std::size_t faulty_frames(const Event& event) {
  const auto& depths = event.depths_mm;
  return static_cast<std::size_t>(std::count_if(depths.begin(), depths.end(), [](float depth) { return depth > 0; }));
}

}  // namespace spherechain::baker

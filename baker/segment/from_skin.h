// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "baker/import/import.h"
#include "baker/mesh/polyline.h"
#include "baker/roles/roles.h"

namespace spherechain::baker {

// A limb's centre line through its joints.
struct SkinLimb {
  Polyline line;     // from the cut at shoulder or hip to the tip of hand or foot
  double extremity;  // arc length of wrist or ankle; the line's length where there is none
};

// Which part of the body every triangle is, as the rig's weights say.
struct SkinRegions {
  static constexpr std::uint8_t kNoLimb = 255;  // torso, neck and head
  std::vector<std::uint8_t> of_triangle;        // a triangle of the body -> index in Roles::limbs, or kNoLimb
  std::vector<std::uint8_t> of_skin;            // the same of Character::skin
  std::vector<SkinLimb> limbs;                  // as in Roles::limbs; a limb that moves no skin has an empty line
};

// A triangle belongs to the limb whose joints move it most. A limb begins at the first ring of rays around it that
// meets (almost) nothing else, so that armpit and crotch belong to the torso. On each piece of the skin a region is
// connected. The body must be of the skin, and the character have weights; `roles` are those of its rig.
SkinRegions segment_from_skin(const Character& character, const BodyMesh& body, const Roles& roles);

}  // namespace spherechain::baker

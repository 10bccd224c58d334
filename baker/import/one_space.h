// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "baker/import/source_rig.h"

namespace spherechain::baker {

struct BoundJoint {
  Index node;
  std::size_t skin;
  Affine place;  // where the skin binds it
};

// True if skins were bound in one space, whatever pose the file shows: each joint is as far along the one above as its
// node is, for a pose turns joints and does not move them. False where no such joints lead from skin to skin.
bool were_bound_in_one_space(const std::vector<Node>& nodes, const std::vector<BoundJoint>& joints);

}  // namespace spherechain::baker

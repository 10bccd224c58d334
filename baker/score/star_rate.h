// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "baker/score/scored_skin.h"

namespace spherechain::baker {

// The penetration rate of R2ET (Zhang et al., CVPR 2023) and STaR (Yang et al., ICCV 2025; its code calls it
// penetrate_1): of the vertices of forearms, upper arms, hands, shins and feet, the share that lies behind the nearest
// vertex of the rest of the body, by that vertex's normal. It cannot see how deep a vertex lies, or through which part,
// and sees nothing of trunk, thighs and head; a vertex beside a convex edge may count without a contact, so that it has
// a floor of up to 2.5 % in a T-pose.
struct StarCount {
  std::size_t vertices = 0, inside = 0;
};
StarCount count_star(const ScoredSkin& skin, const std::vector<Vec3>& positions, const std::vector<Vec3>& normals);

// For each limb how far its hand or foot is from the skin without that limb, in the source's units.
std::array<double, kLimbs> ends_from_body(const ScoredSkin& skin, const std::vector<Vec3>& positions);

}  // namespace spherechain::baker

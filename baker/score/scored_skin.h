// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "baker/mesh/mesh.h"

namespace spherechain::baker {

// The four limbs that benchmarks look at.
enum class ScoredLimb : std::uint8_t { kLeftArm, kRightArm, kLeftLeg, kRightLeg };
inline constexpr std::size_t kLimbs = 4;

// Where a vertex is: on a limb, on its first joint above that (clavicle, thigh), or neither.
struct VertexPlace {
  bool is_on_limb = false, is_beside_limb = false;
  bool is_end = false;  // of a hand or foot
  ScoredLimb limb = ScoredLimb::kLeftArm;
};

// A character's skin as metrics see it. All but the triangles is by vertex of the source.
struct ScoredSkin {
  std::vector<Vec3> rest;
  std::vector<Triangle> triangles;
  std::vector<Index> joined;        // the first vertex at the same rest position
  std::vector<VertexPlace> places;  // by the bone that moves it most
};

ScoredSkin scored_skin(const std::vector<Vec3>& rest, const std::vector<Triangle>& triangles);

}  // namespace spherechain::baker

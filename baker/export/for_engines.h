// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/volumes/colliders.h"

// Colliders as game engines can hold them. Each function replaces what they cannot, and adds a sentence to `notes`
// where something is lost.
namespace spherechain::baker {

// Replaces a cone by its larger ball if that ball contains the smaller one. This is exact.
void use_balls(Colliders& colliders);

// Replaces each cone by a capsule of the cone's mean radius.
void use_capsules_for_cones(Colliders& colliders, std::vector<std::string>& notes);

// Replaces each ellipsoid by a capsule: as long as its longest axis, with the mean of its other radii.
void use_capsules_for_ellipsoids(Colliders& colliders, std::vector<std::string>& notes);

// Drops bodies that have no bone or no volume. Throws Error(kFile) where none is left.
void keep_bodies_on_bones(Colliders& colliders, std::vector<std::string>& notes);

// Bodies of one bone become one body, the first's. Two bodies are ignored where all of their parts are.
void join_bodies_of_a_bone(Colliders& colliders, std::vector<std::string>& notes);

// The rotation that takes +Y (`axis` 1) or +Z (2) along a direction; of no direction none.
Eigen::Quaterniond turn_to(int axis, const Vec3& direction);

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "baker/import/import.h"
#include "baker/mesh/surface_query.h"

namespace spherechain::baker {

// Carries the labels of the body's triangles to the skin's. `surface` searches the body. Where the body is part of the
// skin its triangles keep theirs, and other pieces (eyes) go as a whole to the region they are nearest to. Where it is
// a surface of its own around the skin, a triangle takes the label of the surface nearest to it that faces the same way
// or the opposite one, and within each piece of the skin small islands join what is around them.
std::vector<std::uint8_t> label_skin(const Character& character, const BodyMesh& body, const SurfaceQuery& surface,
                                     const std::vector<std::uint8_t>& labels_of_body);

}  // namespace spherechain::baker

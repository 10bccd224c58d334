// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "baker/mesh/attempt.h"
#include "baker/wrap/closing_report.h"

namespace spherechain::baker {

// The largest piece of the repaired skin. Its triangles are those of the source, and fans in former holes. There is no
// result where it is not closed or not most of the skin.
Attempt<BodyMesh> repair_body(const Character& character, ClosingReport& report);

// True if a body is all of the skin, but for so little that a wrap of the skin could not show another limb.
bool covers_skin(const BodyMesh& body, const Mesh& skin);

// Vertices of a border that are closer than this were one. In the mesh's units.
double crack_width(const Mesh& skin);

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "baker/mesh/attempt.h"
#include "baker/wrap/closing_report.h"

namespace spherechain::baker {

// Makes the body the largest piece of the repaired skin. Its triangles are those of the source, and fans in former
// holes. Where that is not closed or not most of the skin the body stays as it was, and the reason is returned.
std::optional<Reason> repair_body(Character& character, ClosingReport& report);

// True if the body is all of the skin, but for so little that a wrap of the skin could not show another limb.
bool covers_skin(const Character& character);

// Vertices of a border that are closer than this were one. In the mesh's units.
double crack_width(const Mesh& skin);

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>
#include <vector>

#include "baker/bind/bind.h"
#include "baker/bind/body_parts.h"
#include "baker/edits/edit_spheres.h"

namespace spherechain::baker {

using PartPairs = std::vector<std::array<std::string, 2>>;

// Gives each part of these pairs a sphere in each region that has triangles of the part, but no sphere that is most of
// all the part's; and other parts, too, whose triangles are in spheres of these. So the spheres of two parts can ignore
// each other, and no others need to.
Spheres add_part_spheres(const Character& character, const Regions& regions, const Spheres& spheres,
                         const BodyParts& parts, const PartPairs& pairs);

// Makes all spheres of two body parts ignore each other, pair by pair. Where a sphere has triangles of a named part
// and of others, those that are not its own go to the nearest sphere of their part in the region: so contacts of these
// parts are left out, and no others'. `gap` is BindSettings::neighbour_gap as a length.
void ignore_parts(const Character& character, const Regions& regions, const Spheres& spheres, const BodyParts& parts,
                  const PartPairs& pairs, double gap, Binding& binding, EditsDone& done);

}  // namespace spherechain::baker

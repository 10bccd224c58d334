// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "baker/bind/bind.h"
#include "baker/edits/edits.h"

namespace spherechain::baker {

// Result of applying edits.
struct EditsDone {
  std::size_t applied = 0;
  std::vector<std::string> missed;  // a line each: which edit was not applied, or not as it says, and why
  std::vector<std::string> notes;   // a line each: side effects of edits
};

// An edit that was applied.
struct AppliedEdit {
  std::size_t edit;      // its place in Edits::spheres
  std::uint32_t sphere;  // the sphere it changed or added
};

// Changes fitted spheres. An edit is about the sphere of its region whose centre is nearest to `from`, if that lies in
// it; each sphere is one edit's. A region keeps its last sphere. Edits that would end far from their region's skin are
// missed. Links and owners of triangles follow. `applied` gets the edits that changed or added a sphere.
Spheres edit_spheres(const Character& character, const Regions& regions, const Spheres& spheres,
                     const std::vector<SphereEdit>& edits, EditsDone& done, std::vector<AppliedEdit>& applied);

// A sphere for a body part in a region.
struct PartSphere {
  std::uint8_t region;
  int part;  // its number
  Ball ball;
};

// Adds them, in the order of the chain beside the nearest sphere. Level, side and axis become that one's.
Spheres insert_spheres(const Character& character, const Regions& regions, const Spheres& spheres,
                       const std::vector<PartSphere>& added);

// Says which spheres do not stand where they were asked to: the skin that carries one may be too far away. `spheres`
// are what edit_spheres() returned.
void check_places(const Regions& regions, const Spheres& spheres, const Binding& binding,
                  const std::vector<SphereEdit>& edits, const std::vector<AppliedEdit>& applied, EditsDone& done);

}  // namespace spherechain::baker

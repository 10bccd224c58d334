// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "baker/import/import.h"
#include "baker/rig/rig.h"
#include "baker/roles/roles.h"
#include "baker/segment/segment.h"

namespace spherechain::baker {

// A part of the body by its everyday name: "head", "left hand", "tail". A hand includes its fingers, a foot its toes.
struct BodyPart {
  std::string name;  // unique
  Side side;
  int bone;         // the bone it follows: index in the character's bones, else in the automatic rig's joints; -1 none
  int parent = -1;  // the part it hangs on: that of the nearest bone above which a part follows; -1 none
  std::uint8_t mobility = 0;  // sc_part.mobility
  bool is_prop = false;       // a weapon, or what else hangs on a joint as a thing of its own (only in a bake)
};

struct BodyParts {
  std::vector<BodyPart> parts;            // at most 255; those that follow bones come first, in the order of these
  std::vector<std::uint8_t> of_triangle;  // a source triangle -> index in `parts`
};

// A bone's part follows from its role: a bone without a role belongs to its nearest ancestor with one. Ears, hair,
// wings, garments, bags and weapons that have bones of their own are parts of their own; a bone without any role above
// it is a part of its name. A triangle belongs to the part whose bones move its corners most. A mesh that one part
// moves, and whose name says hair, a bag, a hat or a weapon, is a part on that part. Triangles that no bone moves take
// the name of their region. Parts without a triangle are left out; only where nothing moves the character its regions,
// in their order, are the parts. `joints` and `rig_weights` are the automatic rig's, for a character without bones.
BodyParts find_body_parts(const Character& character, const Roles& roles, const Regions& regions,
                          const std::vector<Joint>& joints, const std::vector<VertexWeights>& rig_weights);

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bind/body_parts.h"

namespace spherechain::baker {

// Sets each part's parent: the part of the nearest bone above. A part without such a bone (a spider's legs on a root
// bone that moves no skin, a foot that hangs on the scene) takes the part that its skin touches most at rest; -1 where
// it touches none, and for the largest of the parts that have no bone above.
void find_parents(const Character& character, const std::vector<Joint>& joints, BodyParts& parts);

}  // namespace spherechain::baker

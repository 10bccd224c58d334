// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "import/source_rig.h"

namespace spherechain::baker {

// What deforms a character in one frame: linear in the rest positions, so that a page or a game can do it too.
struct Deformation {
  std::vector<Affine> bones;  // rest -> deformed, a bone each
};

class Motion {
 public:
  virtual ~Motion() = default;
  // t from 0, the start, to 1, the end.
  virtual Deformation at(double t) const = 0;
};

// Linear blend skinning. `weights` has an entry a rest position; bones that are exactly the identity leave rest as it
// is.
std::vector<Vec3> deform(const std::vector<Vec3>& rest, const std::vector<VertexWeights>& weights,
                         const Deformation& deformation);

}  // namespace spherechain::baker

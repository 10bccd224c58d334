// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/import/source_rig.h"

namespace spherechain::baker {

// The pose of a character in one frame. Positions are linear in bones and morphs, so that a page or a game can skin,
// too.
struct Deformation {
  std::vector<Affine> bones;    // for each bone: rest -> deformed
  std::vector<double> morphs;   // the weight of each morph
  std::vector<Vec3> positions;  // pose sequences only: the deformed source vertices themselves
};

class Motion {
 public:
  virtual ~Motion() = default;
  // t from 0, the start, to 1, the end.
  virtual Deformation at(double t) const = 0;
  // Seconds; 0 where the motion has no pace of its own.
  virtual double duration() const { return 0; }
  // Frames a second of its own; 0 where it has none.
  virtual double rate() const { return 0; }
  // Frames of its own, where it is made of frames; else 0.
  virtual int frame_count() const { return 0; }
};

// The rest positions displaced by morph targets.
std::vector<Vec3> morph(std::vector<Vec3> rest, const std::vector<Morph>& morphs, const std::vector<double>& weights);

// Linear blend skinning. `weights` has one entry for each rest position. Bones that are exactly the identity do not
// change a bit.
std::vector<Vec3> deform(const std::vector<Vec3>& rest, const std::vector<VertexWeights>& weights,
                         const std::vector<Affine>& bones);

}  // namespace spherechain::baker

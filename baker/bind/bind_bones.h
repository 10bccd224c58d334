// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "bind/bind.h"
#include "rig/rig.h"

namespace spherechain::baker {

// What moves a source: its own skeleton and skin, or where it has none, the automatic rig's.
struct MovingBone {
  std::string name;
  Affine inverse_bind;
  bool is_rest = false;  // no bone: for the vertices that none moves; the last, where there is one
};

// The bones and morph targets that move the source.
struct BoneBinding {
  std::vector<MovingBone> bones;  // empty where nothing moves the source
  std::vector<std::string> morphs;

  // Where vertices hang that no bone moves: there is a bone of that number where the skin has any.
  Index rest_bone() const {
    return static_cast<Index>(bones.size() - (!bones.empty() && bones.back().is_rest ? 1 : 0));
  }
};

struct BoneShare {
  Index bone;
  double weight;
};

// The bones a source vertex hangs on; the rest bone where none moves it. Their weights add up to 1; a bone may be there
// twice.
std::vector<BoneShare> bone_shares(const std::vector<VertexWeights>& weights, Index vertex, Index rest_bone);

// The source's own, or where it has no bones, the automatic rig's.
const std::vector<VertexWeights>& weights_to_bones(const Character& character,
                                                   const std::vector<VertexWeights>& rig_weights);

// `rig_weights` are of every source vertex, to `joints`; they count where the source has no bones of its own.
BoneBinding bind_bones(const Character& character, const std::vector<Joint>& joints,
                       const std::vector<VertexWeights>& rig_weights);

}  // namespace spherechain::baker

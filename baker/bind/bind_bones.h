// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/bind/bind.h"
#include "baker/rig/rig.h"

namespace spherechain::baker {

// A bone that moves a source: from its own skeleton and skin, or else from the automatic rig.
struct MovingBone {
  std::string name;
  Affine inverse_bind;
  bool is_rest = false;  // a fixed stand-in for vertices that nothing moves; always the last
};

// The bones and morph targets that move the source.
struct BoneBinding {
  std::vector<MovingBone> bones;  // empty where nothing moves the source
  std::vector<std::string> morphs;

  // The number of the bone that unmoved vertices hang on. It is bones.size() where no vertex needs it.
  Index rest_bone() const {
    return static_cast<Index>(bones.size() - (!bones.empty() && bones.back().is_rest ? 1 : 0));
  }
};

struct BoneShare {
  Index bone;
  double weight;
};

// The bones that move a source vertex, or the rest bone. Their weights add up to 1; a bone may be listed twice.
std::vector<BoneShare> bone_shares(const std::vector<VertexWeights>& weights, Index vertex, Index rest_bone);

// The source's own weights, or those of the automatic rig where the source has no bones.
const std::vector<VertexWeights>& weights_to_bones(const Character& character,
                                                   const std::vector<VertexWeights>& rig_weights);

// `rig_weights` are of every source vertex, to `joints`; they count where the source has no bones of its own.
BoneBinding bind_bones(const Character& character, const std::vector<Joint>& joints,
                       const std::vector<VertexWeights>& rig_weights);

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/bind/bind_bones.h"

namespace spherechain::baker {
namespace {

std::vector<MovingBone> bones_of(const Character& character, const std::vector<Joint>& joints) {
  std::vector<MovingBone> out;
  for (const Bone& bone : character.rig.bones) out.push_back({character.rig.nodes[bone.node].name, bone.inverse_bind});
  if (!out.empty()) return out;
  for (const Joint& joint : joints) {
    out.push_back({joint.name, Affine(Eigen::Translation3d(-joint.position))});
  }
  return out;
}

bool any_rests(const Character& character, const std::vector<VertexWeights>& weights) {
  if (weights.empty()) return true;
  for (const Index t : character.skin_source_triangle) {
    for (const Index v : character.source_triangles[t]) {
      if (weights[v].weight[0] <= 0) return true;
    }
  }
  return false;
}

}  // namespace

const std::vector<VertexWeights>& weights_to_bones(const Character& character,
                                                   const std::vector<VertexWeights>& rig_weights) {
  return character.rig.bones.empty() ? rig_weights : character.rig.weights;
}

std::vector<BoneShare> bone_shares(const std::vector<VertexWeights>& weights, Index vertex, Index rest_bone) {
  if (weights.empty() || weights[vertex].weight[0] <= 0) return {{rest_bone, 1}};
  std::vector<BoneShare> out;
  for (std::size_t k = 0; k < kMaxInfluences && weights[vertex].weight[k] > 0; ++k) {
    out.push_back({weights[vertex].joint[k], weights[vertex].weight[k]});
  }
  return out;
}

BoneBinding bind_bones(const Character& character, const std::vector<Joint>& joints,
                       const std::vector<VertexWeights>& rig_weights) {
  BoneBinding out;
  out.bones = bones_of(character, joints);
  for (const Morph& morph : character.rig.morphs) out.morphs.push_back(morph.name);
  if (out.bones.empty() && out.morphs.empty()) return out;

  if (any_rests(character, weights_to_bones(character, rig_weights))) {
    out.bones.push_back({"rest", Affine::Identity(), true});
  }
  return out;
}

}  // namespace spherechain::baker

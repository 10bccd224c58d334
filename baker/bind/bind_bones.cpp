// SPDX-License-Identifier: GPL-3.0-or-later
#include "bind/bind_bones.h"

#include <algorithm>
#include <map>

namespace spherechain::baker {
namespace {

using Vec4 = Eigen::Vector4d;

// One pivot under one bone.
struct Moved {
  Vec4 q = Vec4::Zero();
  std::map<Index, Vec3> morphs;
};

// The displacements of every source vertex that a morph target moves.
using VertexMorphs = std::map<Index, std::vector<std::pair<Index, Vec3>>>;  // vertex -> target, delta

VertexMorphs morphs_of_vertices(const std::vector<Morph>& morphs, const std::vector<Index>& corners) {
  VertexMorphs out;
  for (const Index v : corners) out[v];
  for (Index m = 0; m < morphs.size(); ++m) {
    for (std::size_t i = 0; i < morphs[m].vertices.size(); ++i) {
      const auto found = out.find(morphs[m].vertices[i]);
      if (found != out.end() && !morphs[m].deltas[i].isZero(0)) found->second.emplace_back(m, morphs[m].deltas[i]);
    }
  }
  return out;
}

class Binder {
 public:
  Binder(const Character& character, const Binding& binding, const std::vector<VertexWeights>& weights, Index rest_bone)
      : character_(character),
        weights_(weights),
        rest_bone_(rest_bone),
        morphs_(morphs_of_vertices(character.rig.morphs, corners_of(character, binding))) {}

  static std::vector<Index> corners_of(const Character& character, const Binding& binding) {
    std::vector<Index> out;
    for (const BoundSphere& sphere : binding.spheres) {
      for (const BoundPivot& pivot : sphere.pivots) {
        const Triangle& corners = character.source_triangles[character.skin_source_triangle[pivot.triangle]];
        out.insert(out.end(), corners.begin(), corners.end());
      }
    }
    return out;
  }

  PivotGroup group(const BoundPivot* pivots, std::size_t count) const {
    PivotGroup out;
    std::map<Index, BonePart> parts;
    for (std::size_t lane = 0; lane < count; ++lane) {
      out.weights[lane] = static_cast<float>(pivots[lane].weight);
      for (const auto& [bone, moved] : by_bone(pivots[lane])) add(moved, lane, bone, parts[bone]);
    }
    for (auto& [bone, part] : parts) {
      std::sort(part.morphs.begin(), part.morphs.end(),
                [](const auto& a, const auto& b) { return a.target < b.target; });
      out.parts.push_back(std::move(part));
    }
    return out;
  }

 private:
  std::map<Index, Moved> by_bone(const BoundPivot& pivot) const {
    std::map<Index, Moved> out;
    for (const Index v : character_.source_triangles[character_.skin_source_triangle[pivot.triangle]]) {
      const auto move = [&](Index bone, double weight) {
        Moved& moved = out[bone];
        moved.q += weight / 3 * character_.source_positions[v].homogeneous();
        for (const auto& [target, delta] : morphs_.at(v)) {
          moved.morphs.try_emplace(target, Vec3::Zero()).first->second += weight / 3 * delta;
        }
      };
      for (const BoneShare& share : bone_shares(weights_, v, rest_bone_)) move(share.bone, share.weight);
    }
    return out;
  }

  static void add(const Moved& moved, std::size_t lane, Index bone, BonePart& part) {
    part.bone = bone;
    for (std::size_t i = 0; i < 4; ++i) part.q[i][lane] = static_cast<float>(moved.q[static_cast<Eigen::Index>(i)]);
    for (const auto& [target, delta] : moved.morphs) {
      auto found = std::find_if(part.morphs.begin(), part.morphs.end(),
                                [t = target](const MorphPart& morph) { return morph.target == t; });
      if (found == part.morphs.end()) found = part.morphs.insert(found, MorphPart{target, {}});
      for (std::size_t i = 0; i < 3; ++i)
        found->delta[i][lane] = static_cast<float>(delta[static_cast<Eigen::Index>(i)]);
    }
  }

  const Character& character_;
  const std::vector<VertexWeights>& weights_;
  Index rest_bone_;
  VertexMorphs morphs_;
};

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

BoneBinding bind_bones(const Character& character, const Binding& binding, const std::vector<Joint>& joints,
                       const std::vector<VertexWeights>& rig_weights) {
  BoneBinding out;
  out.bones = bones_of(character, joints);
  for (const Morph& morph : character.rig.morphs) out.morphs.push_back(morph.name);
  if (out.bones.empty() && out.morphs.empty()) return out;

  const auto rest_bone = static_cast<Index>(out.bones.size());
  const std::vector<VertexWeights>& weights = weights_to_bones(character, rig_weights);
  if (any_rests(character, weights)) out.bones.push_back({"rest", Affine::Identity(), true});
  const Binder binder(character, binding, weights, rest_bone);
  for (const BoundSphere& sphere : binding.spheres) {
    for (std::size_t first = 0; first < sphere.pivots.size(); first += kGroupSize) {
      out.groups.push_back(binder.group(&sphere.pivots[first], std::min(kGroupSize, sphere.pivots.size() - first)));
    }
  }
  return out;
}

}  // namespace spherechain::baker

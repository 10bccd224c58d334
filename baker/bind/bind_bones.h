// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "bind/bind.h"
#include "rig/rig.h"

namespace spherechain::baker {

inline constexpr std::size_t kGroupSize = 8;  // pivots that the runtime moves together
using GroupLanes = std::array<float, kGroupSize>;

// What moves a source: its own skeleton and skin, or where it has none, the automatic rig's.
struct MovingBone {
  std::string name;
  Affine inverse_bind;
  bool is_rest = false;  // no bone: for the vertices that none moves; the last, where there is one
};

struct MorphPart {
  Index target;
  std::array<GroupLanes, 3> delta;  // x, y, z
};

// Of a group's pivots: the sum over the triangle's corners of weight * (rest position; 1) / 3, for one bone.
struct BonePart {
  Index bone;
  std::array<GroupLanes, 4> q;    // x, y, z, w
  std::vector<MorphPart> morphs;  // targets ascending
};

struct PivotGroup {
  GroupLanes weights{};         // the pivots' shares of the centre
  std::vector<BonePart> parts;  // bones ascending; never empty
};

// For the runtime's refit without the mesh (runtime/refit_bones.h).
struct BoneBinding {
  std::vector<MovingBone> bones;  // empty where nothing moves the source
  std::vector<std::string> morphs;
  std::vector<PivotGroup> groups;  // a sphere's pivots by eights, in sphere order

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
BoneBinding bind_bones(const Character& character, const Binding& binding, const std::vector<Joint>& joints,
                       const std::vector<VertexWeights>& rig_weights);

}  // namespace spherechain::baker

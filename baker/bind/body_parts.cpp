// SPDX-License-Identifier: GPL-3.0-or-later
#include "bind/body_parts.h"

#include <algorithm>
#include <array>
#include <map>
#include <tuple>

#include "bind/bind_bones.h"
#include "bind/part_names.h"

namespace spherechain::baker {
namespace {

constexpr std::size_t kPartsMax = 255;

std::string in_words(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

// Collects the parts by name.
class PartList {
 public:
  std::size_t add(const std::string& name, Side side, int bone) {
    const auto [found, is_new] = index_of_.try_emplace(name, parts_.size());
    if (is_new) parts_.push_back({name, side, bone});
    return found->second;
  }
  void follow(std::size_t part, int bone) { parts_[part].bone = bone; }
  const std::vector<BodyPart>& parts() const { return parts_; }

 private:
  std::vector<BodyPart> parts_;
  std::map<std::string, std::size_t> index_of_;
};

// The part of each bone of the source's rig. A part follows the bone nearest to the root among those whose own role
// made it one.
std::vector<std::size_t> parts_of_rig(const SourceRig& rig, const Roles& roles, PartList& list) {
  const std::vector<PartName> names = name_parts(rig, roles);
  std::vector<int> depth;
  for (const Node& node : rig.nodes) {
    depth.push_back(node.parent < 0 ? 0 : depth[static_cast<std::size_t>(node.parent)] + 1);
  }
  std::vector<std::size_t> of_bone;
  std::vector<std::tuple<bool, int>> best;  // of the bone that a part follows so far
  for (std::size_t b = 0; b < rig.bones.size(); ++b) {
    const Index node = rig.bones[b].node;
    PartName part = names[node];
    if (part.name.empty()) part.name = rig.nodes[node].name;
    if (part.name.empty()) part.name = "bone " + std::to_string(b);
    const std::size_t index = list.add(part.name, part.side, static_cast<int>(b));
    const std::tuple key{part.inherited, depth[node]};
    if (index == best.size()) best.push_back(key);
    if (key < best[index]) {
      best[index] = key;
      list.follow(index, static_cast<int>(b));
    }
    of_bone.push_back(index);
  }
  return of_bone;
}

std::vector<std::size_t> parts_of_joints(const std::vector<Joint>& joints, PartList& list) {
  std::vector<std::size_t> of_bone;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const PartName part = name_part(joints[j].name);
    of_bone.push_back(list.add(part.name, part.side, static_cast<int>(j)));
  }
  return of_bone;
}

// The bone with the greatest sum of the corners' weights, the lowest of several; `rest_bone` stands for none.
Index moved_most_by(const Triangle& corners, const std::vector<VertexWeights>& weights, Index rest_bone) {
  std::map<Index, std::array<float, 3>> of_bone;
  for (std::size_t corner = 0; corner < 3; ++corner) {
    for (const BoneShare& share : bone_shares(weights, corners[corner], rest_bone)) {
      of_bone[share.bone][corner] = static_cast<float>(share.weight);
    }
  }
  Index most = rest_bone;
  float greatest = -1;
  for (const auto& [bone, weight] : of_bone) {
    const float sum = (weight[0] + weight[1]) + weight[2];
    if (sum <= greatest) continue;
    greatest = sum;
    most = bone;
  }
  return most;
}

// Of each bone the one above it; kNoIndex where there is none.
std::vector<Index> bone_parents(const Character& character, const std::vector<Joint>& joints) {
  std::vector<Index> out;
  const SourceRig& rig = character.rig;
  if (rig.bones.empty()) {
    for (const Joint& joint : joints) out.push_back(joint.parent < 0 ? kNoIndex : static_cast<Index>(joint.parent));
    return out;
  }
  std::vector<Index> bone_of(rig.nodes.size(), kNoIndex);
  for (Index b = static_cast<Index>(rig.bones.size()); b-- > 0;) bone_of[rig.bones[b].node] = b;
  for (const Bone& bone : rig.bones) {
    int node = rig.nodes[bone.node].parent;
    while (node >= 0 && bone_of[static_cast<std::size_t>(node)] == kNoIndex) {
      node = rig.nodes[static_cast<std::size_t>(node)].parent;
    }
    out.push_back(node < 0 ? kNoIndex : bone_of[static_cast<std::size_t>(node)]);
  }
  return out;
}

// The region of each source triangle. A triangle that cleaning dropped takes that of a neighbour.
std::vector<std::uint8_t> regions_of_source(const Character& character, const Regions& regions) {
  std::vector<std::uint8_t> of_vertex(character.skin.positions.size(), regions.torso_region());
  for (std::size_t t = character.skin.triangles.size(); t-- > 0;) {
    for (const Index v : character.skin.triangles[t]) of_vertex[v] = regions.of_skin[t];
  }
  std::vector<std::uint8_t> out;
  for (const Triangle& corners : character.source_triangles) {
    const Index v = character.skin_of_source[corners[0]];
    out.push_back(v == kNoIndex ? std::uint8_t{0} : of_vertex[v]);
  }
  for (std::size_t t = 0; t < character.skin.triangles.size(); ++t) {
    out[character.skin_source_triangle[t]] = regions.of_skin[t];
  }
  return out;
}

Side side_of_region(const Regions& regions, std::size_t region) {
  return region < regions.limbs.size() ? regions.limbs[region].side : Side::kNone;
}

BodyParts parts_of_regions(const Character& character, const Regions& regions) {
  BodyParts out;
  for (std::size_t r = 0; r < regions.count(); ++r) {
    out.parts.push_back({in_words(regions.name(r)), side_of_region(regions, r), -1});
  }
  out.of_triangle = regions_of_source(character, regions);
  return out;
}

// The region of most triangles that no bone moves.
std::size_t region_at_rest(const Character& character, const Regions& regions, const std::vector<Index>& bone_of,
                           Index rest_bone) {
  const std::vector<std::uint8_t> of_triangle = regions_of_source(character, regions);
  std::vector<std::size_t> triangles(256, 0);
  for (std::size_t t = 0; t < bone_of.size(); ++t) triangles[of_triangle[t]] += bone_of[t] == rest_bone ? 1 : 0;
  return static_cast<std::size_t>(std::max_element(triangles.begin(), triangles.end()) - triangles.begin());
}

// The parts to keep: those with a triangle; of too many those with most, so that there is room for the rest.
std::vector<std::size_t> kept_parts(const std::vector<BodyPart>& parts, const std::vector<std::size_t>& triangles) {
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (triangles[i] > 0) kept.push_back(i);
  }
  if (kept.size() > kPartsMax) {
    std::stable_sort(kept.begin(), kept.end(), [&](auto l, auto r) { return triangles[l] > triangles[r]; });
    kept.resize(kPartsMax - 1);
  }
  const auto key = [&](std::size_t i) { return std::tuple(parts[i].bone < 0, parts[i].bone); };
  std::sort(kept.begin(), kept.end(), [&](auto l, auto r) { return key(l) < key(r); });
  return kept;
}

}  // namespace

BodyParts find_body_parts(const Character& character, const Roles& roles, const Regions& regions,
                          const std::vector<Joint>& joints, const std::vector<VertexWeights>& rig_weights) {
  const std::vector<VertexWeights>& weights = weights_to_bones(character, rig_weights);
  if (weights.empty()) return parts_of_regions(character, regions);
  PartList list;
  std::vector<std::size_t> of_bone =
      character.rig.bones.empty() ? parts_of_joints(joints, list) : parts_of_rig(character.rig, roles, list);
  const auto rest_bone = static_cast<Index>(of_bone.size());
  std::vector<Index> bone_of;
  for (const Triangle& corners : character.source_triangles) {
    bone_of.push_back(moved_most_by(corners, weights, rest_bone));
  }
  if (std::find(bone_of.begin(), bone_of.end(), rest_bone) != bone_of.end()) {
    const std::size_t region = region_at_rest(character, regions, bone_of, rest_bone);
    of_bone.push_back(list.add(in_words(regions.name(region)), side_of_region(regions, region), -1));
  }
  std::vector<std::size_t> triangles(list.parts().size(), 0);
  for (const Index bone : bone_of) ++triangles[of_bone[bone]];

  BodyParts out;
  constexpr int kDropped = -1;
  std::vector<int> place(list.parts().size(), kDropped);
  for (const std::size_t i : kept_parts(list.parts(), triangles)) {
    place[i] = static_cast<int>(out.parts.size());
    out.parts.push_back(list.parts()[i]);
  }
  for (std::size_t i = 0; i < place.size(); ++i) {
    if (triangles[i] == 0 || place[i] != kDropped) continue;
    if (out.parts.size() < kPartsMax) out.parts.push_back({"rest of the body", Side::kNone, -1});
    place[i] = static_cast<int>(kPartsMax) - 1;
  }
  const std::vector<Index> parents = bone_parents(character, joints);
  for (Index b = 0; b < rest_bone; ++b) {
    Index bone = b;
    while (bone != kNoIndex && place[of_bone[bone]] == kDropped) bone = parents[bone];
    out.of_bone.push_back(static_cast<std::uint8_t>(bone == kNoIndex ? 0 : place[of_bone[bone]]));
  }
  if (of_bone.size() > rest_bone) out.of_rest = static_cast<std::uint8_t>(place[of_bone[rest_bone]]);
  for (const Index bone : bone_of) out.of_triangle.push_back(static_cast<std::uint8_t>(place[of_bone[bone]]));
  return out;
}

}  // namespace spherechain::baker

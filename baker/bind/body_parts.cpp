// SPDX-License-Identifier: GPL-3.0-or-later
#include "bind/body_parts.h"

#include <algorithm>
#include <map>
#include <tuple>

#include "bind/bind_bones.h"
#include "bind/part_names.h"

namespace spherechain::baker {
namespace {

constexpr std::size_t kPartsMax = 255;
constexpr std::size_t kNone = ~std::size_t{0};

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

// The part whose bones move a triangle most, the first of them where several do; kNone where no bone moves it. Bones
// are summed up by part: twist bones share a limb's weight among them, fingers the hand's.
std::size_t moved_most(const Triangle& corners, const std::vector<VertexWeights>& weights,
                       const std::vector<std::size_t>& part_of_bone) {
  std::map<std::size_t, double> share;
  for (const Index v : corners) {
    for (std::size_t k = 0; k < kMaxInfluences && weights[v].weight[k] > 0; ++k) {
      share[part_of_bone[weights[v].joint[k]]] += weights[v].weight[k];
    }
  }
  std::size_t most = kNone;
  for (const auto& [part, weight] : share) {
    if (most == kNone || weight > share[most]) most = part;
  }
  return most;
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

// Leaves out parts without a triangle; where too many are left, those with the fewest triangles become one.
BodyParts compact(const std::vector<BodyPart>& parts, const std::vector<std::size_t>& of_triangle) {
  std::vector<std::size_t> triangles(parts.size(), 0), order;
  for (const std::size_t part : of_triangle) ++triangles[part];
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (triangles[i] > 0) order.push_back(i);
  }
  const bool too_many = order.size() > kPartsMax;
  if (too_many) {
    std::stable_sort(order.begin(), order.end(), [&](auto l, auto r) { return triangles[l] > triangles[r]; });
    order.resize(kPartsMax - 1);
  }
  const auto key = [&](std::size_t i) { return std::tuple(parts[i].bone < 0, parts[i].bone, i); };
  std::sort(order.begin(), order.end(), [&](auto l, auto r) { return key(l) < key(r); });
  BodyParts out;
  std::vector<std::uint8_t> place(parts.size(), static_cast<std::uint8_t>(kPartsMax - 1));
  for (const std::size_t i : order) {
    place[i] = static_cast<std::uint8_t>(out.parts.size());
    out.parts.push_back(parts[i]);
  }
  if (too_many) out.parts.push_back({"rest of the body", Side::kNone, -1});
  for (const std::size_t part : of_triangle) out.of_triangle.push_back(place[part]);
  return out;
}

}  // namespace

BodyParts find_body_parts(const Character& character, const Roles& roles, const Regions& regions,
                          const std::vector<Joint>& joints, const std::vector<VertexWeights>& rig_weights) {
  PartList list;
  const bool has_bones = !character.rig.bones.empty();
  const std::vector<std::size_t> of_bone =
      has_bones ? parts_of_rig(character.rig, roles, list) : parts_of_joints(joints, list);
  const std::vector<VertexWeights>& weights = weights_to_bones(character, rig_weights);
  std::vector<std::size_t> of_triangle;
  std::vector<std::uint8_t> of_region;  // where it is needed
  for (std::size_t t = 0; t < character.source_triangles.size(); ++t) {
    std::size_t part = weights.empty() ? kNone : moved_most(character.source_triangles[t], weights, of_bone);
    if (part == kNone) {
      if (of_region.empty()) of_region = regions_of_source(character, regions);
      const std::uint8_t region = of_region[t];
      const Side side = region < regions.limbs.size() ? regions.limbs[region].side : Side::kNone;
      part = list.add(in_words(regions.name(region)), side, -1);
    }
    of_triangle.push_back(part);
  }
  return compact(list.parts(), of_triangle);
}

}  // namespace spherechain::baker

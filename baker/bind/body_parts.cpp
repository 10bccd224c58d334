// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/bind/body_parts.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "baker/bind/bind_bones.h"
#include "baker/bind/part_names.h"

namespace spherechain::baker {
namespace {

constexpr std::size_t kPartsMax = 255;
constexpr double kWholly = 0.9;  // of a mesh's triangles: then one part moves the mesh
constexpr std::size_t kNoPart = ~std::size_t{0};

std::string in_words(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

// Collects the parts by name.
class PartList {
 public:
  std::size_t add(const std::string& name, Side side, int bone, bool is_prop = false) {
    const auto [found, is_new] = index_of_.try_emplace(name, parts_.size());
    if (is_new) parts_.push_back({name, side, bone, -1, 0, is_prop});
    return found->second;
  }
  // The part of a mesh that another part moves: a new one on the other, or the one that is there already.
  std::size_t add_on(const PartName& name, std::size_t mover) {
    const std::size_t part = add(name.name, name.side, parts_[mover].bone, name.is_prop);
    if (part + 1 > mover_of_.size()) mover_of_.resize(part + 1, kNoPart);
    if (part + 1 == parts_.size()) mover_of_[part] = mover;
    return part;
  }
  std::size_t find(const std::string& name) const {
    const auto found = index_of_.find(name);
    return found == index_of_.end() ? kNoPart : found->second;
  }
  // The part on which a part of a mesh hangs, kNoPart for a part of bones.
  std::size_t mover_of(std::size_t part) const { return part < mover_of_.size() ? mover_of_[part] : kNoPart; }
  void follow(std::size_t part, int bone) { parts_[part].bone = bone; }
  const std::vector<BodyPart>& parts() const { return parts_; }

 private:
  std::vector<BodyPart> parts_;
  std::map<std::string, std::size_t> index_of_;
  std::vector<std::size_t> mover_of_;
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
    PartName part = rig.robot.is_robot ? PartName{} : names[node];
    if (part.name.empty()) part.name = rig.nodes[node].name;
    if (part.name.empty()) part.name = "bone " + std::to_string(b);
    const std::size_t index = list.add(part.name, part.side, static_cast<int>(b), part.is_prop);
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

// The part whose bones move a triangle most, of several the first; kNoPart where that is none. Bones are summed by
// part: twist bones share a limb's weight, fingers the hand's, and the strongest single bone may be the neighbour's.
std::size_t moved_most(const Triangle& corners, const std::vector<VertexWeights>& weights,
                       const std::vector<std::size_t>& part_of_bone) {
  const auto rest_bone = static_cast<Index>(part_of_bone.size());
  std::map<std::size_t, double> sums;
  for (const Index v : corners) {
    for (const BoneShare& share : bone_shares(weights, v, rest_bone)) {
      sums[share.bone == rest_bone ? kNoPart : part_of_bone[share.bone]] += share.weight;
    }
  }
  const auto less = [](const auto& l, const auto& r) { return l.second < r.second; };
  return std::max_element(sums.begin(), sums.end(), less)->first;
}

bool is_below(const SourceRig& rig, int bone, int other) {
  const auto node_of = [&](int b) { return static_cast<int>(rig.bones[static_cast<std::size_t>(b)].node); };
  int node = node_of(bone);
  while (node >= 0 && node != node_of(other)) node = rig.nodes[static_cast<std::size_t>(node)].parent;
  return node >= 0;
}

// Gives a mesh whose name says what it is, and that one part of the body moves, to a part of its own: a backpack on the
// chest.
void name_by_meshes(const Character& character, PartList& list, std::vector<std::size_t>& of_triangle) {
  std::vector<std::string> names;
  for (const SourceBuffer& buffer : character.buffers) names.push_back(buffer.name);
  const std::vector<PartName> parts = name_meshes(names);
  auto first = of_triangle.begin();
  for (std::size_t b = 0; b < parts.size(); ++b) {
    const auto last = first + character.buffers[b].triangle_count;
    const auto mesh = std::pair(std::exchange(first, last), last);
    if (parts[b].name.empty()) continue;
    const std::size_t known = list.find(parts[b].name);
    std::map<std::size_t, std::ptrdiff_t> counts;
    std::ptrdiff_t count = 0;
    for (auto part = mesh.first; part != mesh.second; ++part) {
      if (*part == known) continue;
      ++counts[*part];
      ++count;
    }
    for (const auto& [mover, triangles] : counts) {
      const BodyPart& other = list.parts()[mover];
      const int bone = other.bone;
      const bool is_of_body = bone >= 0 && !other.is_prop && mobility_of(other.name) >= 0;
      if (!is_of_body || static_cast<double>(triangles) < kWholly * static_cast<double>(count)) continue;
      if (known != kNoPart && !is_below(character.rig, list.parts()[known].bone, bone)) continue;
      std::replace(mesh.first, mesh.second, mover, list.add_on(parts[b], mover));
    }
  }
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

// Sets each part's mobility. A part whose name does not say it has one more than the part that it hangs on.
void find_mobility(std::vector<BodyPart>& parts) {
  for (BodyPart& part : parts) {
    int mobility = mobility_of(part.name), steps = 0;
    for (int p = part.parent; mobility < 0 && p >= 0; p = parts[static_cast<std::size_t>(p)].parent) {
      ++steps;
      mobility = mobility_of(parts[static_cast<std::size_t>(p)].name);
    }
    part.mobility = static_cast<std::uint8_t>(std::min(std::max(mobility, 0) + steps, 255));
  }
}

BodyParts parts_of_regions(const Character& character, const Regions& regions) {
  BodyParts out;
  for (std::size_t r = 0; r < regions.count(); ++r) {
    out.parts.push_back({in_words(regions.name(r)), side_of_region(regions, r), -1, -1});
  }
  out.of_triangle = regions_of_source(character, regions);
  find_mobility(out.parts);
  return out;
}

// Sets the parent of each part without one. The bones are the source's nodes, or the joints of the automatic rig.
void find_parents(const SourceRig& rig, const std::vector<Joint>& joints, std::vector<BodyPart>& parts) {
  const bool own_rig = !rig.bones.empty();
  const auto above = [&](int node) {
    const auto n = static_cast<std::size_t>(node);
    return own_rig ? rig.nodes[n].parent : joints[n].parent;
  };
  std::map<int, int> part_at;
  const auto node_of = [&](const BodyPart& part) {
    return part.bone >= 0 && own_rig ? static_cast<int>(rig.bones[static_cast<std::size_t>(part.bone)].node)
                                     : part.bone;
  };
  for (std::size_t p = 0; p < parts.size(); ++p) {
    if (parts[p].parent < 0) part_at[node_of(parts[p])] = static_cast<int>(p);
  }
  part_at.erase(-1);
  // Each node takes the part of the nearest node above that has one.
  std::vector<int> part_above(own_rig ? rig.nodes.size() : joints.size(), -1);
  for (std::size_t n = 0; n < part_above.size(); ++n) {
    const int up = above(static_cast<int>(n));
    if (up < 0) continue;
    const auto found = part_at.find(up);
    part_above[n] = found != part_at.end() ? found->second : part_above[static_cast<std::size_t>(up)];
  }
  for (BodyPart& part : parts) {
    const int node = part.parent < 0 ? node_of(part) : -1;
    if (node >= 0) part.parent = part_above[static_cast<std::size_t>(node)];
  }
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
  const auto key = [&](std::size_t i) { return std::tuple(parts[i].bone < 0, parts[i].bone, i); };
  std::sort(kept.begin(), kept.end(), [&](auto l, auto r) { return key(l) < key(r); });
  return kept;
}

}  // namespace

BodyParts find_body_parts(const Character& character, const Roles& roles, const Regions& regions,
                          const std::vector<Joint>& joints, const std::vector<VertexWeights>& rig_weights) {
  const std::vector<VertexWeights>& weights = weights_to_bones(character, rig_weights);
  if (weights.empty()) return parts_of_regions(character, regions);
  PartList list;
  const std::vector<std::size_t> of_bone =
      character.rig.bones.empty() ? parts_of_joints(joints, list) : parts_of_rig(character.rig, roles, list);
  std::vector<std::uint8_t> of_region;  // found where a triangle asks for it
  std::vector<std::size_t> of_triangle;
  for (std::size_t t = 0; t < character.source_triangles.size(); ++t) {
    std::size_t part = moved_most(character.source_triangles[t], weights, of_bone);
    if (part == kNoPart) {
      if (of_region.empty()) of_region = regions_of_source(character, regions);
      part = list.add(in_words(regions.name(of_region[t])), side_of_region(regions, of_region[t]), -1);
    }
    of_triangle.push_back(part);
  }
  if (!character.rig.bones.empty() && !character.rig.robot.is_robot) name_by_meshes(character, list, of_triangle);
  std::vector<std::size_t> triangles(list.parts().size(), 0);
  for (const std::size_t part : of_triangle) ++triangles[part];

  BodyParts out;
  std::vector<std::uint8_t> place(list.parts().size(), static_cast<std::uint8_t>(kPartsMax - 1));
  const std::vector<std::size_t> kept = kept_parts(list.parts(), triangles);
  for (const std::size_t i : kept) {
    place[i] = static_cast<std::uint8_t>(out.parts.size());
    out.parts.push_back(list.parts()[i]);
  }
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const std::size_t mover = list.mover_of(kept[i]);
    if (mover != kNoPart && std::count(kept.begin(), kept.end(), mover) > 0) out.parts[i].parent = place[mover];
  }
  for (const std::size_t part : of_triangle) out.of_triangle.push_back(place[part]);
  if (std::count(triangles.begin(), triangles.end(), 0U) + std::ssize(kept) < std::ssize(triangles)) {
    out.parts.push_back({"rest of the body", Side::kNone, -1, -1});
  }
  find_parents(character.rig, joints, out.parts);
  find_mobility(out.parts);
  return out;
}

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#include "bind/part_parents.h"

#include <algorithm>
#include <map>

#include "mesh/surface_query.h"

namespace spherechain::baker {
namespace {

constexpr double kTouching = 0.02;  // of the character's extent: nearer skins touch

// The bones are the source's nodes, or the joints of the automatic rig.
void find_bones_above(const SourceRig& rig, const std::vector<Joint>& joints, std::vector<BodyPart>& parts) {
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
  for (std::size_t p = 0; p < parts.size(); ++p) part_at[node_of(parts[p])] = static_cast<int>(p);
  part_at.erase(-1);
  for (BodyPart& part : parts) {
    int node = node_of(part);
    if (node >= 0) node = above(node);
    while (node >= 0 && part_at.count(node) == 0) node = above(node);
    part.parent = node < 0 ? -1 : part_at[node];
  }
}

using Box = Eigen::AlignedBox3d;

Box box_of(const Mesh& mesh, std::size_t triangle) {
  Box out;
  for (const Index v : mesh.triangles[triangle]) out.extend(mesh.positions[v]);
  return out;
}

std::size_t root_of(const std::vector<BodyPart>& parts, std::size_t part) {
  while (parts[part].parent >= 0) part = static_cast<std::size_t>(parts[part].parent);
  return part;
}

// Of the parts that do not hang on that one: where most of its corners lie that are about as near as the nearest.
int touched_most(const Character& character, const BodyParts& parts, std::size_t root, double touching) {
  const Mesh& skin = character.skin;
  const auto part_of = [&](std::size_t t) { return parts.of_triangle[character.skin_source_triangle[t]]; };
  Box room;
  std::vector<Index> corners;
  for (std::size_t t = 0; t < skin.triangles.size(); ++t) {
    if (part_of(t) != root) continue;
    room.extend(box_of(skin, t));
    corners.insert(corners.end(), skin.triangles[t].begin(), skin.triangles[t].end());
  }
  if (corners.empty()) return -1;
  const Vec3 margin = Vec3::Constant(touching);
  room = Box(room.min() - margin, room.max() + margin);
  std::vector<Index> others;
  for (std::size_t t = 0; t < skin.triangles.size(); ++t) {
    if (root_of(parts.parts, part_of(t)) != root && box_of(skin, t).intersects(room)) {
      others.push_back(static_cast<Index>(t));
    }
  }
  if (others.empty()) return -1;
  const SurfaceQuery query(skin, others);
  std::vector<SurfaceHit> hits;
  double nearest = touching;
  for (const Index v : corners) {
    hits.push_back(query.closest(skin.positions[v]));
    nearest = std::min(nearest, hits.back().distance);
  }
  std::map<int, int> touched;  // corners by part
  for (const SurfaceHit& hit : hits) {
    if (nearest < touching && hit.distance <= nearest + 0.1 * touching) ++touched[part_of(hit.triangle)];
  }
  const auto fewer = [](const auto& l, const auto& r) { return l.second < r.second; };
  return touched.empty() ? -1 : std::max_element(touched.begin(), touched.end(), fewer)->first;
}

// Hangs the parts that have no bone above on what they touch; but for the largest.
void join_roots(const Character& character, BodyParts& parts) {
  std::vector<std::size_t> roots;
  for (std::size_t p = 0; p < parts.parts.size(); ++p) {
    if (parts.parts[p].parent < 0) roots.push_back(p);
  }
  std::vector<std::size_t> sizes(parts.parts.size(), 0);  // in triangles, of a root with all that hangs on it
  for (const std::uint8_t part : parts.of_triangle) ++sizes[root_of(parts.parts, part)];
  std::stable_sort(roots.begin(), roots.end(), [&](std::size_t l, std::size_t r) { return sizes[l] > sizes[r]; });
  Box box;
  for (const Vec3& p : character.skin.positions) box.extend(p);
  for (std::size_t i = 1; i < roots.size(); ++i) {
    parts.parts[roots[i]].parent = touched_most(character, parts, roots[i], kTouching * box.sizes().maxCoeff());
  }
}

}  // namespace

void find_parents(const Character& character, const std::vector<Joint>& joints, BodyParts& parts) {
  find_bones_above(character.rig, joints, parts.parts);
  join_roots(character, parts);
}

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/segment/by_bones.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>

#include "baker/roles/skeleton.h"
#include "baker/segment/part_tree.h"
#include "baker/segment/stature.h"

namespace spherechain::baker {
namespace {

// From the joint towards the one below it where the skin goes on longest, or the skin's own axis where it is much
// longer that way.
Vec3 axis_of(const Part& part, const Skeleton& skeleton, const Extent& extent, const Mesh& mesh) {
  constexpr double kMuchLonger = 1.8;
  if (part.node == Part::kNone) return extent.axis[0];
  const Vec3& joint = skeleton.position[static_cast<std::size_t>(part.node)];
  Vec3 along = extent.centroid - joint;
  double farthest = 0;
  for (const int child : skeleton.children[static_cast<std::size_t>(part.node)]) {
    const auto c = static_cast<std::size_t>(child);
    const double reach = skeleton.bone(child) + skeleton.reach[c];
    if (!skeleton.alive[c] || reach <= farthest) continue;
    farthest = reach;
    along = skeleton.position[c] - joint;
  }
  const Vec3 principal = extent.axis[0].dot(along) < 0 ? Vec3(-extent.axis[0]) : extent.axis[0];
  if (!(along.norm() > 1e-6 * extent.spread[0])) return principal;
  along.normalize();
  double squares = 0, area = 0;
  for (const Index t : part.triangles) {
    for (const Index v : mesh.triangles[t]) {
      const double d = (mesh.positions[v] - extent.centroid).dot(along);
      squares += triangle_area(mesh, t) * d * d / 3;
    }
    area += triangle_area(mesh, t);
  }
  return extent.spread[0] > kMuchLonger * std::sqrt(squares / area) ? principal : along;
}

Polyline line_of(const Mesh& mesh, const Part& part, const Vec3& center, const Vec3& axis) {
  double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();
  for (const Index t : part.triangles) {
    for (const Index v : mesh.triangles[t]) {
      const double s = (mesh.positions[v] - center).dot(axis);
      low = std::min(low, s);
      high = std::max(high, s);
    }
  }
  return Polyline({center + low * axis, center + high * axis});
}

Side side_of(const Part& part, const Roles& roles) {
  if (part.node == Part::kNone || roles.of_node.empty()) return Side::kNone;
  const NodeRole& role = roles.of_node[static_cast<std::size_t>(part.node)];
  const std::string& limb = role.limb < 0 ? role.role : roles.limbs[static_cast<std::size_t>(role.limb)].name;
  if (limb.starts_with("left_")) return Side::kLeft;
  return limb.starts_with("right_") ? Side::kRight : Side::kNone;
}

std::string name_of(const Part& part, const SourceRig& rig, std::set<std::string>& taken) {
  const std::string preferred = part.node == Part::kNone ? "part" : rig.nodes[static_cast<std::size_t>(part.node)].name;
  std::string name = preferred.empty() ? "part" : preferred;
  for (int i = 2; !taken.insert(name).second; ++i)
    name = (preferred.empty() ? "part" : preferred) + "_" + std::to_string(i);
  return name;
}

BodyFrame frame_of(const Character& character, const std::vector<Part>& parts, const Roles& roles,
                   const std::optional<Vec3>& forward, std::string& facing) {
  Vec3 left = Vec3::Zero();
  for (const Part& part : parts) {
    const Side side = side_of(part, roles);
    if (side == Side::kNone) continue;
    const Vec3 from = extent_of(character.skin, part.triangles).centroid - surface_centroid(character.skin);
    left += area_of(character.skin, part.triangles) * (side == Side::kLeft ? from : Vec3(-from));
  }
  const Vec3 up = way_up(character, roles);
  left -= left.dot(up) * up;
  facing = "forward is as the rig's left and right have it";
  if (!(left.norm() > 1e-6 * surface_area(character.skin) * diameter(character.skin))) {
    facing = "forward is as the file's axes have it";
    left = std::abs(up.x()) < 0.9 ? Vec3::UnitX() : Vec3::UnitY();
    left -= left.dot(up) * up;
  }
  if (const Vec3 across = up.cross(forward.value_or(Vec3::Zero()));
      across.norm() > 1e-6 * forward.value_or(up).norm()) {
    left = across;
    facing = "forward is the direction in the settings";
  }
  left.normalize();
  BodyFrame frame = with_up({Vec3::Zero(), left, up, left.cross(up), 0}, up, character.skin);
  if (roles.kind == BodyKind::kBiped) {
    frame.height = stature(character, roles);
    return frame;
  }
  for (const Vec3& axis : {frame.left, frame.forward}) {
    double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();
    for (const Vec3& p : character.skin.positions) {
      low = std::min(low, p.dot(axis));
      high = std::max(high, p.dot(axis));
    }
    frame.height = std::max(frame.height, high - low);
  }
  return frame;
}

// A region in the making. The last is the root.
struct Entry {
  Limb limb;
  std::vector<Index> triangles;
  int parent;     // another entry; the root's is itself
  bool by_bones;  // else a limb or torso
};

// Appends the parts' entries, their parents included.
void add_parts(const Character& character, const Roles& roles, const std::vector<Part>& parts,
               std::set<std::string>& taken, std::vector<Entry>& entries) {
  const Skeleton skeleton = make_skeleton(character.rig, character.source_positions);
  const auto first = static_cast<int>(entries.size());
  for (const Part& part : parts) {
    const Extent extent = extent_of(character.skin, part.triangles);
    const Polyline line =
        line_of(character.skin, part, extent.centroid, axis_of(part, skeleton, extent, character.skin));
    entries.push_back({{name_of(part, character.rig, taken), side_of(part, roles), 0, line, line.length()},
                       part.triangles,
                       first + part.parent,
                       true});
  }
}

void fill(const std::vector<Entry>& entries, std::size_t triangles, Regions& regions) {
  regions.of_skin.resize(triangles);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    for (const Index t : entries[i].triangles) regions.of_skin[t] = static_cast<std::uint8_t>(i);
    regions.parents.push_back(static_cast<std::uint8_t>(entries[i].parent));
    regions.by_bones.push_back(entries[i].by_bones);
    if (i + 1 < entries.size()) regions.limbs.push_back(entries[i].limb);
  }
  regions.of_triangle = regions.of_skin;
  const Limb& root = entries.back().limb;
  regions.torso_name = root.name;
  regions.spine = root.line;
  regions.hip = root.line.at(0);
  regions.chest = root.line.at(root.line.length());
  regions.spine_chest = regions.spine_neck = root.line.length();
  regions.torso = {0, regions.frame.height};
}

std::vector<Index> skin_of(const Regions& regions, std::uint8_t region) {
  std::vector<Index> out;
  for (Index t = 0; t < regions.of_skin.size(); ++t) {
    if (regions.of_skin[t] == region) out.push_back(t);
  }
  return out;
}

// The skin's regions, where a limb that is kept has all the skin of the bones that move most of their skin in it: the
// armpit moves with the arm.
std::vector<std::uint8_t> with_all_of_limbs(const Character& character, const Regions& regions,
                                            const std::vector<bool>& kept) {
  const std::vector<int> nodes = heaviest_nodes(character);
  std::map<int, std::vector<double>> areas;  // of each node, by region
  for (Index t = 0; t < nodes.size(); ++t) {
    std::vector<double>& of_node = areas[nodes[t]];
    of_node.resize(regions.count());
    of_node[regions.of_skin[t]] += triangle_area(character.skin, t);
  }
  std::vector<std::uint8_t> out = regions.of_skin;
  for (Index t = 0; t < nodes.size(); ++t) {
    const std::vector<double>& of_node = areas[nodes[t]];
    const auto most = std::max_element(of_node.begin(), of_node.end());
    const auto region = static_cast<std::size_t>(most - of_node.begin());
    if (kept[region] && *most > 0.5 * std::accumulate(of_node.begin(), of_node.end(), 0.0)) {
      out[t] = static_cast<std::uint8_t>(region);
    }
  }
  return out;
}

// The entry from `first` on whose skin is nearest.
int nearest_entry(const Mesh& skin, const std::vector<Entry>& entries, std::size_t first, const Entry& from) {
  std::size_t nearest = first;
  double least = std::numeric_limits<double>::max();
  for (std::size_t i = first; i < entries.size(); ++i) {
    const double distance = distance_of(skin, from.triangles, entries[i].triangles);
    if (distance >= least) continue;
    least = distance;
    nearest = i;
  }
  return static_cast<int>(nearest);
}

}  // namespace

Regions segment_by_bones(const Character& character, const Roles& roles, const std::optional<Vec3>& facing,
                         std::size_t spheres) {
  const std::vector<Part> parts = build_part_tree(character, spheres, {});
  Regions regions;
  regions.provider = "bones";
  regions.frame = frame_of(character, parts, roles, facing, regions.facing);
  std::set<std::string> taken;
  std::vector<Entry> entries;
  add_parts(character, roles, parts, taken, entries);
  fill(entries, character.skin.triangles.size(), regions);
  regions.body = all_pieces(character);
  return regions;
}

MixedRegions segment_rest_by_bones(const Character& character, const Regions& found, const std::vector<bool>& kept,
                                   const Roles& roles, std::size_t spheres) {
  Regions limbed = found;
  limbed.of_skin = with_all_of_limbs(character, found, kept);
  std::vector<bool> left_out;
  for (const std::uint8_t region : limbed.of_skin) left_out.push_back(kept[region]);
  const std::uint8_t torso = limbed.torso_region();
  std::set<std::string> taken{limbed.torso_name};
  std::vector<Entry> entries;
  MixedRegions out;
  for (std::uint8_t region = 0; region < torso; ++region) {
    if (!kept[region]) continue;
    entries.push_back({limbed.limbs[region], skin_of(limbed, region), 0, false});
    taken.insert(limbed.limbs[region].name);
    out.kept.push_back(region);
  }
  const std::size_t first = entries.size();
  add_parts(character, roles, build_part_tree(character, spheres, left_out), taken, entries);
  out.kept.resize(entries.size(), MixedRegions::kNone);
  if (kept[torso]) {
    const auto root = static_cast<int>(entries.size());
    entries.back().parent = root;
    const Limb spine{limbed.torso_name, Side::kNone, 0, limbed.spine, limbed.spine.length()};
    entries.push_back({spine, skin_of(limbed, torso), root, false});
    out.kept.push_back(torso);
  }
  for (std::size_t i = 0; i < first; ++i) {
    entries[i].parent =
        kept[torso] ? static_cast<int>(entries.size()) - 1 : nearest_entry(character.skin, entries, first, entries[i]);
  }
  out.regions.provider = limbed.provider;
  out.regions.frame = limbed.frame;
  out.regions.facing = limbed.facing;
  fill(entries, character.skin.triangles.size(), out.regions);
  out.regions.body = all_pieces(character);
  return out;
}

}  // namespace spherechain::baker

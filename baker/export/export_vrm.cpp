// SPDX-License-Identifier: GPL-3.0-or-later
// Colliders of spring bones. VRM 1.0 (VRMC_springBone) has spheres and capsules, VRM 0.x (VRM.secondaryAnimation) only
// spheres, whose offsets are Unity's: their z is mirrored. All are in the space of a bone's node.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "baker/export/formats.h"
#include "baker/export/glb_json.h"
#include "baker/export/simple_volumes.h"
#include "baker/import/rest_nodes.h"
#include "baker/mesh/decompose.h"
#include "baker/mesh/error.h"
#include "baker/volumes/volume_json.h"
#include "baker/write/glb_mark.h"

namespace spherechain::baker {

using nlohmann::ordered_json;

namespace {

// A body part's volumes in the space of its bone's node.
struct ColliderGroup {
  std::string part;
  int node;
  std::vector<Volume> volumes;
};

// Counts for the notes about what the export lost.
struct VrmLosses {
  int replaced = 0, made = 0;     // volumes, and those in their place
  double off = 0;                 // metres
  std::vector<std::string> lost;  // parts without a bone
  int scaled = 0;                 // parts whose bone has a scale
  bool is_stretched = false;
  std::map<std::string, int> left_out;  // parts, and how many springs start inside them
};

std::vector<ColliderGroup> groups_of(const Colliders& colliders, const SourceGlb& source,
                                     SimpleVolumes (*simple)(const Volume&), VrmLosses& losses) {
  std::vector<ColliderGroup> out;
  for (const ColliderBody& body : colliders.bodies) {
    if (body.volumes.empty()) continue;
    const int node = body.bone_index < 0 ? -1 : source.node_of_bone.at(static_cast<std::size_t>(body.bone_index));
    if (node < 0) {
      losses.lost.push_back(body.name);
      continue;
    }
    ColliderGroup group{body.name, node, {}};
    for (const Volume& volume : body.volumes) {
      const SimpleVolumes taken = simple(volume);
      if (taken.off > 0) {
        ++losses.replaced;
        losses.made += static_cast<int>(taken.volumes.size());
      }
      losses.off = std::max(losses.off, taken.off);
      for (const Volume& one : taken.volumes) group.volumes.push_back(moved(one, body.to_bone));
    }
    const Vec3 scale = singular_values(body.to_bone.linear()).values;
    if (std::abs(scale(0) - 1) > 1e-3 || std::abs(scale(2) - 1) > 1e-3) ++losses.scaled;
    if (scale(0) - scale(2) > 1e-3 * scale(0)) losses.is_stretched = true;
    out.push_back(std::move(group));
  }
  if (out.empty()) {
    throw Error(ExitCode::kFile, colliders.source_file + ": no body part follows a bone, so nothing can be written");
  }
  return out;
}

// The numbers of the groups that a spring collides with: all but those that one of its joints is inside of at rest,
// which would push it out of its own style.
void let_collide(ordered_json& spring, const std::vector<int>& joints, const std::vector<ColliderGroup>& groups,
                 std::size_t first, const RestNodes& rest, VrmLosses& losses) {
  ordered_json& numbers = array_in(spring, "colliderGroups");
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const Affine to_node = rest.world(groups[g].node).inverse();
    const bool is_inside = std::any_of(joints.begin(), joints.end(), [&](int joint) {
      const Vec3 point = to_node * Vec3(rest.world(joint).translation());
      return std::any_of(groups[g].volumes.begin(), groups[g].volumes.end(),
                         [&](const Volume& volume) { return signed_distance(volume, point) < 0; });
    });
    if (is_inside) {
      ++losses.left_out[groups[g].part];
    } else {
      numbers.push_back(first + g);
    }
  }
}

ordered_json collider_1(const ColliderGroup& group, const Volume& volume) {
  ordered_json shape;
  if (const auto* ball = std::get_if<BallVolume>(&volume)) {
    shape["sphere"] = {{"offset", json_of(ball->center)}, {"radius", ball->radius}};
  } else {
    const auto& capsule = std::get<ConeVolume>(volume);
    shape["capsule"] = {{"offset", json_of(capsule.a)}, {"radius", capsule.radius_a}, {"tail", json_of(capsule.b)}};
  }
  return {{"node", group.node}, {"shape", std::move(shape)}};
}

// Takes an earlier export's groups out, and the colliders that only they have.
void drop_earlier_1(ordered_json& extension) {
  array_in(extension, "colliders");  // both before any reference: a new member moves the others
  ordered_json& groups = array_in(extension, "colliderGroups");
  std::set<ordered_json> own, others;
  for (const ordered_json& group : groups) {
    for (const ordered_json& collider : entry_of(group, "colliders")) (is_own(group) ? own : others).insert(collider);
  }
  const std::vector<int> went_groups = take_out(groups, [](std::size_t, const ordered_json& g) { return is_own(g); });
  const std::vector<int> went_colliders =
      take_out(array_in(extension, "colliders"),
               [&](std::size_t i, const ordered_json&) { return own.count(i) > 0 && others.count(i) == 0; });
  for (ordered_json& group : groups) renumber(group["colliders"], went_colliders);
  if (!extension.contains("springs")) return;
  for (ordered_json& spring : extension["springs"]) {
    if (spring.contains("colliderGroups")) renumber(spring["colliderGroups"], went_groups);
  }
}

std::vector<int> joints_1(const ordered_json& spring) {
  std::vector<int> out;
  for (const ordered_json& joint : entry_of(spring, "joints")) {
    const ordered_json& node = entry_of(joint, "node");
    if (node.is_number_unsigned()) out.push_back(node.get<int>());
  }
  if (!out.empty()) out.erase(out.begin());  // the first does not move
  return out;
}

std::size_t write_vrm_1(ordered_json& json, const std::vector<ColliderGroup>& groups, VrmLosses& losses) {
  const RestNodes rest(json);
  ordered_json& extension = use_extension(json, "VRMC_springBone");
  if (!extension.contains("specVersion")) extension["specVersion"] = "1.0";
  drop_earlier_1(extension);
  const std::size_t first = extension["colliderGroups"].size();
  for (const ColliderGroup& group : groups) {
    ordered_json written{{"name", kOwnName + group.part}, {"colliders", ordered_json::array()}};
    for (const Volume& volume : group.volumes) {
      written["colliders"].push_back(extension["colliders"].size());
      extension["colliders"].push_back(collider_1(group, volume));
    }
    extension["colliderGroups"].push_back(std::move(written));
  }
  if (!extension.contains("springs")) return 0;
  for (ordered_json& spring : extension["springs"]) {
    let_collide(spring, joints_1(spring), groups, first, rest, losses);
    if (spring["colliderGroups"].empty()) spring.erase("colliderGroups");  // the format has no empty lists
  }
  return extension["springs"].size();
}

std::size_t write_vrm_0(ordered_json& json, const std::vector<ColliderGroup>& groups, VrmLosses& losses) {
  const RestNodes rest(json);
  ordered_json& animation = json["extensions"]["VRM"]["secondaryAnimation"];
  ordered_json& written = array_in(animation, "colliderGroups");
  const std::vector<int> went = take_out(written, [](std::size_t, const ordered_json& group) { return is_own(group); });
  const std::size_t first = written.size();
  for (const ColliderGroup& group : groups) {
    ordered_json colliders = ordered_json::array();
    for (const Volume& volume : group.volumes) {
      const auto& ball = std::get<BallVolume>(volume);
      colliders.push_back({{"offset", {{"x", ball.center.x()}, {"y", ball.center.y()}, {"z", -ball.center.z()}}},
                           {"radius", ball.radius}});
    }
    written.push_back({{"name", kOwnName + group.part}, {"node", group.node}, {"colliders", std::move(colliders)}});
  }
  if (!animation.contains("boneGroups")) return 0;
  for (ordered_json& spring : animation["boneGroups"]) {
    if (spring.contains("colliderGroups")) renumber(spring["colliderGroups"], went);
    std::vector<int> joints;  // all below its roots
    for (const ordered_json& root : entry_of(spring, "bones")) {
      if (root.is_number_unsigned()) rest.add_below(root.get<int>(), joints);
    }
    let_collide(spring, joints, groups, first, rest, losses);
  }
  return animation["boneGroups"].size();
}

std::vector<std::string> notes_of(const VrmLosses& losses, std::size_t springs, bool is_0) {
  std::vector<std::string> out;
  if (springs == 0) out.emplace_back("the file has no spring bones: programs ignore its colliders until it has some");
  if (losses.replaced > 0) {
    out.push_back(fmt::format("VRM {}: {} volumes became {} {}, whose surface is up to {:.1f} mm off",
                              is_0 ? "0.x has only spheres" : "has no such shape", losses.replaced, losses.made,
                              is_0 ? "spheres" : "capsules of one radius", 1000 * losses.off));
  }
  if (!losses.lost.empty()) {
    out.push_back(fmt::format("left out, for no bone moves it: {}", fmt::join(losses.lost, ", ")));
  }
  if (losses.scaled > 0) {
    out.push_back(fmt::format(
        "{} parts follow bones with a scale: UniVRM for VRM 0.x scales their radii with it, three-vrm does not",
        losses.scaled));
  }
  if (losses.is_stretched) out.emplace_back("bones stretched along an axis: their colliders have a mean radius");
  for (const auto& [part, count] : losses.left_out) {
    out.push_back(fmt::format("{} of {} springs start inside {} and do not collide with it", count, springs, part));
  }
  return out;
}

}  // namespace

Export export_vrm(const Colliders& colliders, const SourceGlb& source) {
  ordered_json json = json_of_glb(source.bytes);
  const ordered_json& extensions = entry_of(json, "extensions");
  const bool is_0 = !entry_of(extensions, "VRM").is_null() && entry_of(extensions, "VRMC_vrm").is_null();
  VrmLosses losses;
  const std::vector<ColliderGroup> groups = groups_of(colliders, source, is_0 ? as_balls : as_capsule, losses);
  const std::size_t springs = is_0 ? write_vrm_0(json, groups, losses) : write_vrm_1(json, groups, losses);
  mark_as_own(json);
  return {{{"", with_json(source.bytes, json)}}, notes_of(losses, springs, is_0)};
}

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
// KHR_implicit_shapes with KHR_physics_rigid_bodies, and OMI_physics_shape with OMI_physics_body: the same nodes and
// shapes in other words. Below a bone's node stands a node for each body part, kinematic, and below it one for each
// volume. The bone's node itself stays as it is: an importer that makes bones of joints has no node there, and two
// parts may follow one bone.
#include <fmt/format.h>

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

struct PhysicsWords {
  const char* shapes;  // the extensions
  const char* bodies;
};
constexpr PhysicsWords kKhrWords{"KHR_implicit_shapes", "KHR_physics_rigid_bodies"};
constexpr PhysicsWords kOmiWords{"OMI_physics_shape", "OMI_physics_body"};

// Along +Y, its middle at the origin.
struct PlacedShape {
  ordered_json shape;
  Eigen::Isometry3d at;  // in the body's frame
};

PlacedShape shape_of_volume(const Volume& volume) {
  PlacedShape out{{}, Eigen::Isometry3d::Identity()};
  if (const auto* ball = std::get_if<BallVolume>(&volume)) {
    out.shape = {{"type", "sphere"}, {"sphere", {{"radius", ball->radius}}}};
    out.at.translation() = ball->center;
  } else if (const auto* cone = std::get_if<ConeVolume>(&volume)) {
    const Vec3 axis = cone->b - cone->a;
    out.shape = {
        {"type", "capsule"},
        {"capsule", {{"height", axis.norm()}, {"radiusBottom", cone->radius_a}, {"radiusTop", cone->radius_b}}}};
    out.at.translation() = (cone->a + cone->b) / 2;
    out.at.linear() = turn_between(Vec3::UnitY(), axis).toRotationMatrix();
  } else {
    const auto& box = std::get<BoxVolume>(volume);
    out.shape = {{"type", "box"}, {"box", {{"size", json_of(Vec3(2 * box.half))}}}};
    out.at.translation() = box.center;
    out.at.linear() = box.rotation.toRotationMatrix();
  }
  return out;
}

ordered_json node_at(const std::string& name, const Vec3& translation, const Eigen::Matrix3d& rotation) {
  return {{"name", name},
          {"translation", json_of(translation)},
          {"rotation", json_of(Eigen::Quaterniond(rotation).normalized())}};
}

bool is_resized(const RestNodes& rest, const ColliderBody& body, int node) {
  const Affine in_scene = rest.world(node) * body.to_bone;
  return (singular_values(in_scene.linear()).values - Vec3::Ones()).cwiseAbs().maxCoeff() > 1e-3;
}

class PhysicsWriter {
 public:
  PhysicsWriter(const Colliders& colliders, const SourceGlb& source, const PhysicsWords& words)
      : colliders_(colliders), source_(source), words_(words), json_(json_of_glb(source.bytes)) {
    drop_earlier();
  }

  Export write() {
    const RestNodes rest(json_);
    std::vector<std::string> lost;
    for (std::size_t b = 0; b < colliders_.bodies.size(); ++b) {
      const ColliderBody& body = colliders_.bodies[b];
      if (body.volumes.empty()) continue;
      const int node = body.bone_index < 0 ? -1 : source_.node_of_bone.at(static_cast<std::size_t>(body.bone_index));
      if (node < 0) {
        lost.push_back(body.name);
      } else {
        if (is_resized(rest, body, node)) ++resized_;
        add_body(b, static_cast<std::size_t>(node));
      }
    }
    if (shape_count_ == 0)
      throw Error(ExitCode::kFile, colliders_.source_file + ": no body part follows a bone, so nothing can be written");
    mark_as_own(json_);
    Export out{{{"", with_json(source_.bytes, json_)}}, {}};
    if (!lost.empty()) out.notes.push_back(fmt::format("left out, for no bone moves it: {}", fmt::join(lost, ", ")));
    if (stretched_ > 0) {
      out.notes.push_back(fmt::format(
          "{} bones are stretched along an axis: a node of its own undoes that; other poses may shear it", stretched_));
    }
    if (resized_ > 0) {
      out.notes.push_back(
          fmt::format("{} parts have another size in the file's pose than where their skin was bound: their shapes "
                      "change with them",
                      resized_));
    }
    if (replaced_ > 0) {
      out.notes.push_back(
          fmt::format("{} ellipsoids became capsules, whose surface is up to {:.0f} mm off", replaced_, 1000 * off_));
    }
    return out;
  }

 private:
  // Bodies of an earlier export, of either kind. Nodes can only go from the end: numbers of others would change.
  void drop_earlier() {
    ordered_json& nodes = array_in(json_, "nodes");
    std::size_t kept = nodes.size();
    while (kept > 0 && is_own(nodes[kept - 1])) --kept;
    nodes.erase(nodes.begin() + static_cast<std::ptrdiff_t>(kept), nodes.end());
    for (ordered_json& node : nodes) {
      if (is_own(node)) {
        throw Error(ExitCode::kFile,
                    colliders_.source_file + ": has bodies of an earlier export among its nodes (name a file without)");
      }
      if (!node.contains("children")) continue;
      const auto is_gone = [&](std::size_t, const ordered_json& child) { return child >= kept; };
      take_out(node["children"], is_gone);
      if (node["children"].empty()) node.erase("children");
    }
    for (const PhysicsWords& words : {kKhrWords, kOmiWords}) {
      drop_list(words.shapes, "shapes");
      drop_list(words.bodies, "collisionFilters");
    }
  }

  void drop_list(const char* name, const char* list) {
    if (entry_of(entry_of(json_, "extensions"), name).is_null()) return;
    ordered_json& extension = json_["extensions"][name];
    ordered_json& entries = array_in(extension, list);
    while (!entries.empty() && is_own(entries.back())) entries.erase(entries.size() - 1);
    if (entries.empty()) extension.erase(list);
    if (extension.empty()) drop_extension(json_, name);
  }

  std::size_t add_node(std::size_t parent, ordered_json node) {
    json_["nodes"].push_back(std::move(node));
    const std::size_t number = json_["nodes"].size() - 1;
    array_in(json_["nodes"][parent], "children").push_back(number);
    return number;
  }

  // A rotation and a scale, and where the bone is stretched one more rotation in a node of its own.
  std::size_t add_frame(const ColliderBody& body, std::size_t bone) {
    const std::string name = kOwnName + body.name;
    auto [u, scale, v] = singular_values(body.to_bone.linear());
    const bool is_even = scale(0) - scale(2) <= 1e-5 * scale(0) && body.to_bone.linear().determinant() > 0;
    if (is_even) {
      ordered_json node = node_at(name, body.to_bone.translation(), u * v.transpose());
      const double size = scale.mean();
      if (std::abs(size - 1) > 1e-6) node["scale"] = {size, size, size};
      return add_node(bone, std::move(node));
    }
    for (Eigen::Matrix3d* side : {&u, &v}) {  // a mirror is no rotation: into the scale
      if (side->determinant() > 0) continue;
      side->col(2) = -side->col(2);
      scale(2) = -scale(2);
    }
    ++stretched_;
    ordered_json stretch = node_at(name + " stretch", body.to_bone.translation(), u);
    stretch["scale"] = json_of(scale);
    return add_node(add_node(bone, std::move(stretch)), node_at(name, Vec3::Zero(), v.transpose()));
  }

  void add_body(std::size_t b, std::size_t bone) {
    const ColliderBody& body = colliders_.bodies[b];
    const bool is_khr = words_.shapes == kKhrWords.shapes;
    const std::size_t frame = add_frame(body, bone);
    json_["nodes"][frame]["extensions"][words_.bodies]["motion"] =
        is_khr ? ordered_json{{"isKinematic", true}} : ordered_json{{"type", "kinematic"}};
    const std::size_t filter = add_filter(static_cast<int>(b));
    int number = 0;
    for (const Volume& volume : body.volumes) {
      const SimpleVolumes simple = without_ellipsoid(volume);
      if (simple.off > 0) ++replaced_;
      off_ = std::max(off_, simple.off);
      PlacedShape placed = shape_of_volume(simple.volumes.front());
      const std::string name = fmt::format("{}{} {}", kOwnName, body.name, ++number);
      placed.shape["name"] = name;
      ordered_json& shapes = array_in(use_extension(json_, words_.shapes), "shapes");
      shapes.push_back(std::move(placed.shape));
      ordered_json collider = is_khr ? ordered_json{{"geometry", {{"shape", shapes.size() - 1}}}}
                                     : ordered_json{{"shape", shapes.size() - 1}};
      collider["collisionFilter"] = filter;
      ordered_json node = node_at(name, placed.at.translation(), placed.at.linear());
      node["extensions"][words_.bodies]["collider"] = std::move(collider);
      add_node(frame, std::move(node));
      ++shape_count_;
    }
  }

  // One system a part, and the systems that it does not meet. Both parts of a pair say so.
  std::size_t add_filter(int b) {
    const auto system = [&](int body) { return kOwnName + colliders_.bodies[static_cast<std::size_t>(body)].name; };
    ordered_json filter{{"name", system(b)}, {"collisionSystems", {system(b)}}};
    for (const IgnoredBodies& pair : colliders_.ignored) {
      if (pair.a == b) filter["notCollideWithSystems"].push_back(system(pair.b));
      if (pair.b == b) filter["notCollideWithSystems"].push_back(system(pair.a));
    }
    ordered_json& filters = array_in(use_extension(json_, words_.bodies), "collisionFilters");
    filters.push_back(std::move(filter));
    return filters.size() - 1;
  }

  const Colliders& colliders_;
  const SourceGlb& source_;
  const PhysicsWords words_;
  ordered_json json_;
  std::size_t shape_count_ = 0;
  int stretched_ = 0, resized_ = 0, replaced_ = 0;
  double off_ = 0;
};

}  // namespace

Export export_khr(const Colliders& colliders, const SourceGlb& source) {
  return PhysicsWriter(colliders, source, kKhrWords).write();
}

Export export_omi(const Colliders& colliders, const SourceGlb& source) {
  return PhysicsWriter(colliders, source, kOmiWords).write();
}

}  // namespace spherechain::baker

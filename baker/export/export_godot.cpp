// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "baker/export/for_engines.h"
#include "baker/export/formats.h"
#include "baker/export/names.h"
#include "baker/export/scripts.h"

// A scene of Godot 4 to put under a Skeleton3D. Godot sets a PhysicalBone3D to its bone's transform without scale,
// which is our body's frame: no offset is needed, and shapes are in metres whatever the bone's scale.
namespace spherechain::baker {
namespace {

bool is_godot_character(char c) { return std::string_view(".:@/\"%\\\n\r").find(c) == std::string_view::npos; }

std::string godot_string(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

// The rotation by rows, then the origin.
std::string godot_transform(const Eigen::Quaterniond& rotation, const Vec3& origin) {
  const Eigen::Matrix3d m = rotation.normalized().toRotationMatrix();
  return fmt::format("Transform3D({}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {})", m(0, 0), m(0, 1), m(0, 2), m(1, 0),
                     m(1, 1), m(1, 2), m(2, 0), m(2, 1), m(2, 2), origin.x(), origin.y(), origin.z());
}

struct GodotShape {
  std::string type, properties, transform;
};

GodotShape godot_shape(const Volume& volume) {
  if (const auto* ball = std::get_if<BallVolume>(&volume)) {
    return {"SphereShape3D", fmt::format("radius = {}\n", ball->radius),
            godot_transform(Eigen::Quaterniond::Identity(), ball->center)};
  }
  if (const auto* box = std::get_if<BoxVolume>(&volume)) {
    return {"BoxShape3D",
            fmt::format("size = Vector3({}, {}, {})\n", 2 * box->half.x(), 2 * box->half.y(), 2 * box->half.z()),
            godot_transform(box->rotation, box->center)};
  }
  const auto& capsule = std::get<ConeVolume>(volume);
  const double height = (capsule.b - capsule.a).norm() + 2 * capsule.radius_a;  // from end to end
  return {"CapsuleShape3D", fmt::format("radius = {}\nheight = {}\n", capsule.radius_a, height),
          godot_transform(turn_to(1, capsule.b - capsule.a), (capsule.a + capsule.b) / 2)};
}

}  // namespace

Export export_godot(const Colliders& given) {
  Export out;
  Colliders colliders = given;
  use_balls(colliders);
  use_capsules_for_cones(colliders, out.notes);
  use_capsules_for_ellipsoids(colliders, out.notes);
  keep_bodies_on_bones(colliders, out.notes);
  join_bodies_of_a_bone(colliders, out.notes);
  const std::vector<std::string> names = unique_names(colliders, is_godot_character);

  std::string shapes, nodes, ignored;
  int count = 0;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const ColliderBody& body = colliders.bodies[i];
    nodes += fmt::format("\n[node name={} type=\"PhysicalBone3D\" parent=\".\"]\ntransform = {}\nbone_name = {}\n",
                         godot_string(names[i]),
                         godot_transform(Eigen::Quaterniond(body.rest.linear()), body.rest.translation()),
                         godot_string(body.bone));
    int number = 0;
    for (const Volume& volume : body.volumes) {
      const GodotShape shape = godot_shape(volume);
      shapes += fmt::format("\n[sub_resource type=\"{}\" id=\"{}\"]\n{}", shape.type, ++count, shape.properties);
      nodes += fmt::format(
          "\n[node name=\"volume_{}\" type=\"CollisionShape3D\" parent={}]\ntransform = {}\nshape = "
          "SubResource(\"{}\")\n",
          ++number, godot_string(names[i]), shape.transform, count);
    }
  }
  for (const IgnoredBodies& pair : colliders.ignored) {
    ignored +=
        fmt::format("{}{}, {}", ignored.empty() ? "" : ", ", godot_string(names[static_cast<std::size_t>(pair.a)]),
                    godot_string(names[static_cast<std::size_t>(pair.b)]));
  }
  const std::string scene = fmt::format(
      "[gd_scene load_steps={} format=3]\n\n; Written by spherechain for {}: instantiate under its Skeleton3D.\n\n"
      "[sub_resource type=\"GDScript\" id=\"script\"]\nscript/source = {}\n{}\n"
      "[node name=\"Colliders\" type=\"PhysicalBoneSimulator3D\"]\nscript = SubResource(\"script\")\n"
      "ignored = PackedStringArray({})\n{}",
      count + 2, godot_string(colliders.source_file), godot_string(kGodotScript), shapes, ignored, nodes);
  out.files.push_back({"", scene});
  return out;
}

}  // namespace spherechain::baker

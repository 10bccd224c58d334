// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <system_error>

#include "baker/import/named_file.h"
#include "baker/import/notes.h"
#include "baker/import/robot_model.h"
#include "baker/import/xml_file.h"

namespace spherechain::baker {
namespace {

namespace fs = std::filesystem;

std::string package_name(const fs::path& folder) {
  std::error_code ignored;
  if (!fs::is_regular_file(folder / "package.xml", ignored)) return {};
  pugi::xml_document document;
  document.load_file((folder / "package.xml").c_str());
  return document.child("package").child_value("name");
}

// Finds the meshes that a URDF names, in its folder or in the package around it, which a package.xml marks.
class MeshFinder {
 public:
  explicit MeshFinder(const fs::path& urdf) {
    std::error_code ignored;
    folder_ = fs::canonical(urdf.has_parent_path() ? urdf.parent_path() : ".", ignored);
    home_ = folder_;
    for (fs::path up = folder_; up != up.root_path(); up = up.parent_path()) {
      if (!fs::is_regular_file(up / "package.xml", ignored)) continue;
      home_ = up;
      break;
    }
  }

  NamedFile find(const std::string& name) const {
    constexpr std::string_view kPackage = "package://";
    if (!name.starts_with(kPackage)) return in(home_, (folder_.lexically_relative(home_) / name).lexically_normal());
    const std::size_t slash = std::min(name.find('/', kPackage.size()), name.size());
    const std::string package = name.substr(kPackage.size(), slash - kPackage.size());
    const std::string rest = name.substr(std::min(slash + 1, name.size()));
    // A stranger's file may name any folder around it: that is a package where it says so, or holds the URDF's folder.
    for (fs::path up = folder_; up != up.root_path(); up = up.parent_path()) {
      const bool is_near = up == folder_ || up == folder_.parent_path();
      std::error_code ignored;
      const bool is_package = is_near || fs::is_regular_file(up / "package.xml", ignored);
      if (is_package && (up.filename() == package || package_name(up) == package)) return in(up, rest);
    }
    return in(home_, rest);  // a package in a folder of another name
  }

 private:
  static NamedFile in(const fs::path& folder, const fs::path& name) {
    return named_file(folder, name.generic_string());
  }

  fs::path folder_, home_;
};

class UrdfReader {
 public:
  explicit UrdfReader(const fs::path& path) : file_(path), finder_(path) {}

  RobotModel run() {
    const pugi::xml_node robot = file_.root();
    model_.name = robot.attribute("name").value();
    for (const pugi::xml_node child : robot.children()) {
      if (std::string_view(child.name()).starts_with("xacro:"))
        file_.fail("is a xacro file (write the URDF with `xacro FILE > FILE.urdf`)");
    }
    for (const pugi::xml_node material : robot.children("material")) read_colour(material);
    for (const pugi::xml_node link : robot.children("link")) {
      if (!links_.try_emplace(link.attribute("name").value(), link).second)
        file_.fail(in_words(link) + " is there twice");
    }
    if (links_.empty()) file_.fail("has no links");
    for (const pugi::xml_node joint : robot.children("joint")) {
      const std::string parent = end_of(joint, "parent"), child = end_of(joint, "child");
      if (!parent_joint_.try_emplace(child, joint).second)
        file_.fail("link '" + child + "' is the child of two joints (a robot is a tree)");
      children_[parent].push_back(joint);
    }
    add_links(robot);
    add_joints(robot);
    return std::move(model_);
  }

 private:
  std::string end_of(pugi::xml_node joint, const char* which) const {
    const std::string name = joint.child(which).attribute("link").value();
    if (!links_.contains(name)) file_.fail(in_words(joint) + ": its " + which + " '" + name + "' is no link");
    return name;
  }

  void add_links(pugi::xml_node robot) {
    std::vector<std::pair<pugi::xml_node, int>> waiting;
    for (const pugi::xml_node link : robot.children("link")) {
      if (!parent_joint_.contains(link.attribute("name").value())) waiting.emplace_back(link, -1);
    }
    if (waiting.size() > 1) {
      file_.fail("has two links without a parent, '" + std::string(waiting[0].first.attribute("name").value()) +
                 "' and '" + waiting[1].first.attribute("name").value() + "' (connect them by a joint)");
    }
    while (!waiting.empty()) {
      const auto [link, parent] = waiting.back();
      waiting.pop_back();
      const std::string name = link.attribute("name").value();
      number_.emplace(name, static_cast<Index>(model_.links.size()));
      RobotLink out;
      out.name = name;
      out.parent = parent;
      if (parent >= 0) out.base = origin_of(parent_joint_.at(name));
      read_shapes(link, out);
      model_.links.push_back(std::move(out));
      const auto number = static_cast<int>(model_.links.size()) - 1;
      const auto below = children_.find(name);
      if (below == children_.end()) continue;
      for (auto joint = below->second.rbegin(); joint != below->second.rend(); ++joint)
        waiting.emplace_back(links_.at(joint->child("child").attribute("link").value()), number);
    }
    if (model_.links.size() < links_.size()) file_.fail("its joints go round in a circle (a robot is a tree)");
  }

  void add_joints(pugi::xml_node robot) {
    std::map<std::string, int> number;
    std::vector<std::pair<std::size_t, pugi::xml_node>> mimics;
    for (const pugi::xml_node joint : robot.children("joint")) {
      const std::string type = joint.attribute("type").value();
      if (type == "fixed") continue;
      RigJoint out;
      out.name = joint.attribute("name").value();
      out.node = number_.at(joint.child("child").attribute("link").value());
      if (type == "prismatic")
        out.kind = RigJointKind::kSlide;
      else if (type == "floating")
        out.kind = RigJointKind::kFree;
      else if (type != "revolute" && type != "continuous")
        file_.fail(in_words(joint) + ": type " + in_quotes(type) +
                   " is not read (revolute, continuous, prismatic, fixed and floating are)");
      out.axis = file_.vector(joint.child("axis").attribute("xyz")).value_or(Vec3::UnitX());
      if (!(out.axis.norm() > 0)) file_.fail(in_words(joint) + ": its axis has no length");
      out.axis.normalize();
      if (type != "continuous") {
        const pugi::xml_node limit = joint.child("limit");
        out.lower = file_.number(limit.attribute("lower")).value_or(limit ? 0 : out.lower);
        out.upper = file_.number(limit.attribute("upper")).value_or(limit ? 0 : out.upper);
      }
      if (const pugi::xml_node mimic = joint.child("mimic")) {
        out.multiplier = file_.number(mimic.attribute("multiplier")).value_or(1);
        out.offset = file_.number(mimic.attribute("offset")).value_or(0);
        mimics.emplace_back(model_.joints.size(), mimic);
      }
      number.emplace(out.name, static_cast<int>(model_.joints.size()));
      model_.joints.push_back(std::move(out));
    }
    for (const auto& [joint, mimic] : mimics) {
      const auto found = number.find(mimic.attribute("joint").value());
      if (found == number.end())
        file_.fail("joint '" + model_.joints[joint].name + "' mimics " + in_quotes(mimic.attribute("joint").value()) +
                   ", which is no joint that moves");
      model_.joints[joint].mimic = found->second;
    }
  }

  Affine origin_of(pugi::xml_node element) const {
    const pugi::xml_node origin = element.child("origin");
    const Vec3 xyz = file_.vector(origin.attribute("xyz")).value_or(Vec3::Zero()),
               rpy = file_.vector(origin.attribute("rpy")).value_or(Vec3::Zero());
    return Affine(Eigen::Translation3d(xyz) * Eigen::AngleAxisd(rpy.z(), Vec3::UnitZ()) *
                  Eigen::AngleAxisd(rpy.y(), Vec3::UnitY()) * Eigen::AngleAxisd(rpy.x(), Vec3::UnitX()));
  }

  std::optional<std::array<float, 3>> read_colour(pugi::xml_node material) {
    const std::vector<double> rgba = file_.numbers(material.child("color").attribute("rgba"), 4, 4);
    const std::string name = material.attribute("name").value();
    if (!rgba.empty())
      colours_[name] = {static_cast<float>(rgba[0]), static_cast<float>(rgba[1]), static_cast<float>(rgba[2])};
    const auto found = colours_.find(name);
    return found == colours_.end() ? std::nullopt : std::optional(found->second);
  }

  void read_shapes(pugi::xml_node link, RobotLink& out) {
    for (const char* use : {"visual", "collision"}) {
      for (const pugi::xml_node element : link.children(use)) {
        RobotShape shape;
        shape.place = origin_of(element);
        shape.is_visual = use == std::string_view("visual");
        shape.is_collider = !shape.is_visual;
        if (shape.is_visual && element.child("material")) shape.colour = read_colour(element.child("material"));
        if (read_geometry(link, element.child("geometry").first_child(), shape)) out.shapes.push_back(std::move(shape));
      }
    }
  }

  bool read_geometry(pugi::xml_node link, pugi::xml_node geometry, RobotShape& shape) const {
    const std::string kind = geometry.name();
    const auto length = [&](const char* name) {
      const std::optional<double> value = file_.number(geometry.attribute(name));
      if (!value || !(*value > 0)) file_.fail(in_words(link) + ": its " + kind + " has no " + name);
      return *value;
    };
    if (kind == "mesh") {
      const std::string name = geometry.attribute("filename").value();
      const NamedFile found = finder_.find(name);
      if (!found.is_there) {
        file_.fail(
            in_words(link) + ": needs the file " + in_quotes(name) + ", which " + found.what_is_wrong() +
            (found.refusal != nullptr ? " (an empty package.xml in a folder around both makes it the package)" : ""));
      }
      shape.file = found.path;
      shape.size = file_.vector(geometry.attribute("scale")).value_or(Vec3::Ones());
    } else if (kind == "box") {
      shape.kind = ShapeKind::kBox;
      shape.size = file_.vector(geometry.attribute("size")).value_or(Vec3::Zero()) / 2;
      if (!(shape.size.minCoeff() > 0)) file_.fail(in_words(link) + ": its box has no size");
    } else if (kind == "sphere") {
      shape.kind = ShapeKind::kEllipsoid;
      shape.size.setConstant(length("radius"));
    } else if (kind == "cylinder" || kind == "capsule") {
      shape.kind = kind == "cylinder" ? ShapeKind::kCylinder : ShapeKind::kCapsule;
      shape.size = {length("radius"), length("length") / 2, 0};
    } else {
      add_note(in_words(link) + ": geometry " + in_quotes(kind) + " is not read");
      return false;
    }
    return true;
  }

  XmlFile file_;
  MeshFinder finder_;
  RobotModel model_;
  std::map<std::string, pugi::xml_node> links_, parent_joint_;  // by the link's name
  std::map<std::string, std::vector<pugi::xml_node>> children_;
  std::map<std::string, Index> number_;
  std::map<std::string, std::array<float, 3>> colours_;
};

}  // namespace

RobotModel read_urdf(const fs::path& path) { return UrdfReader(path).run(); }

}  // namespace spherechain::baker

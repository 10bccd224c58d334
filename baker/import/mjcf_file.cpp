// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "baker/import/named_file.h"
#include "baker/import/notes.h"
#include "baker/import/robot_model.h"
#include "baker/import/xml_file.h"

namespace spherechain::baker {
namespace {

using pugi::xml_node;

// Attributes that an element has itself, or from its default classes.
using Attributes = std::map<std::string, pugi::xml_attribute>;

void put(Attributes& to, xml_node element) {
  for (const pugi::xml_attribute attribute : element.attributes()) to[attribute.name()] = attribute;
}

constexpr const char* kMainClass = "main";

class MjcfReader {
 public:
  explicit MjcfReader(const std::filesystem::path& path)
      : path_(path), folder_(path.has_parent_path() ? path.parent_path() : "."), file_(path) {}

  RobotModel run() {
    include(file_.root(), 0);
    model_.name = file_.root().attribute("model").value();
    for (const xml_node compiler : of_kind("compiler")) read_compiler(compiler);
    for (const xml_node defaults : of_kind("default")) read_class(defaults, kMainClass, {});
    for (const xml_node asset : of_kind("asset")) {
      for (const xml_node mesh : asset.children("mesh")) meshes_.try_emplace(name_of_mesh(mesh), mesh);
      for (const xml_node material : asset.children("material"))
        materials_.try_emplace(material.attribute("name").value(), material);
    }
    model_.links.push_back({"world", -1, Affine::Identity(), {}});
    for (const xml_node world : of_kind("worldbody")) read_content(world, 0, kMainClass, Affine::Identity(), 0);
    for (const xml_node contact : of_kind("contact")) {
      for (const xml_node exclude : contact.children("exclude"))
        model_.excluded.push_back({link_named(exclude, "body1"), link_named(exclude, "body2")});
    }
    for (const xml_node equality : of_kind("equality")) {
      for (const xml_node joint : equality.children("joint")) read_mimic(joint);
    }
    for (const auto& [kind, count] : skipped_)
      add_note(path_.string() + ": not read: " + std::to_string(count) + " " + kind);
    model_.included.assign(included_.begin(), included_.end());
    return std::move(model_);
  }

 private:
  static constexpr int kDepthMax = 500;  // of bodies, and of files that include each other

  // Sections of the file and of those that it includes, of one name.
  std::vector<xml_node> of_kind(const char* name) const {
    std::vector<xml_node> out;
    for (const xml_node child : file_.root().children(name)) out.push_back(child);
    return out;
  }

  // Puts what a file includes in the place of the element that includes it.
  void include(xml_node parent, int depth) {
    if (depth > kDepthMax) file_.fail("its elements or includes are nested too deeply");
    for (xml_node child = parent.first_child(); child;) {
      const xml_node next = child.next_sibling();
      if (child.name() == std::string_view("include")) {
        const std::string name = child.attribute("file").value();
        const NamedFile found = named_file(folder_, name);
        if (!found.is_there) file_.fail("includes the file " + in_quotes(name) + ", which " + found.what_is_wrong());
        if (!included_.insert(found.path).second) file_.fail("includes the file " + in_quotes(name) + " twice");
        const XmlFile other(found.path);
        xml_node last = child;
        for (const xml_node one : other.root().children()) last = parent.insert_copy_after(one, last);
        const xml_node first = child.next_sibling();
        parent.remove_child(child);
        child = other.root().first_child() ? first : next;
        continue;
      }
      include(child, depth + 1);
      child = next;
    }
  }

  void read_compiler(xml_node compiler) {
    const std::string_view angle = compiler.attribute("angle").as_string("degree");
    if (compiler.attribute("angle")) is_degrees_ = angle != "radian";
    euler_ = compiler.attribute("eulerseq").as_string(euler_.c_str());
    const bool is_sequence = euler_.size() == 3 && euler_.find_first_not_of("xyzXYZ") == euler_.npos;
    if (!is_sequence) file_.fail("eulerseq " + in_quotes(euler_) + " is not three of x, y, z, X, Y and Z");
    if (const auto limits = compiler.attribute("autolimits")) auto_limits_ = limits.as_bool();
    if (compiler.attribute("coordinate").as_string() == std::string_view("global"))
      file_.fail("has global coordinates, which are not read (save it with MuJoCo's compile)");
    for (const char* name : {"assetdir", "meshdir"}) {
      if (const auto folder = compiler.attribute(name)) mesh_folder_ = folder.value();
    }
  }

  void read_class(xml_node element, const std::string& otherwise, std::map<std::string, Attributes> of_kind) {
    const std::string name = element.attribute("class").as_string(otherwise.c_str());
    for (const xml_node child : element.children()) {
      if (child.name() != std::string_view("default")) put(of_kind[child.name()], child);
    }
    classes_[name] = of_kind;
    for (const xml_node child : element.children("default")) read_class(child, "", of_kind);
  }

  // `around` is the class of the bodies around.
  Attributes attributes_of(xml_node element, const std::string& around) const {
    const std::string name = element.attribute("class").as_string(around.c_str());
    Attributes out;
    const auto found = classes_.find(name);
    if (found == classes_.end() && name != kMainClass)
      file_.fail(in_words(element) + ": there is no default class " + in_quotes(name));
    if (found != classes_.end()) {
      if (const auto of_kind = found->second.find(element.name()); of_kind != found->second.end())
        out = of_kind->second;
    }
    put(out, element);
    return out;
  }

  static pugi::xml_attribute at(const Attributes& attributes, const char* name) {
    const auto found = attributes.find(name);
    return found == attributes.end() ? pugi::xml_attribute() : found->second;
  }

  double radians(double angle) const { return is_degrees_ ? angle * std::numbers::pi / 180 : angle; }

  Eigen::Quaterniond rotation_of(const Attributes& a) const {
    if (const auto q = file_.numbers(at(a, "quat"), 4, 4); !q.empty()) {
      const Eigen::Quaterniond out(q[0], q[1], q[2], q[3]);
      if (!(out.norm() > 0)) file_.fail("a quat has no length");
      return out.normalized();
    }
    const auto unit = [&](const Vec3& v) {
      if (!(v.norm() > 0)) file_.fail("an axis has no length");
      return Vec3(v.normalized());
    };
    if (const auto v = file_.numbers(at(a, "axisangle"), 4, 4); !v.empty())
      return Eigen::Quaterniond(Eigen::AngleAxisd(radians(v[3]), unit({v[0], v[1], v[2]})));
    if (const auto v = file_.vector(at(a, "euler"))) {
      // Small letters turn about the axes that turned, capitals about those that stay.
      Eigen::Quaterniond out = Eigen::Quaterniond::Identity();
      for (Eigen::Index i = 0; i < 3; ++i) {
        const char axis = euler_[static_cast<std::size_t>(i)];
        const Eigen::Quaterniond turn(
            Eigen::AngleAxisd(radians((*v)[i]), Vec3::Unit(std::tolower(static_cast<unsigned char>(axis)) - 'x')));
        out = std::islower(static_cast<unsigned char>(axis)) != 0 ? out * turn : turn * out;
      }
      return out;
    }
    if (const auto v = file_.numbers(at(a, "xyaxes"), 6, 6); !v.empty()) {
      Eigen::Matrix3d axes;
      axes.col(0) = unit({v[0], v[1], v[2]});
      const Vec3 y(v[3], v[4], v[5]);
      axes.col(1) = unit(y - y.dot(axes.col(0)) * axes.col(0));
      axes.col(2) = axes.col(0).cross(axes.col(1));
      return Eigen::Quaterniond(axes);
    }
    if (const auto v = file_.vector(at(a, "zaxis"))) return Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), unit(*v));
    return Eigen::Quaterniond::Identity();
  }

  Affine place_of(const Attributes& attributes) const {
    return Affine(Eigen::Translation3d(file_.vector(at(attributes, "pos")).value_or(Vec3::Zero())) *
                  rotation_of(attributes));
  }
  Affine place_of(xml_node element) const {
    Attributes own;
    put(own, element);
    return place_of(own);
  }

  // Bodies, geoms and joints of a body or a frame of it. `frame` is a frame's place in the body.
  void read_content(xml_node parent, Index link, const std::string& around, const Affine& frame, int depth) {
    if (depth > kDepthMax) file_.fail("its bodies are nested too deeply");
    const std::string own = parent.attribute("childclass").as_string(around.c_str());
    // Its joints and geoms come before bodies below: joints are in the file's order.
    for (const xml_node child : parent.children()) {
      const std::string_view kind = child.name();
      if (kind == "joint" || kind == "freejoint")
        read_joint(child, link, own, frame);
      else if (kind == "geom")
        read_geom(child, link, own, frame);
      else if (kind == "composite" || kind == "flexcomp" || kind == "replicate" || kind == "attach")
        ++skipped_[std::string(kind)];
    }
    for (const xml_node child : parent.children()) {
      const std::string_view kind = child.name();
      if (kind == "frame") {
        read_content(child, link, own, frame * place_of(child), depth + 1);
      } else if (kind == "body") {
        const auto number = static_cast<Index>(model_.links.size());
        model_.links.push_back({name_of(child, number), static_cast<int>(link), frame * place_of(child), {}});
        read_content(child, number, own, Affine::Identity(), depth + 1);
      }
    }
  }

  std::string name_of(xml_node body, Index number) {
    std::string name = body.attribute("name").as_string();
    if (name.empty()) name = "body " + std::to_string(number);
    if (!number_.try_emplace(name, number).second) file_.fail(in_words(body) + " is there twice");
    return name;
  }

  void read_joint(xml_node element, Index link, const std::string& around, const Affine& frame) {
    if (link == 0) file_.fail(in_words(element) + " moves the world");
    const Attributes a = attributes_of(element, around);
    RigJoint out;
    out.name = element.attribute("name").value();
    out.node = link;
    const std::string type =
        element.name() == std::string_view("freejoint") ? "free" : at(a, "type").as_string("hinge");
    if (type == "slide")
      out.kind = RigJointKind::kSlide;
    else if (type == "ball")
      out.kind = RigJointKind::kBall;
    else if (type == "free")
      out.kind = RigJointKind::kFree;
    else if (type != "hinge")
      file_.fail(in_words(element) + ": type " + in_quotes(type) + " is not read (hinge, slide, ball and free are)");
    out.axis = frame.linear() * file_.vector(at(a, "axis")).value_or(Vec3::UnitZ());
    if (!(out.axis.norm() > 0)) file_.fail(in_words(element) + ": its axis has no length");
    out.axis.normalize();
    out.anchor = frame * file_.vector(at(a, "pos")).value_or(Vec3::Zero());
    const bool is_hinge = out.kind == RigJointKind::kHinge;
    const auto value = [&](double number) { return is_hinge ? radians(number) : number; };
    out.zero = value(file_.number(at(a, "ref")).value_or(0));
    const std::vector<double> range = file_.numbers(at(a, "range"), 2, 2);
    const std::string_view limited = at(a, "limited").as_string("auto");
    const bool has_limits = limited == "true" || (limited == "auto" && auto_limits_);
    if (!range.empty() && has_limits && (is_hinge || out.kind == RigJointKind::kSlide)) {
      out.lower = value(range[0]);
      out.upper = value(range[1]);
    }
    model_.joints.push_back(std::move(out));
  }

  void read_geom(xml_node element, Index link, const std::string& around, const Affine& frame) {
    const Attributes a = attributes_of(element, around);
    const std::string mesh = at(a, "mesh").as_string(),
                      type = at(a, "type").as_string(mesh.empty() ? "sphere" : "mesh");
    const auto where = [&] { return "body " + in_quotes(model_.links[link].name) + ", " + in_words(element); };
    if (type == "plane" || type == "hfield" || type == "sdf") {
      ++skipped_["geom of type " + type];
      return;
    }
    RobotShape shape;
    const int group = static_cast<int>(file_.number(at(a, "group")).value_or(0));
    shape.is_visual = group >= 0 && group <= 2;  // those that MuJoCo's viewer shows
    shape.is_collider =
        file_.number(at(a, "contype")).value_or(1) != 0 || file_.number(at(a, "conaffinity")).value_or(1) != 0;
    shape.place = frame * place_of(a);
    shape.colour = colour_of(a);
    if (type == "mesh" || !mesh.empty()) {
      read_mesh(mesh, around, shape, where());
    } else {
      const std::vector<double> size = file_.numbers(at(a, "size"), 1, 3);
      const std::vector<double> ends = file_.numbers(at(a, "fromto"), 6, 6);
      const std::size_t needed = (type == "sphere" ? 1U : type == "capsule" || type == "cylinder" ? 2U : 3U);
      const std::size_t given = ends.empty() || type == "sphere" ? needed : 1;
      if (size.size() < given ||
          *std::min_element(size.begin(), size.begin() + static_cast<std::ptrdiff_t>(given)) <= 0)
        file_.fail(where() + ": a " + type + " needs " + std::to_string(given) + " sizes above 0");
      Vec3 half(size[0], size.size() > 1 ? size[1] : 0, size.size() > 2 ? size[2] : 0);
      if (!ends.empty() && type != "sphere") {
        const Vec3 from(ends[0], ends[1], ends[2]), to(ends[3], ends[4], ends[5]), along = from - to;
        if (!(along.norm() > 0)) file_.fail(where() + ": its fromto has no length");
        shape.place = frame * Affine(Eigen::Translation3d((from + to) / 2) *
                                     Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), along));
        const bool is_round = type == "capsule" || type == "cylinder";
        half = is_round ? Vec3(size[0], along.norm() / 2, 0) : Vec3(size[0], size[0], along.norm() / 2);
      }
      if (type == "sphere") half.setConstant(size[0]);
      if (type == "box")
        shape.kind = ShapeKind::kBox;
      else if (type == "capsule")
        shape.kind = ShapeKind::kCapsule;
      else if (type == "cylinder")
        shape.kind = ShapeKind::kCylinder;
      else if (type == "sphere" || type == "ellipsoid")
        shape.kind = ShapeKind::kEllipsoid;
      else
        file_.fail(where() + ": type " + in_quotes(type) + " is not read");
      shape.size = half;
    }
    model_.links[link].shapes.push_back(std::move(shape));
  }

  std::optional<std::array<float, 3>> colour_of(const Attributes& a) const {
    std::vector<double> rgba = file_.numbers(at(a, "rgba"), 4, 4);
    if (rgba.empty()) {
      if (const auto found = materials_.find(at(a, "material").value()); found != materials_.end())
        rgba = file_.numbers(found->second.attribute("rgba"), 4, 4);
    }
    if (rgba.empty()) return std::nullopt;
    return std::array{static_cast<float>(rgba[0]), static_cast<float>(rgba[1]), static_cast<float>(rgba[2])};
  }

  static std::string name_of_mesh(xml_node mesh) {
    const std::string name = mesh.attribute("name").value();
    std::string file = mesh.attribute("file").value();
    std::replace(file.begin(), file.end(), '\\', '/');
    return name.empty() ? std::filesystem::path(file).stem().string() : name;
  }

  // MuJoCo moves a mesh to the centre of its mass and its geom back: on the whole it stays where its file has it.
  void read_mesh(const std::string& name, const std::string& around, RobotShape& shape,
                 const std::string& where) const {
    const auto found = meshes_.find(name);
    if (found == meshes_.end()) file_.fail(where + ": there is no mesh " + in_quotes(name));
    const xml_node mesh = found->second;
    const Attributes a = attributes_of(mesh, kMainClass);
    (void)around;
    shape.is_hull = true;
    shape.size = file_.vector(at(a, "scale")).value_or(Vec3::Ones());
    const Vec3 moved = file_.vector(at(a, "refpos")).value_or(Vec3::Zero());
    const std::vector<double> q = file_.numbers(at(a, "refquat"), 4, 4);
    const Eigen::Quaterniond turned =
        q.empty() ? Eigen::Quaterniond::Identity() : Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized();
    shape.place = shape.place * Affine(turned.inverse() * Eigen::Translation3d(-moved));
    if (const auto vertices = at(a, "vertex")) {
      read_inline(vertices, at(a, "face"), shape.mesh, where);
      return;
    }
    std::string file = at(a, "file").value();
    if (!mesh_folder_.empty()) file = mesh_folder_ + "/" + file;
    const NamedFile on_disk = named_file(folder_, file);
    if (!on_disk.is_there)
      file_.fail(where + ": needs the file " + in_quotes(file) + ", which " + on_disk.what_is_wrong());
    shape.file = on_disk.path;
  }

  void read_inline(pugi::xml_attribute vertices, pugi::xml_attribute faces, Mesh& mesh,
                   const std::string& where) const {
    constexpr std::size_t kNumbersMax = 100'000'000;
    const std::vector<double> numbers = file_.numbers(vertices, 0, kNumbersMax),
                              corners = file_.numbers(faces, 0, kNumbersMax);
    if (corners.empty()) file_.fail(where + ": a mesh of vertices without faces is not read");
    for (std::size_t i = 0; i + 2 < numbers.size(); i += 3)
      mesh.positions.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
    for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
      Triangle t;
      for (std::size_t k = 0; k < 3; ++k) {
        if (!(corners[i + k] >= 0) || corners[i + k] >= static_cast<double>(mesh.positions.size()))
          file_.fail(where + ": a face of its mesh has a vertex that is not there");
        t[k] = static_cast<Index>(corners[i + k]);
      }
      mesh.triangles.push_back(t);
    }
  }

  Index link_named(xml_node exclude, const char* which) const {
    const std::string name = exclude.attribute(which).value();
    const auto found = number_.find(name);
    if (found == number_.end()) file_.fail("excludes the body " + in_quotes(name) + ", which is not there");
    return found->second;
  }

  // An equality of two joints is a mimic where it is linear.
  void read_mimic(xml_node equality) {
    const auto joint = [&](const char* which) {
      const std::string name = equality.attribute(which).value();
      const auto found = std::find_if(model_.joints.begin(), model_.joints.end(),
                                      [&](const RigJoint& one) { return one.name == name; });
      if (found == model_.joints.end() && !name.empty())
        file_.fail("an equality is about the joint " + in_quotes(name) + ", which is not there");
      return static_cast<int>(found - model_.joints.begin());
    };
    const std::vector<double> c = file_.numbers(equality.attribute("polycoef"), 1, 5);
    const bool is_linear = c.size() < 3 || std::all_of(c.begin() + 2, c.end(), [](double one) { return one == 0; });
    if (!equality.attribute("joint2") || !is_linear || !equality.attribute("active").as_bool(true)) {
      ++skipped_["equality of joints"];
      return;
    }
    const int follower = joint("joint1"), leader = joint("joint2");
    if (follower == static_cast<int>(model_.joints.size()) || leader == follower) return;
    RigJoint& one = model_.joints[static_cast<std::size_t>(follower)];
    const RigJoint& two = model_.joints[static_cast<std::size_t>(leader)];
    one.mimic = leader;
    one.multiplier = c.size() > 1 ? c[1] : 1;
    one.offset = one.zero + (c.empty() ? 0 : c[0]) - one.multiplier * two.zero;
  }

  std::filesystem::path path_, folder_;
  XmlFile file_;
  RobotModel model_;
  std::set<std::filesystem::path> included_;
  std::map<std::string, std::map<std::string, Attributes>> classes_;
  std::map<std::string, xml_node> meshes_, materials_;
  std::map<std::string, Index> number_{{"world", 0}};  // of bodies by name
  std::map<std::string, int> skipped_;
  std::string euler_ = "xyz", mesh_folder_;
  bool is_degrees_ = true, auto_limits_ = true;
};

}  // namespace

RobotModel read_mjcf(const std::filesystem::path& path) { return MjcfReader(path).run(); }

}  // namespace spherechain::baker

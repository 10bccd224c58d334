// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <map>
#include <set>

#include "baker/import/robot_joints.h"
#include "baker/import/robot_model.h"
#include "baker/import/xml_file.h"
#include "baker/mesh/error.h"
#include "spherechain/asset.h"

namespace spherechain::baker {
namespace {

RobotModel read_model(const std::filesystem::path& path) {
  return xml_root_name(path) == "mujoco" ? read_mjcf(path) : read_urdf(path);
}

// Meshes that several links may share, each read once.
class MeshFiles {
 public:
  const Mesh& read(const std::filesystem::path& path) {
    const auto [entry, is_new] = meshes_.try_emplace(path);
    if (is_new) {
      ImportOptions options;
      options.keep_axes = true;
      SourceMesh source = read_with_assimp(path, options);
      entry->second = {std::move(source.positions), std::move(source.triangles)};
    }
    return entry->second;
  }

 private:
  std::map<std::filesystem::path, Mesh> meshes_;
};

// The number of the bone that each link moves with, by the topmost link that no joint moves apart from it.
std::vector<Index> groups_of(const RobotModel& model) {
  std::vector<char> is_moved(model.links.size(), 0);
  for (const RigJoint& joint : model.joints) is_moved[joint.node] = 1;
  std::vector<Index> out;
  for (Index link = 0; link < model.links.size(); ++link) {
    const int parent = model.links[link].parent;
    out.push_back(parent < 0 || is_moved[link] != 0 ? link : out[static_cast<std::size_t>(parent)]);
  }
  return out;
}

class RobotBuilder {
 public:
  RobotBuilder(const RobotModel& model, std::string name) : model_(model), name_(std::move(name)) {}

  SourceMesh run(bool wants_look) {
    out_.importer = "robot";
    out_.up_hint = Vec3::UnitZ();
    add_nodes();
    add_bones();
    for (Index link = 0; link < model_.links.size(); ++link) add_meshes(link);
    if (out_.triangles.empty()) throw Error(ExitCode::kFile, name_ + ": no link has a mesh or another geometry");
    exclude_pairs();
    if (!wants_look) out_.look = {};
    return std::move(out_);
  }

 private:
  void add_nodes() {
    SourceRig& rig = out_.rig;
    rig.robot.is_robot = true;
    rig.robot.name = model_.name;
    rig.robot.joints = model_.joints;
    for (const RobotLink& link : model_.links) {
      Node node;
      node.name = link.name;
      node.parent = link.parent;
      rig.nodes.push_back(node);
      rig.robot.base.push_back(link.base);
    }
    place_at_rest(rig, name_);
    world_ = world_of(rig.nodes);
    const auto free = std::find_if(model_.joints.begin(), model_.joints.end(),
                                   [](const RigJoint& joint) { return joint.kind == RigJointKind::kFree; });
    rig.robot.root = free == model_.joints.end() ? 0 : free->node;
  }

  // A bone belongs to the first link of its group that has a geometry.
  void add_bones() {
    const std::vector<Index> group = groups_of(model_);
    std::map<Index, Index> bone_of_group;
    for (Index link = 0; link < model_.links.size(); ++link) {
      if (model_.links[link].shapes.empty()) continue;
      const auto [bone, is_new] = bone_of_group.try_emplace(group[link], static_cast<Index>(out_.rig.bones.size()));
      if (is_new) out_.rig.bones.push_back({link, world_[link].inverse()});
    }
    for (Index link = 0; link < group.size(); ++link) {
      const auto found = bone_of_group.find(group[link]);
      bone_of_.push_back(found == bone_of_group.end() ? kNoIndex : found->second);
      out_.rig.robot.bone_of.push_back(model_.links[link].shapes.empty() ? kNoIndex : bone_of_.back());
    }
    group_ = group;
  }

  Mesh mesh_of(const RobotShape& shape) {
    RobotShape read = shape;
    if (!shape.file.empty()) read.mesh = files_.read(shape.file);
    return triangles_of(read);
  }

  void add_meshes(Index link) {
    const std::vector<RobotShape>& shapes = model_.links[link].shapes;
    const bool has_visual =
        std::any_of(shapes.begin(), shapes.end(), [](const RobotShape& shape) { return shape.is_visual; });
    for (const RobotShape& shape : shapes) {
      Mesh mesh = mesh_of(shape);
      const std::vector<float> in_file = pack(mesh.positions);
      for (Vec3& p : mesh.positions) p = world_[link] * shape.place * p;
      if (has_visual ? shape.is_visual : shape.is_collider) add_skin(link, shape, mesh, in_file);
      if (shape.is_collider)
        out_.rig.robot.colliders.push_back(
            {bone_of_[link], shape.kind != ShapeKind::kMesh || shape.is_hull, std::move(mesh)});
    }
  }

  void add_skin(Index link, const RobotShape& shape, const Mesh& mesh, const std::vector<float>& in_file) {
    const auto base = static_cast<Index>(out_.positions.size());
    out_.buffers.push_back({static_cast<Index>(out_.meshes), 0, base, static_cast<Index>(mesh.positions.size()),
                            sc_hash_positions(in_file.data(), mesh.positions.size(), 3 * sizeof(float)),
                            static_cast<Index>(mesh.triangles.size()), model_.links[link].name});
    ++out_.meshes;
    VertexWeights whole;
    whole.joint[0] = bone_of_[link];
    whole.weight[0] = 1;
    out_.positions.insert(out_.positions.end(), mesh.positions.begin(), mesh.positions.end());
    out_.rig.weights.resize(out_.positions.size(), whole);
    for (const Triangle& t : mesh.triangles) out_.triangles.push_back({base + t[0], base + t[1], base + t[2]});
    SkinMaterial material;
    constexpr std::array<float, 3> kGrey{0.7F, 0.7F, 0.7F};
    material.colour = shape.colour.value_or(kGrey);
    out_.look.uvs.resize(out_.positions.size(), {0, 0});
    out_.look.material_of.resize(out_.triangles.size(), static_cast<std::uint16_t>(out_.look.materials.size()));
    out_.look.materials.push_back(material);
  }

  // Neighbours are left out as planners do: a joint's two sides touch in it.
  void exclude_pairs() {
    std::set<std::array<Index, 2>> pairs;
    const auto add = [&](Index a, Index b) {
      if (a != kNoIndex && b != kNoIndex && a != b) pairs.insert({std::min(a, b), std::max(a, b)});
    };
    for (Index link = 0; link < model_.links.size(); ++link) {
      // The nearest group above that has a bone.
      int above = model_.links[group_[link]].parent;
      while (above >= 0 && bone_of_[static_cast<std::size_t>(above)] == kNoIndex)
        above = model_.links[static_cast<std::size_t>(above)].parent;
      if (above >= 0) add(bone_of_[link], bone_of_[static_cast<std::size_t>(above)]);
    }
    for (const auto& [a, b] : model_.excluded) add(bone_of_[a], bone_of_[b]);
    out_.rig.robot.excluded.assign(pairs.begin(), pairs.end());
  }

  const RobotModel& model_;
  std::string name_;
  SourceMesh out_;
  MeshFiles files_;
  std::vector<Affine> world_;
  std::vector<Index> group_, bone_of_;  // of each link
};

}  // namespace

bool is_robot(const std::filesystem::path& path) {
  const std::string root = xml_root_name(path);
  return root == "robot" || root == "mujoco";
}

void refuse_robot(const std::filesystem::path& path) {
  if (!is_robot(path)) return;
  throw Error(ExitCode::kFile,
              path.string() + ": is a robot, which no glTF is written of (bake, play and check take robots)");
}

SourceMesh read_robot(const std::filesystem::path& path, const ImportOptions& options) {
  const RobotModel model = read_model(path);
  return RobotBuilder(model, path.string()).run(options.look);
}

std::vector<std::string> files_of_robot(const std::filesystem::path& path) {
  std::set<std::string> out;
  const RobotModel model = read_model(path);
  for (const std::filesystem::path& file : model.included) out.insert(file.string());
  for (const RobotLink& link : model.links) {
    for (const RobotShape& shape : link.shapes) {
      if (!shape.file.empty()) out.insert(shape.file.string());
    }
  }
  return {out.begin(), out.end()};
}

}  // namespace spherechain::baker

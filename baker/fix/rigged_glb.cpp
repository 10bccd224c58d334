// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/rigged_glb.h"

#include <nlohmann/json.hpp>
#include <set>

#include "baker/import/glb_file.h"
#include "baker/import/rest_nodes.h"
#include "baker/layers/skin.h"
#include "baker/mesh/error.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kJointsOfVertex = 4;  // as bone heat gives them

ordered_json list_of(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

class Rigged {
 public:
  Rigged(GlbFile glb, const std::string& file, const Bake& baked)
      : glb_(std::move(glb)), file_(file), baked_(baked), places_(glb_.json), nodes_of_mesh_(find_nodes()) {}

  std::string bytes() {
    const std::vector<PrimitiveRun> runs = primitive_runs(baked_.character, glb_.json);
    add_joints(runs);
    std::size_t r = 0;
    std::set<std::size_t> skinned;
    for (const SourceBuffer& buffer : baked_.character.buffers) {
      if (buffer.triangle_count == 0) continue;  // a primitive without triangles has no run, or an empty one
      while (runs[r].count == 0) ++r;
      if (skinned.insert(runs[r].mesh).second) add_skin(runs[r].mesh);
      add_weights(buffer, glb_.json["meshes"][runs[r].mesh]["primitives"][runs[r].primitive]);
      ++r;
    }
    return glb_.bytes();
  }

 private:
  std::vector<std::vector<std::size_t>> find_nodes() const {
    std::vector<std::vector<std::size_t>> out(entry_of(glb_.json, "meshes").size());
    const ordered_json& nodes = entry_of(glb_.json, "nodes");
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      if (const ordered_json& mesh = entry_of(nodes[n], "mesh"); !mesh.is_null())
        out.at(mesh.get<std::size_t>()).push_back(n);
    }
    return out;
  }
  std::size_t node_of(std::size_t mesh) const {
    if (nodes_of_mesh_[mesh].size() == 1) return nodes_of_mesh_[mesh][0];
    throw Error(ExitCode::kFile,
                file_ + ": has no bones, and shows a mesh at several places (join them, or give it a skeleton)");
  }

  // A glTF's vertices at rest are those of its scene; what assimp read is in the file's own axes and units, which the
  // nodes of its meshes turn and scale.
  void add_joints(const std::vector<PrimitiveRun>& runs) {
    ordered_json& nodes = glb_.json["nodes"];
    first_ = nodes.size();
    if (baked_.character.report.importer != "tinygltf")
      to_scene_ = places_.world(static_cast<int>(node_of(runs[0].mesh)));
    for (const Joint& joint : baked_.joints) {
      ordered_json node{{"name", joint.name}};
      if (joint.parent < 0) {
        const Eigen::Affine3d at = Eigen::Affine3d(to_scene_) * Eigen::Translation3d(joint.position);
        node["matrix"] = std::vector<double>(at.data(), at.data() + 16);
        glb_.json["scenes"][glb_.json.value("scene", std::size_t{0})]["nodes"].push_back(nodes.size());
      } else {
        const auto parent = static_cast<std::size_t>(joint.parent);
        node["translation"] = list_of(joint.position - baked_.joints[parent].position);
        nodes[first_ + parent]["children"].push_back(nodes.size());
      }
      nodes.push_back(std::move(node));
    }
    add_ends();
  }

  // Where the last bones end. Without these nodes, hands and feet of a recording would turn from another direction.
  void add_ends() {
    ordered_json& nodes = glb_.json["nodes"];
    for (std::size_t j = 0; j < baked_.joints.size(); ++j) {
      const Joint& joint = baked_.joints[j];
      if (nodes[first_ + j].contains("children")) continue;
      nodes[first_ + j]["children"] = {nodes.size()};
      nodes.push_back({{"name", joint.name + "_end"}, {"translation", list_of(joint.tail - joint.position)}});
    }
  }

  void add_skin(std::size_t mesh) {
    const std::size_t node = node_of(mesh);
    const Eigen::Affine3d to_rest = Eigen::Affine3d(to_scene_.inverse() * places_.world(static_cast<int>(node)));
    ordered_json joints;
    std::vector<float> binds;
    for (const Joint& joint : baked_.joints) {
      joints.push_back(first_ + joints.size());
      const Eigen::Matrix4d bind = (Eigen::Translation3d(-joint.position) * to_rest).matrix();
      for (const double x : bind.reshaped()) binds.push_back(static_cast<float>(x));
    }
    const std::size_t accessor = glb_.add_accessor(binds, "MAT4");
    glb_.json["skins"].push_back({{"joints", std::move(joints)}, {"inverseBindMatrices", accessor}});
    glb_.json["nodes"][node]["skin"] = glb_.json["skins"].size() - 1;
  }

  void add_weights(const SourceBuffer& buffer, ordered_json& primitive) {
    std::vector<std::uint16_t> joints;
    std::vector<float> weights;
    for (Index v = buffer.first_vertex; v < buffer.first_vertex + buffer.vertex_count; ++v) {
      const VertexWeights& of_it = baked_.rig_weights[v];
      for (std::size_t k = 0; k < kJointsOfVertex; ++k) {
        joints.push_back(static_cast<std::uint16_t>(of_it.joint[k]));
        weights.push_back(static_cast<float>(of_it.weight[k]));
      }
    }
    const std::size_t accessor = glb_.add_accessor(joints, "VEC4");
    primitive["attributes"]["JOINTS_0"] = accessor;
    primitive["attributes"]["WEIGHTS_0"] = glb_.add_accessor(weights, "VEC4");
  }

  GlbFile glb_;
  const std::string& file_;
  const Bake& baked_;
  RestNodes places_;
  std::vector<std::vector<std::size_t>> nodes_of_mesh_;
  Affine to_scene_ = Affine::Identity();
  std::size_t first_ = 0;  // joint's node
};

}  // namespace

std::string rigged_glb(const std::string& bytes, const std::string& file, const Bake& baked) {
  if (baked.joints.empty())
    throw Error(ExitCode::kFile, file + ": has no bones, and is no biped, which gets an automatic rig");
  return Rigged(glb_of_bytes(bytes, file), file, baked).bytes();
}

}  // namespace spherechain::baker

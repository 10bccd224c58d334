// SPDX-License-Identifier: GPL-3.0-or-later
#include "gltf_reference.h"

#include "temporary_folder.h"

using Eigen::Affine3d;
using Eigen::Vector3d;
using nlohmann::json;
using namespace spherechain::baker;

namespace {

template <typename T>
std::vector<T> values(const Glb& glb, const json& index) {
  const json& accessor = glb.json["accessors"][index.get<std::size_t>()];
  const json& view = glb.json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
  std::vector<T> out(accessor["count"].get<std::size_t>() * Glb::width(accessor["type"]));
  std::memcpy(out.data(), glb.binary.data() + view["byteOffset"].get<std::size_t>(), out.size() * sizeof(T));
  return out;
}

Affine3d local(const json& node) {
  Affine3d out = Affine3d::Identity();
  if (node.contains("matrix")) {
    const std::vector<double> m = node["matrix"];
    for (int i = 0; i < 16; ++i) out.matrix()(i % 4, i / 4) = m[static_cast<std::size_t>(i)];
    return out;
  }
  const std::vector<double> t = node.value("translation", std::vector<double>{0, 0, 0}),
                            r = node.value("rotation", std::vector<double>{0, 0, 0, 1}),
                            s = node.value("scale", std::vector<double>{1, 1, 1});
  out.translate(Vector3d(t[0], t[1], t[2]));
  out.rotate(Eigen::Quaterniond(r[3], r[0], r[1], r[2]));
  out.scale(Vector3d(s[0], s[1], s[2]));
  return out;
}

Affine3d world(const json& nodes, std::size_t n) {
  for (std::size_t parent = 0; parent < nodes.size(); ++parent) {
    for (const json& child : nodes[parent].value("children", json::array())) {
      if (child == n) return world(nodes, parent) * local(nodes[n]);
    }
  }
  return local(nodes[n]);
}

}  // namespace

SourceMesh read(const Glb& glb) {
  const TemporaryFolder folder;
  return read_with_tinygltf(folder.write("a.glb", glb.bytes()), {});
}

std::vector<Vector3d> world_positions(const Glb& glb) {
  const json& nodes = glb.json["nodes"];
  std::vector<Vector3d> out;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    if (!nodes[n].contains("mesh")) continue;
    for (const json& primitive : glb.json["meshes"][nodes[n]["mesh"].get<std::size_t>()]["primitives"]) {
      const json& attributes = primitive["attributes"];
      const std::vector<float> p = values<float>(glb, attributes["POSITION"]);
      for (std::size_t v = 0; v < p.size() / 3; ++v) {
        const Vector3d position(p[3 * v], p[3 * v + 1], p[3 * v + 2]);
        if (!nodes[n].contains("skin")) {
          out.push_back(world(nodes, n) * position);
          continue;
        }
        const json& skin = glb.json["skins"][nodes[n]["skin"].get<std::size_t>()];
        const auto joints = values<std::uint16_t>(glb, attributes["JOINTS_0"]);
        const auto weights = values<float>(glb, attributes["WEIGHTS_0"]);
        Vector3d sum = Vector3d::Zero();
        for (std::size_t k = 4 * v; k < 4 * v + 4; ++k) {
          Affine3d inverse_bind = Affine3d::Identity();
          if (skin.contains("inverseBindMatrices")) {
            const std::vector<float> m = values<float>(glb, skin["inverseBindMatrices"]);
            for (int i = 0; i < 16; ++i) {
              inverse_bind.matrix()(i % 4, i / 4) =
                  static_cast<double>(m[16 * joints[k] + static_cast<std::size_t>(i)]);
            }
          }
          const auto joint = skin["joints"][joints[k]].get<std::size_t>();
          sum += static_cast<double>(weights[k]) * (world(nodes, joint) * inverse_bind * position);
        }
        out.push_back(sum);
      }
    }
  }
  return out;
}

std::vector<Vector3d> world_positions(const SourceMesh& mesh, const std::vector<Affine>& world) {
  std::vector<Vector3d> out;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    if (mesh.rig.weights.empty()) {
      out.push_back(mesh.positions[v]);
      continue;
    }
    Vector3d sum = Vector3d::Zero();
    for (std::size_t k = 0; k < kMaxInfluences; ++k) {
      const Bone& bone = mesh.rig.bones[mesh.rig.weights[v].joint[k]];
      sum += mesh.rig.weights[v].weight[k] * (world[bone.node] * bone.inverse_bind * mesh.positions[v]);
    }
    out.push_back(sum);
  }
  return out;
}

std::vector<float> box_corners(float x, float y, float z) {
  std::vector<float> out;
  for (int corner = 0; corner < 8; ++corner) {
    out.push_back(x + (corner & 1 ? 1.0F : -1.0F));
    out.push_back(y + (corner & 2 ? 1.0F : -1.0F));
    out.push_back(z + (corner & 4 ? 1.0F : -1.0F));
  }
  return out;
}

std::vector<std::uint16_t> box_triangles() {
  return {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
}

Glb two_boxes() {
  Glb glb;
  std::vector<float> positions = box_corners(0, 1, 0);
  const std::vector<float> upper = box_corners(0, 3, 0);
  positions.insert(positions.end(), upper.begin(), upper.end());
  std::vector<std::uint16_t> triangles = box_triangles(), joints;
  for (std::size_t i = 0; i < 36; ++i) triangles.push_back(static_cast<std::uint16_t>(triangles[i] + 8));
  std::vector<float> weights;
  for (int v = 0; v < 16; ++v) {
    // Corners at y = 2 belong to both joints, unevenly.
    const float y = positions[static_cast<std::size_t>(3 * v + 1)];
    const float low = y < 1 ? 1.0F : y > 3 ? 0.0F : 0.625F;
    joints.insert(joints.end(), {0, 1, 0, 0});
    weights.insert(weights.end(), {low, 1 - low, 0, 0});
  }
  glb.json["meshes"] = {{{"name", "column"},
                         {"primitives",
                          {{{"attributes",
                             {{"POSITION", glb.accessor(positions, "VEC3")},
                              {"JOINTS_0", glb.accessor(joints, "VEC4")},
                              {"WEIGHTS_0", glb.accessor(weights, "VEC4")}}},
                            {"indices", glb.accessor(triangles, "SCALAR")}}}}}};
  // Bound with the joints at y = 0 and 2; at rest the upper one leans.
  const std::vector<float> inverse_bind = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,  0, 1,
                                           1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -2, 0, 1};
  glb.json["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", glb.accessor(inverse_bind, "MAT4")}}};
  glb.json["nodes"] = {{{"name", "body"}, {"mesh", 0}, {"skin", 0}, {"translation", {5, 6, 7}}},
                       {{"name", "hips"}, {"children", {2}}},
                       {{"name", "chest"}, {"translation", {0, 2, 0}}, {"rotation", {0, 0, 0.6, 0.8}}},
                       {{"name", "armature"}, {"children", {1}}}};
  glb.json["scenes"] = {{{"nodes", {0, 3}}}};
  return glb;
}

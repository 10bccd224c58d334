// SPDX-License-Identifier: GPL-3.0-or-later
// Assimp's own exporter is not used: its users report that it drops morph targets (assimp 5352), and that FBX clips
// come out at another speed or broken (4206, 4197, 5495).
#include "baker/import/assimp_glb.h"

#include <assimp/material.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "baker/import/glb_file.h"
#include "baker/import/srgb.h"
#include "baker/mesh/decompose.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

constexpr int kVertices = 34962, kCorners = 34963;  // targets of buffer views

void put(std::vector<float>& out, const auto& values) {
  for (const double x : values) out.push_back(static_cast<float>(x));
}

ordered_json list_of(const auto& values) {
  ordered_json out = ordered_json::array();
  for (const double x : values) out.push_back(x);
  return out;
}

class GlbOfScene {
 public:
  GlbOfScene(const aiScene& scene, const AssimpScene& flat, const SourceMesh& source)
      : scene_(scene), flat_(flat), source_(source), rig_(source.rig) {}

  std::string bytes() {
    out_.json = {{"asset", {{"version", "2.0"}, {"generator", "spherechain"}}}, {"scene", 0}};
    out_.json["scenes"] = ordered_json::array({{{"nodes", ordered_json::array()}}});
    add_nodes();
    add_materials();
    if (!rig_.bones.empty()) add_skin();
    add_meshes();
    for (const Clip& clip : rig_.clips) add_clip(clip);
    return out_.bytes();
  }

 private:
  std::size_t add_node(ordered_json node) {
    out_.json["nodes"].push_back(std::move(node));
    return out_.json["nodes"].size() - 1;
  }
  void add_child(std::size_t parent, std::size_t child) { out_.json["nodes"][parent]["children"].push_back(child); }
  void add_root(std::size_t node) { out_.json["scenes"][0]["nodes"].push_back(node); }

  void add_nodes() {
    std::set<Index> animated;
    for (const Clip& clip : rig_.clips) {
      for (const Channel& channel : clip.channels) {
        if (channel.path != ChannelPath::kMorphWeight) animated.insert(channel.target);
      }
    }
    for (Index n = 0; n < flat_.nodes.size(); ++n) {
      ordered_json node{{"name", flat_.nodes[n].name}};
      put_transform(flat_.nodes[n], animated.count(n) > 0, node);
      add_node(std::move(node));
    }
    // Metres, Y up.
    Node top;
    top.name = "metres_y_up";
    top.local.linear() = source_.metres_per_unit * turn_between(source_.up_hint, Vec3::UnitY()).toRotationMatrix();
    decompose(top);
    if (!top.local.matrix().isApprox(Affine::Identity().matrix())) {
      ordered_json node{{"name", top.name}};
      put_transform(top, true, node);
      add_root(top_ = add_node(std::move(node)));
    }
    for (Index n = 0; n < flat_.nodes.size(); ++n) {
      const int parent = flat_.nodes[n].parent;
      if (parent >= 0)
        add_child(static_cast<std::size_t>(parent), n);
      else if (top_ > 0)
        add_child(top_, n);
      else
        add_root(n);
    }
  }

  // A transform with shear cannot be split: it stays a matrix, which no clip can animate.
  static void put_transform(const Node& node, bool is_animated, ordered_json& out) {
    Affine parts = Affine::Identity();
    parts.linear() = node.rotation.toRotationMatrix() * node.scale.asDiagonal();
    parts.translation() = node.translation;
    constexpr double kSame = 1e-6;  // singles
    if (!is_animated && !parts.linear().isApprox(node.local.linear(), kSame)) {
      const Eigen::Matrix4d matrix = Eigen::Affine3d(node.local).matrix();
      out["matrix"] = list_of(matrix.reshaped());
      return;
    }
    if (!node.translation.isZero(0)) out["translation"] = list_of(node.translation);
    const Eigen::Vector4d rotation = node.rotation.coeffs();
    if (rotation != Eigen::Vector4d(0, 0, 0, 1)) out["rotation"] = list_of(rotation);
    if (node.scale != Vec3::Ones()) out["scale"] = list_of(node.scale);
  }

  void add_materials() {
    const SourceLook& look = source_.look;
    std::map<std::int32_t, std::size_t> textures;
    for (std::size_t m = 0; m < look.materials.size(); ++m) {
      const SkinMaterial& material = look.materials[m];
      const aiMaterial& from = *scene_.mMaterials[m];
      ordered_json pbr{{"metallicFactor", 0}}, colour = ordered_json::array();
      for (const float c : material.colour) colour.push_back(to_linear(c));
      colour.push_back(1);
      if (const auto texture = texture_of(material.picture, textures); texture.is_null())
        pbr["baseColorFactor"] = std::move(colour);
      else
        pbr["baseColorTexture"] = {{"index", texture}};
      ordered_json out{{"name", from.GetName().C_Str()}, {"pbrMetallicRoughness", std::move(pbr)}};
      int two_sided = 0;
      if (from.Get(AI_MATKEY_TWOSIDED, two_sided) == aiReturn_SUCCESS && two_sided != 0) out["doubleSided"] = true;
      out_.json["materials"].push_back(std::move(out));
    }
  }

  // glTF has PNG and JPEG only.
  ordered_json texture_of(std::int32_t picture, std::map<std::int32_t, std::size_t>& textures) {
    if (picture < 0) return nullptr;
    if (const auto known = textures.find(picture); known != textures.end()) return known->second;
    std::string bytes = source_.look.pictures[static_cast<std::size_t>(picture)];
    if (type_of_picture(bytes) != "image/png" && type_of_picture(bytes) != "image/jpeg") bytes = png_of_picture(bytes);
    if (bytes.empty()) return nullptr;
    out_.json["images"].push_back(
        {{"mimeType", type_of_picture(bytes)}, {"bufferView", out_.add_view(bytes.data(), bytes.size())}});
    out_.json["textures"].push_back({{"source", out_.json["images"].size() - 1}});
    return textures[picture] = out_.json["textures"].size() - 1;
  }

  // One for all meshes. A skin has each of its joints once: a node that is bound twice gets a child that moves with it.
  void add_skin() {
    std::set<Index> taken;
    ordered_json joints = ordered_json::array();
    std::vector<float> inverse_binds;
    for (const Bone& bone : rig_.bones) {
      std::size_t joint = bone.node;
      if (!taken.insert(bone.node).second) {
        joint = add_node({{"name", flat_.nodes[bone.node].name + "_" + std::to_string(joints.size())}});
        add_child(bone.node, joint);
      }
      joints.push_back(joint);
      const Eigen::Matrix4d matrix = Eigen::Affine3d(bone.inverse_bind).matrix();
      put(inverse_binds, matrix.reshaped());
    }
    const std::size_t matrices = out_.add_accessor(inverse_binds, "MAT4");
    out_.json["skins"].push_back({{"joints", std::move(joints)}, {"inverseBindMatrices", matrices}});
  }

  // The meshes of a node are one, but for those with morph targets, which have to be alike in a mesh.
  void add_meshes() {
    std::size_t triangle = 0;
    int mesh_of = -1;
    for (const MeshInstance& instance : flat_.instances) {
      const Index end = instance.first_vertex + instance.mesh->mNumVertices;
      std::vector<Index> corners;
      for (; triangle < source_.triangles.size() && source_.triangles[triangle][0] < end; ++triangle) {
        for (const Index v : source_.triangles[triangle]) corners.push_back(v - instance.first_vertex);
      }
      if (corners.empty()) continue;
      const bool has_morphs = instance.mesh->mNumAnimMeshes > 0;
      if (has_morphs || mesh_of != static_cast<int>(instance.node)) add_mesh(instance);
      mesh_of = has_morphs ? -1 : static_cast<int>(instance.node);
      out_.json["meshes"].back()["primitives"].push_back(primitive(instance, corners));
      if (has_morphs) name_morphs(instance);
    }
  }

  // Its node stands apart: a skin places a mesh, and else the vertices are in their place.
  void add_mesh(const MeshInstance& instance) {
    const std::string own = instance.mesh->mName.C_Str();
    const std::string& name = flat_.nodes[instance.node].name;
    ordered_json mesh{{"name", own.empty() ? name : own}, {"primitives", ordered_json::array()}};
    out_.json["meshes"].push_back(std::move(mesh));
    ordered_json node{{"name", name}, {"mesh", out_.json["meshes"].size() - 1}};
    if (!rig_.bones.empty()) node["skin"] = 0;
    const std::size_t number = add_node(std::move(node));
    if (top_ > 0 && rig_.bones.empty())
      add_child(top_, number);
    else
      add_root(number);
    if (instance.mesh->mNumAnimMeshes > 0) node_of_morph_[instance.first_morph] = number;
  }

  ordered_json primitive(const MeshInstance& instance, const std::vector<Index>& corners) {
    const aiMesh& mesh = *instance.mesh;
    const std::size_t first = instance.first_vertex, end = first + mesh.mNumVertices;
    std::vector<float> positions, normals, uvs;
    for (std::size_t v = first; v < end; ++v) put(positions, source_.positions[v]);
    ordered_json attributes{{"POSITION", out_.add_accessor(positions, "VEC3", kVertices, true)}};
    if (mesh.HasNormals()) {
      const Eigen::Matrix3d turn = instance.placement.linear().inverse().transpose();
      for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
        const Vec3 normal = (turn * to_vec3(mesh.mNormals[v])).normalized();
        put(normals, normal.allFinite() && !normal.isZero(0) ? normal : Vec3(Vec3::UnitY()));
      }
      attributes["NORMAL"] = out_.add_accessor(normals, "VEC3", kVertices);
    }
    if (mesh.HasTextureCoords(0)) {
      for (std::size_t v = first; v < end; ++v) put(uvs, source_.look.uvs[v]);
      attributes["TEXCOORD_0"] = out_.add_accessor(uvs, "VEC2", kVertices);
    }
    if (!rig_.bones.empty()) add_weights(first, end, attributes);
    ordered_json out{{"attributes", std::move(attributes)},
                     {"indices", out_.add_accessor(corners, "SCALAR", kCorners)}};
    if (mesh.mMaterialIndex < source_.look.materials.size()) out["material"] = mesh.mMaterialIndex;
    for (unsigned m = 0; m < mesh.mNumAnimMeshes; ++m) {
      const Morph& morph = rig_.morphs[instance.first_morph + m];
      std::vector<float> deltas(positions.size(), 0.0F);
      for (std::size_t i = 0; i < morph.vertices.size(); ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
          deltas[3 * (morph.vertices[i] - first) + k] = static_cast<float>(morph.deltas[i][static_cast<int>(k)]);
        }
      }
      out["targets"].push_back({{"POSITION", out_.add_accessor(deltas, "VEC3", kVertices, true)}});
    }
    return out;
  }

  void add_weights(std::size_t first, std::size_t end, ordered_json& attributes) {
    constexpr std::size_t kSet = 4;
    for (std::size_t set = 0; set < kMaxInfluences / kSet; ++set) {
      std::vector<std::uint16_t> joints;
      std::vector<float> weights;
      for (std::size_t v = first; v < end; ++v) {
        for (std::size_t k = kSet * set; k < kSet * (set + 1); ++k) {
          const float weight = static_cast<float>(rig_.weights[v].weight[k]);
          joints.push_back(weight > 0 ? static_cast<std::uint16_t>(rig_.weights[v].joint[k]) : std::uint16_t{0});
          weights.push_back(weight);
        }
      }
      if (set > 0 && std::all_of(weights.begin(), weights.end(), [](float w) { return w == 0; })) return;
      attributes["JOINTS_" + std::to_string(set)] = out_.add_accessor(joints, "VEC4", kVertices);
      attributes["WEIGHTS_" + std::to_string(set)] = out_.add_accessor(weights, "VEC4", kVertices);
    }
  }

  void name_morphs(const MeshInstance& instance) {
    ordered_json &mesh = out_.json["meshes"].back(), names = ordered_json::array();
    for (unsigned m = 0; m < instance.mesh->mNumAnimMeshes; ++m) {
      const Morph& morph = rig_.morphs[instance.first_morph + m];
      names.push_back(morph.name);
      mesh["weights"].push_back(morph.rest_weight);
    }
    mesh["extras"]["targetNames"] = std::move(names);
  }

  void add_clip(const Clip& clip) {
    ordered_json out{{"name", clip.name}, {"samplers", ordered_json::array()}, {"channels", ordered_json::array()}};
    const auto add = [&](std::vector<float> times, const std::vector<float>& values, const char* type, std::size_t node,
                         const char* path) {
      out["samplers"].push_back({{"input", out_.add_accessor(times, "SCALAR", 0, true)},
                                 {"output", out_.add_accessor(values, type)},
                                 {"interpolation", "LINEAR"}});
      out["channels"].push_back(
          {{"sampler", out["samplers"].size() - 1}, {"target", {{"node", node}, {"path", path}}}});
    };
    for (const Channel& channel : clip.channels) {
      if (channel.path == ChannelPath::kMorphWeight) continue;
      const bool turns = channel.path == ChannelPath::kRotation;
      std::vector<float> times, values;
      for (const double time : channel.times) {
        if (!times.empty() && static_cast<float>(time) <= times.back()) continue;
        times.push_back(static_cast<float>(time));
        const Eigen::Vector4d value = sample(channel, time);
        for (Eigen::Index k = 0; k < (turns ? 4 : 3); ++k) values.push_back(static_cast<float>(value[k]));
      }
      const char* path = turns ? "rotation" : channel.path == ChannelPath::kScale ? "scale" : "translation";
      add(std::move(times), values, turns ? "VEC4" : "VEC3", channel.target, path);
    }
    for (const auto& [first, node] : node_of_morph_) add_morph_weights(clip, first, node, add);
    out_.json["animations"].push_back(std::move(out));
  }

  // A track for all morph targets of a mesh: keys where one of them has one.
  void add_morph_weights(const Clip& clip, Index first, std::size_t node, const auto& add) {
    const std::size_t mesh = out_.json["nodes"][node]["mesh"];
    const std::size_t count = out_.json["meshes"][mesh]["weights"].size();
    std::vector<const Channel*> channels(count, nullptr);
    std::set<float> times;
    for (const Channel& channel : clip.channels) {
      if (channel.path != ChannelPath::kMorphWeight || channel.target < first || channel.target >= first + count)
        continue;
      channels[channel.target - first] = &channel;
      for (const double time : channel.times) times.insert(static_cast<float>(time));
    }
    if (times.empty()) return;
    std::vector<float> values;
    for (const float time : times) {
      for (std::size_t m = 0; m < count; ++m) {
        values.push_back(static_cast<float>(channels[m] == nullptr ? rig_.morphs[first + m].rest_weight
                                                                   : sample(*channels[m], double{time})[0]));
      }
    }
    add({times.begin(), times.end()}, values, "SCALAR", node, "weights");
  }

  const aiScene& scene_;
  const AssimpScene& flat_;
  const SourceMesh& source_;
  const SourceRig& rig_;
  GlbFile out_;
  std::size_t top_ = 0;                         // the node for units and axes; 0: none
  std::map<Index, std::size_t> node_of_morph_;  // of a mesh's first one
};

}  // namespace

std::string glb_of(const aiScene& scene, const AssimpScene& flat, const SourceMesh& source) {
  return GlbOfScene(scene, flat, source).bytes();
}

std::string glb_of(const SourceMesh& source) {
  aiMesh mesh;
  mesh.mNumVertices = static_cast<unsigned>(source.positions.size());
  mesh.mName = source.buffers.front().name;
  AssimpScene flat;
  flat.nodes = source.rig.nodes;
  flat.instances.push_back({&mesh, 0, 0, Affine::Identity(), Affine::Identity(), 0, 0});
  return glb_of(aiScene(), flat, source);
}

}  // namespace spherechain::baker

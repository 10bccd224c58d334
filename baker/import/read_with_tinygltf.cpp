// SPDX-License-Identifier: GPL-3.0-or-later
// glTF 2.0: the meshes of the scene, in the order of the file's nodes, and what moves them.
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "baker/import/choose_meshes.h"
#include "baker/import/gltf_clips.h"
#include "baker/import/gltf_look.h"
#include "baker/import/gltf_primitive.h"
#include "baker/import/import.h"
#include "spherechain/asset.h"

namespace spherechain::baker {
namespace {

std::string primitive_name(int mesh, std::size_t primitive) {
  return "meshes[" + std::to_string(mesh) + "].primitives[" + std::to_string(primitive) + "]";
}

// Parents come before their children.
Index top_joint(const GltfNodes& nodes, const tinygltf::Skin& skin) {
  Index top = kNoIndex;
  for (const int joint : skin.joints) top = std::min(top, nodes.of_file[at(joint)]);
  return top;
}

// The skins of the scene's meshes. The one that moves most vertices leads: its mesh space becomes the rest space.
std::vector<UsedSkin> skins_of_scene(const GltfFile& file, const GltfNodes& nodes) {
  std::map<int, std::size_t> vertices;
  std::map<int, std::vector<double>> weights;
  std::set<std::pair<int, int>> seen;  // skin, mesh
  for (std::size_t n = 0; n < file.model.nodes.size(); ++n) {
    const tinygltf::Node& node = file.model.nodes[n];
    if (!nodes.in_scene[n] || node.mesh < 0 || node.skin < 0) continue;
    std::vector<Index> joints(file.model.skins[at(node.skin)].joints.size());
    std::iota(joints.begin(), joints.end(), Index{0});
    const bool is_new = seen.emplace(node.skin, node.mesh).second;
    const std::vector<tinygltf::Primitive>& primitives = file.model.meshes[at(node.mesh)].primitives;
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      const auto position = primitives[p].attributes.find("POSITION");
      if (!is_skinned(primitives[p]) || position == primitives[p].attributes.end()) continue;
      const std::size_t count = file.model.accessors[at(position->second)].count;
      vertices[node.skin] += count;
      std::vector<double>& moved = weights[node.skin];
      moved.resize(joints.size());
      if (!is_new || count > kGltfElementsMax) continue;
      const std::string where = primitive_name(node.mesh, p);
      for (const VertexWeights& own :
           read_weights(file, primitives[p], joints, read_positions(file, primitives[p], where).size(), where)) {
        for (std::size_t k = 0; k < kMaxInfluences; ++k) moved[own.joint[k]] += own.weight[k];
      }
    }
  }
  std::vector<UsedSkin> skins;
  for (auto& [skin, moved] : weights) skins.push_back({skin, std::move(moved)});
  std::stable_sort(skins.begin(), skins.end(),
                   [&](const UsedSkin& a, const UsedSkin& b) { return vertices[a.index] > vertices[b.index]; });
  return skins;
}

// Takes out of the scene the meshes that are not read.
GltfNodes with_chosen_meshes(const GltfFile& file, GltfNodes nodes, const std::string& character) {
  std::vector<bool> is_coarse;  // with all below
  for (const Node& node : nodes.nodes) {
    const bool is_below = node.parent >= 0 && is_coarse[at(node.parent)];
    is_coarse.push_back(is_below || file.model.nodes[at(node.in_file)].extras.Has("coarse"));
  }
  std::vector<ShownMesh> meshes;
  std::vector<std::size_t> places;
  for (std::size_t n = 0; n < file.model.nodes.size(); ++n) {
    const tinygltf::Node& node = file.model.nodes[n];
    if (node.extras.Has("spherechain")) nodes.in_scene[n] = false;
    if (!nodes.in_scene[n] || node.mesh < 0) continue;
    ShownMesh mesh{nodes.of_file[n], kNoIndex, file.model.meshes[at(node.mesh)].name, {}, is_coarse[nodes.of_file[n]]};
    if (node.skin >= 0) {
      const tinygltf::Skin& skin = file.model.skins[at(node.skin)];
      mesh.skin = skin.name;
      mesh.top_joint = top_joint(nodes, skin);
    }
    meshes.push_back(std::move(mesh));
    places.push_back(n);
  }
  const std::vector<bool> chosen = choose_meshes(nodes.nodes, meshes, character, file.name);
  for (std::size_t m = 0; m < places.size(); ++m) {
    if (!chosen[m]) nodes.in_scene[places[m]] = false;
  }
  return nodes;
}

// The skin or node that moves a primitive.
struct Carrier {
  Affine to_rest;             // from the primitive's space
  const GltfSkin* skin;       // null: rigid
  std::optional<Index> bone;  // of a rigid one
};

class GltfReader {
 public:
  GltfReader(const GltfFile& file, const std::string& character)
      : file_(file),
        nodes_(with_chosen_meshes(file, read_nodes(file), character)),
        skeleton_(file, nodes_, skins_of_scene(file, nodes_)),
        morphs_of_node_(file.model.nodes.size()) {}

  // Reads the look of the source that read() returned.
  SourceLook read_look(const std::filesystem::path& path) {
    GltfLook out(file_, path);
    for (const auto& [primitive, part] : vertices_read_) out.add_vertices(*primitive, part);
    for (const auto& [primitive, count] : triangles_read_) out.add_triangles(*primitive, count);
    return std::move(out.look);
  }

  SourceMesh read() {
    out_.importer = "tinygltf";
    for (std::size_t n = 0; n < file_.model.nodes.size(); ++n) {
      if (nodes_.in_scene[n] && file_.model.nodes[n].mesh >= 0) add_mesh(n);
    }
    out_.rig.to_rest = skeleton_.world_to_rest();
    out_.metres_per_unit = 1 / std::cbrt(std::abs(out_.rig.to_rest.linear().determinant()));
    if (!(out_.metres_per_unit > 1e-12 && out_.metres_per_unit < 1e12))
      file_.fail("has a skeleton of no sensible size");
    out_.up_hint = (out_.rig.to_rest.linear() * Vec3::UnitY()).normalized();
    out_.rig.clips = read_clips(file_, nodes_, morphs_of_node_);
    note_characters(nodes_.nodes, skinned_, Vec3::UnitY(), file_.name);
    // An avatar says which node is which bone, whatever moves its meshes.
    const bool is_avatar = std::any_of(nodes_.nodes.begin(), nodes_.nodes.end(),
                                       [](const Node& node) { return !node.humanoid_bone.empty(); });
    if (skeleton_.has_skins() || !out_.rig.clips.empty() || is_avatar) {
      out_.rig.nodes = std::move(nodes_.nodes);
      out_.rig.bones = skeleton_.bones();
    }
    if (out_.rig.bones.empty()) out_.rig.weights.clear();  // nothing ever moves
    return std::move(out_);
  }

 private:
  void add_mesh(std::size_t n) {
    const tinygltf::Node& node = file_.model.nodes[n];
    const tinygltf::Mesh& mesh = file_.model.meshes[at(node.mesh)];
    std::map<std::pair<std::map<std::string, int>, std::vector<std::map<std::string, int>>>, SourceBuffer> shared;
    bool kept = false;
    for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
      const tinygltf::Primitive& primitive = mesh.primitives[p];
      const bool skinned = node.skin >= 0 && is_skinned(primitive);
      if (!has_triangles(primitive)) {
        out_.points_and_lines_dropped += count_points_and_lines(file_, primitive);
      } else if (primitive.attributes.count("POSITION") > 0) {
        kept = true;
        where_ = primitive_name(node.mesh, p);
        // Primitives may have their vertices in common, and each its own triangles.
        const auto [known, is_new] = shared.try_emplace({primitive.attributes, primitive.targets});
        const Carrier carrier = carrier_of(n, skinned);
        if (is_new) known->second = add_vertices(primitive, carrier, n);
        out_.buffers.push_back(known->second);
        out_.buffers.back().mesh = static_cast<Index>(node.mesh);
        out_.buffers.back().primitive = static_cast<Index>(p);
        out_.buffers.back().name = node.name + " " + mesh.name + " " + material_name(primitive);
        out_.buffers.back().triangle_count = add_triangles(primitive, carrier, known->second);
      }
    }
    out_.meshes += kept ? 1 : 0;
  }

  Carrier carrier_of(std::size_t n, bool skinned) {
    if (skinned) {
      const GltfSkin& skin = skeleton_.skin(file_.model.nodes[n].skin);
      return {skin.to_rest, &skin, {}};
    }
    const Index own = nodes_.of_file[n], joint = skeleton_.has_skins() ? skeleton_.joint_above(own) : kNoIndex;
    nodes_.nodes[own].is_attachment = joint != kNoIndex && joint != own;
    const GltfSkeleton::Rigid rigid = skeleton_.rigid(own);
    return {rigid.to_rest, nullptr, rigid.bone};
  }

  SourceBuffer add_vertices(const tinygltf::Primitive& primitive, const Carrier& carrier, std::size_t n) {
    spend(file_.model.accessors[at(primitive.attributes.at("POSITION"))].count);
    const std::vector<Vec3> positions = read_positions(file_, primitive, where_);
    SourceBuffer part;
    part.first_vertex = static_cast<Index>(out_.positions.size());
    part.vertex_count = static_cast<Index>(positions.size());
    part.hash = sc_hash_positions(pack(positions).data(), positions.size(), 12);
    for (const Vec3& p : positions) out_.positions.push_back(carrier.to_rest * p);

    std::vector<VertexWeights>& all = out_.rig.weights;
    if (carrier.skin != nullptr) {
      const Affine to_world = skeleton_.world_to_rest().inverse();
      const Index top = *std::min_element(carrier.skin->joints.begin(), carrier.skin->joints.end());
      const std::string& skin = file_.model.skins[at(file_.model.nodes[n].skin)].name;
      SkinnedBox& box = skinned_.emplace_back(SkinnedBox{{nodes_.of_file[n], top, {}, skin, false}, {}});
      for (std::size_t v = part.first_vertex; v < out_.positions.size(); ++v)
        box.box.extend(to_world * out_.positions[v]);
      const auto weights = read_weights(file_, primitive, carrier.skin->bones, positions.size(), where_);
      all.insert(all.end(), weights.begin(), weights.end());
    } else {
      VertexWeights rigid;
      if (carrier.bone) {
        rigid.joint[0] = *carrier.bone;
        rigid.weight[0] = 1;
      }
      all.insert(all.end(), positions.size(), rigid);
    }
    add_morphs(primitive, carrier, n, part);
    vertices_read_.emplace_back(&primitive, positions.size());
    return part;
  }

  std::string material_name(const tinygltf::Primitive& primitive) const {
    const std::vector<tinygltf::Material>& all = file_.model.materials;
    return primitive.material >= 0 && at(primitive.material) < all.size() ? all[at(primitive.material)].name : "";
  }

  // Returns how many there are.
  Index add_triangles(const tinygltf::Primitive& primitive, const Carrier& carrier, const SourceBuffer& part) {
    const std::vector<Triangle> triangles = read_triangles(file_, primitive, part.vertex_count, where_);
    spend(triangles.size());
    triangles_read_.emplace_back(&primitive, triangles.size());
    const bool mirrored = carrier.to_rest.linear().determinant() < 0;  // turns triangles inside out
    for (Triangle t : triangles) {
      if (mirrored) std::swap(t[1], t[2]);
      out_.triangles.push_back({part.first_vertex + t[0], part.first_vertex + t[1], part.first_vertex + t[2]});
    }
    return static_cast<Index>(triangles.size());
  }

  // A node's morphs move the vertices of all its primitives.
  void add_morphs(const tinygltf::Primitive& primitive, const Carrier& carrier, std::size_t n,
                  const SourceBuffer& part) {
    const tinygltf::Node& node = file_.model.nodes[n];
    const tinygltf::Mesh& mesh = file_.model.meshes[at(node.mesh)];
    GltfMorphs& morphs = morphs_of_node_[n];
    if (morphs.count == 0 && !primitive.targets.empty()) {
      spend(primitive.targets.size());
      morphs = {static_cast<Index>(out_.rig.morphs.size()), static_cast<Index>(primitive.targets.size())};
      const tinygltf::Value names = mesh.extras.Has("targetNames") ? mesh.extras.Get("targetNames") : tinygltf::Value();
      const std::vector<double>& weights = node.weights.empty() ? mesh.weights : node.weights;
      for (std::size_t t = 0; t < morphs.count; ++t) {
        Morph& morph = out_.rig.morphs.emplace_back();
        const bool named = names.IsArray() && t < names.ArrayLen();
        morph.name = named ? names.Get(static_cast<int>(t)).Get<std::string>() : "target_" + std::to_string(t);
        if (t < weights.size()) morph.rest_weight = weights[t];
      }
    }
    if (primitive.targets.size() != morphs.count) {
      file_.fail(where_ + " has " + std::to_string(primitive.targets.size()) + " morph targets, another of its mesh " +
                 std::to_string(morphs.count));
    }
    for (std::size_t t = 0; t < primitive.targets.size(); ++t) {
      Morph& morph = out_.rig.morphs[morphs.first + t];
      const std::vector<Vec3> displacements = read_displacements(file_, primitive.targets[t], part.vertex_count,
                                                                 where_ + ".targets[" + std::to_string(t) + "]");
      for (Index v = 0; v < displacements.size(); ++v) {
        if (displacements[v].isZero(0)) continue;
        spend(1);
        morph.vertices.push_back(part.first_vertex + v);
        morph.deltas.push_back(carrier.to_rest.linear() * displacements[v]);
      }
    }
  }

  // Instances and shared accessors let a small file ask for much: stop before memory does.
  void spend(std::size_t elements) {
    spent_ += elements;
    if (spent_ > kGltfElementsMax) file_.fail(where_ + " and those before it are too large for a character");
  }

  const GltfFile& file_;
  GltfNodes nodes_;
  GltfSkeleton skeleton_;
  std::vector<GltfMorphs> morphs_of_node_;  // by the file's index
  SourceMesh out_;
  std::vector<std::pair<const tinygltf::Primitive*, std::size_t>> vertices_read_, triangles_read_;  // in their order
  std::vector<SkinnedBox> skinned_;
  std::string where_;  // the primitive at hand, for errors
  std::size_t spent_ = 0;
};

}  // namespace

SourceMesh read_with_tinygltf(const std::filesystem::path& path, const ImportOptions& options) {
  const GltfFile file = open_gltf(path);
  GltfReader reader(file, options.character);
  SourceMesh out = reader.read();
  note_lost_pictures(file, path.parent_path());
  if (options.look) out.look = reader.read_look(path);
  return out;
}

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/assimp_scene.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "baker/import/choose_meshes.h"
#include "baker/import/one_space.h"
#include "baker/mesh/error.h"

namespace spherechain::baker {
namespace {

constexpr std::string_view kPivot = "_$AssimpFbx$_";

bool is_pivot(const aiNode& node) {
  return std::string_view(node.mName.C_Str()).find(kPivot) != std::string_view::npos && node.mNumMeshes == 0 &&
         node.mNumChildren > 0;
}

// Takes geometric transforms out of a node's chain, and returns the node's own: the others undo the parent's.
Affine take_geometric(std::vector<const aiNode*>& chain) {
  Affine own = Affine::Identity();
  std::vector<const aiNode*> kept;
  for (const aiNode* link : chain) {
    const std::string_view name = link->mName.C_Str();
    const std::size_t at = is_pivot(*link) ? name.rfind(kPivot) + kPivot.size() : name.size();
    if (!name.substr(at).starts_with("Geometric"))
      kept.push_back(link);
    else if (!name.ends_with("Inverse"))
      own = own * to_affine(link->mTransformation);
  }
  chain = std::move(kept);
  return own;
}

void visit(const aiScene& scene, const NamesOfNodes& names, const aiNode& node, int parent,
           std::vector<const aiNode*> chain, const std::string& file, AssimpScene& out) {
  chain.push_back(&node);
  if (!to_affine(node.mTransformation).matrix().allFinite()) {
    throw Error(ExitCode::kFile, file + ": node '" + node.mName.C_Str() + "' has a transform that is not finite");
  }
  int self = parent;
  if (!is_pivot(node)) {
    Node read;
    const auto known = names.find(node.mName.C_Str());
    read.name = known == names.end() ? node.mName.C_Str() : known->second;
    read.parent = parent;
    const Affine geometric = take_geometric(chain);
    for (const aiNode* link : chain) read.local = read.local * to_affine(link->mTransformation);
    decompose(read);
    self = static_cast<int>(out.nodes.size());
    const auto index = static_cast<Index>(self);
    out.by_name.emplace(node.mName.C_Str(), index);
    out.world.push_back(parent < 0 ? read.local : out.world[static_cast<std::size_t>(parent)] * read.local);
    out.nodes.push_back(std::move(read));
    out.chains.push_back(std::move(chain));
    chain.clear();
    for (unsigned m = 0; m < node.mNumMeshes; ++m) {
      if (node.mMeshes[m] >= scene.mNumMeshes || scene.mMeshes[node.mMeshes[m]] == nullptr) {
        throw Error(ExitCode::kFile, file + ": node '" + node.mName.C_Str() + "' has a mesh that does not exist");
      }
      out.instances.push_back(
          {scene.mMeshes[node.mMeshes[m]], node.mMeshes[m], index, geometric, out.world[index] * geometric, 0, 0});
    }
  }
  for (unsigned c = 0; c < node.mNumChildren; ++c) {
    // Importers leave gaps for objects they drop.
    if (node.mChildren[c] == nullptr) continue;
    visit(scene, names, *node.mChildren[c], self, chain, file, out);
  }
}

// The axes and units that a skeleton at rest adds to a mesh's node, and that most formats leave out of a skin.
// Rotations other than quarter turns belong to the pose; the rest positions leave them out.
Affine axes_and_units(const Affine& shown) {
  double scale = std::cbrt(std::abs(shown.linear().determinant()));
  if (!(scale > 0) || !std::isfinite(scale)) return Affine::Identity();
  Eigen::Matrix3d axes = (shown.linear() / scale).array().round();
  if (!(axes * axes.transpose()).isIdentity()) axes.setIdentity();
  constexpr double kSameUnit = 0.01;
  if (std::abs(scale - 1) < kSameUnit) scale = 1;
  Affine out = Affine::Identity();
  out.linear() = scale * axes;
  return out;
}

// Where skinned meshes are at rest: where their bones were bound. The first mesh stays where its node has it, but for
// axes and units; the others fit to it by a bone they share, or stay where their nodes have them if all bones were
// bound there, or else fit by the skeleton's rest pose.
class SkinPlacement {
 public:
  explicit SkinPlacement(const AssimpScene& flat) : flat_(flat), is_one_space_(is_one_space(flat)) {}

  Affine place(const MeshInstance& instance) {
    const aiMesh& mesh = *instance.mesh;
    const Affine placement = find(instance);
    for (unsigned b = 0; b < mesh.mNumBones; ++b) {
      inverse_binds_.emplace(mesh.mBones[b]->mName.C_Str(), offset_of(*mesh.mBones[b], instance) * placement.inverse());
    }
    return placement;
  }
  const std::vector<std::string>& placed_by_rest_pose() const { return placed_by_rest_pose_; }

 private:
  Affine find(const MeshInstance& instance) {
    const aiMesh& mesh = *instance.mesh;
    const Affine &by_node = instance.placement, in_rest_pose = shown(instance);
    if (inverse_binds_.empty()) {
      const Affine placement = axes_and_units(in_rest_pose * by_node.inverse()) * by_node;
      rest_pose_to_rest_ = placement * in_rest_pose.inverse();
      nodes_to_rest_ = placement * by_node.inverse();
      return placement;
    }
    Affine placement = is_one_space_ ? Affine(nodes_to_rest_ * by_node) : Affine(rest_pose_to_rest_ * in_rest_pose);
    bool is_known = is_one_space_ || is_bind_pose_;
    for (unsigned b = 0; b < mesh.mNumBones; ++b) {
      const auto bound = inverse_binds_.find(mesh.mBones[b]->mName.C_Str());
      if (bound == inverse_binds_.end()) continue;
      placement = bound->second.inverse() * offset_of(*mesh.mBones[b], instance);
      is_known = true;
      break;
    }
    constexpr double kSame = 1e-4;  // singles
    if (placement.isApprox(by_node, kSame) || !placement.matrix().allFinite()) return by_node;
    if (!is_known) placed_by_rest_pose_.emplace_back(mesh.mName.C_Str());
    return placement;
  }

  // Whether the nodes of all meshes have them where their bones were bound.
  static bool is_one_space(const AssimpScene& flat) {
    std::vector<BoundJoint> bound;
    std::size_t number = 0;
    for (const MeshInstance& instance : flat.instances) {
      for (unsigned b = 0; b < instance.mesh->mNumBones; ++b) {
        const aiBone& bone = *instance.mesh->mBones[b];
        const auto node = flat.by_name.find(bone.mName.C_Str());
        if (node != flat.by_name.end())
          bound.push_back({node->second, number, instance.placement * offset_of(bone, instance).inverse()});
      }
      if (instance.mesh->mNumBones > 0) ++number;
    }
    return were_bound_in_one_space(flat.nodes, bound);
  }

  // Mesh space into the scene, as the mesh's bones have it in the rest pose.
  Affine shown(const MeshInstance& instance) {
    const aiMesh& mesh = *instance.mesh;
    std::vector<std::pair<Index, const aiBone*>> bones;  // the highest first
    for (unsigned b = 0; b < mesh.mNumBones; ++b) {
      const auto node = flat_.by_name.find(mesh.mBones[b]->mName.C_Str());
      if (node != flat_.by_name.end()) bones.emplace_back(node->second, mesh.mBones[b]);
    }
    std::stable_sort(bones.begin(), bones.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<Affine> maps;
    std::vector<double> weights;
    for (const auto& [node, bone] : bones) {
      const Affine map = flat_.world[node] * offset_of(*bone, instance);
      if (!map.matrix().allFinite()) continue;
      maps.push_back(map);
      weights.push_back(0);
      for (unsigned w = 0; w < bone->mNumWeights; ++w) weights.back() += std::max(bone->mWeights[w].mWeight, 0.0F);
    }
    if (maps.empty()) return instance.placement;
    const Affine typical = maps[typical_map(maps, weights)];
    constexpr double kSame = 1e-3;
    is_bind_pose_ = is_bind_pose_ && std::all_of(maps.begin(), maps.end(),
                                                 [&](const Affine& map) { return map.isApprox(typical, kSame); });
    return typical;
  }

  const AssimpScene& flat_;
  bool is_one_space_;
  bool is_bind_pose_ = true;  // whether the meshes so far are at rest as they were bound
  std::vector<std::string> placed_by_rest_pose_;
  Affine nodes_to_rest_ = Affine::Identity();
  Affine rest_pose_to_rest_ = Affine::Identity();
  std::unordered_map<std::string, Affine> inverse_binds_;  // by bone name, of the meshes placed so far
};

}  // namespace

Affine to_affine(const aiMatrix4x4& m) {
  Affine out;
  out.matrix() << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4;
  return out;
}

const aiNode* post_rotation(const std::vector<const aiNode*>& chain) {
  const auto found = std::find_if(chain.begin(), chain.end(), [](const aiNode* link) {
    return std::string_view(link->mName.C_Str()).ends_with("_$AssimpFbx$_PostRotation");
  });
  return found == chain.end() ? nullptr : *found;
}

Affine offset_of(const aiBone& bone, const MeshInstance& instance) {
  return to_affine(bone.mOffsetMatrix) * instance.geometric;
}

Index top_joint(const AssimpScene& flat, const aiMesh& mesh) {
  Index top = kNoIndex;
  for (unsigned b = 0; b < mesh.mNumBones; ++b) {
    const auto node = flat.by_name.find(mesh.mBones[b]->mName.C_Str());
    if (node != flat.by_name.end()) top = std::min(top, node->second);
  }
  return top;
}

AssimpScene flatten(const aiScene& scene, const NamesOfNodes& names, const std::string& file,
                    const std::string& character) {
  AssimpScene out;
  if (scene.mRootNode != nullptr) visit(scene, names, *scene.mRootNode, -1, {}, file, out);
  std::vector<ShownMesh> meshes;
  for (const MeshInstance& instance : out.instances)
    meshes.push_back({instance.node, top_joint(out, *instance.mesh), instance.mesh->mName.C_Str(), {}, false});
  const std::vector<bool> chosen = choose_meshes(out.nodes, meshes, character, file);
  std::size_t place = 0;
  std::erase_if(out.instances, [&](const MeshInstance&) { return !chosen[place++]; });
  SkinPlacement skins(out);
  Index vertices = 0, morphs = 0;
  for (MeshInstance& instance : out.instances) {
    if (instance.mesh->mNumBones > 0) instance.placement = skins.place(instance);
    instance.first_vertex = vertices;
    instance.first_morph = morphs;
    vertices += instance.mesh->mNumVertices;
    morphs += instance.mesh->mNumAnimMeshes;
  }
  out.placed_by_rest_pose = skins.placed_by_rest_pose();
  return out;
}

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/fbx_binds.h"

#include <map>
#include <optional>
#include <string>
#include <utility>

namespace spherechain::baker {
namespace {

// Mesh space into the bone's where a cluster was bound. Empty where the record has no matrix.
std::optional<aiMatrix4x4> bind_of(const FbxTree& tree, const FbxRecord& cluster) {
  const FbxRecord* const record = cluster.find("Transform");
  if (record == nullptr) return {};
  const std::optional<FbxArray> numbers = tree.array(*record);
  if (!numbers || numbers->items.size() != 16) return {};
  aiMatrix4x4 out;
  for (unsigned i = 0; i < 16; ++i) out[i % 4][i / 4] = static_cast<ai_real>(numbers->number(i));  // column by column
  return out;
}

struct Binds {
  std::map<std::string_view, std::int64_t> geometries;                        // by the name of their model
  std::map<std::pair<std::int64_t, std::string_view>, aiMatrix4x4> of_joint;  // by geometry and the joint's name
};

// A model has a geometry, that a skin, and that a cluster for each joint.
Binds read_binds(const FbxFile& file) {
  std::map<std::int64_t, const FbxRecord*> geometries, deformers;
  if (const FbxRecord* const objects = file.tree.find("Objects")) {
    for (const FbxRecord& record : objects->inside) {
      if (record.name != "Geometry" && record.name != "Deformer") continue;
      const std::vector<FbxValue> values = file.tree.values(record);
      if (values.empty() || !values[0].whole) continue;
      (record.name == "Geometry" ? geometries : deformers).emplace(*values[0].whole, &record);
    }
  }
  std::map<std::int64_t, std::string_view> models;
  for (const FbxObject& object : file.objects) {
    if (object.kind == FbxKind::kModel) models.emplace(object.id, object.name);
  }
  Binds out;
  std::map<std::int64_t, std::int64_t> owners;      // of skins and clusters
  std::map<std::int64_t, std::string_view> joints;  // of clusters
  for (const FbxLink& link : file.links) {
    const auto child = models.find(link.child), parent = models.find(link.parent);
    if (parent != models.end() && geometries.contains(link.child)) out.geometries.emplace(parent->second, link.child);
    if (child != models.end() && deformers.contains(link.parent)) joints.emplace(link.parent, child->second);
    if (deformers.contains(link.child)) owners.emplace(link.child, link.parent);
  }
  for (const auto& [cluster, joint] : joints) {
    const auto skin = owners.find(cluster);
    const auto geometry = skin == owners.end() ? skin : owners.find(skin->second);
    if (geometry == owners.end()) continue;
    const std::optional<aiMatrix4x4> bind = bind_of(file.tree, *deformers.at(cluster));
    if (bind) out.of_joint.emplace(std::pair(geometry->second, joint), *bind);
  }
  return out;
}

}  // namespace

void keep_space_and_binds(aiScene& scene, const FbxFile& file) {
  if (file.objects.empty() || scene.mRootNode == nullptr) return;
  scene.mRootNode->mTransformation = aiMatrix4x4();
  const Binds binds = read_binds(file);
  const auto visit = [&](const auto& self, const aiNode& node) -> void {
    const auto geometry = binds.geometries.find(node.mName.C_Str());
    for (unsigned m = 0; m < node.mNumMeshes && geometry != binds.geometries.end(); ++m) {
      if (node.mMeshes[m] >= scene.mNumMeshes || scene.mMeshes[node.mMeshes[m]] == nullptr) continue;
      const aiMesh& mesh = *scene.mMeshes[node.mMeshes[m]];
      for (unsigned b = 0; b < mesh.mNumBones; ++b) {
        const auto bind = binds.of_joint.find({geometry->second, mesh.mBones[b]->mName.C_Str()});
        if (bind != binds.of_joint.end()) mesh.mBones[b]->mOffsetMatrix = bind->second;
      }
    }
    for (unsigned c = 0; c < node.mNumChildren; ++c) {
      if (node.mChildren[c] != nullptr) self(self, *node.mChildren[c]);
    }
  };
  visit(visit, *scene.mRootNode);
}

}  // namespace spherechain::baker

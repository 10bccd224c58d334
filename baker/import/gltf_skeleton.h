// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "baker/import/gltf_file.h"
#include "baker/import/source_rig.h"

namespace spherechain::baker {

// A file's nodes, parents first. Indices are those of `nodes`, not the file's.
struct GltfNodes {
  std::vector<Node> nodes;
  std::vector<Affine> world;   // at rest
  std::vector<Index> of_file;  // the file's index -> ours
  std::vector<bool> in_scene;  // by the file's index
};
// Throws Error(kFile) where a node has two parents or is its own ancestor.
GltfNodes read_nodes(const GltfFile& file);

// A skin. All skins share one rest space.
struct GltfSkin {
  std::vector<Index> joints;            // nodes
  std::vector<Affine> inverse_bind;     // from the skin's own mesh space to the joint's
  Affine to_rest = Affine::Identity();  // from the skin's own mesh space to the rest space
  std::vector<Index> bones;             // a joint's bone
};

// A skin of the scene's meshes: its number in the file, and how much of the meshes each joint moves, in vertices.
struct UsedSkin {
  int index;
  std::vector<double> weights;
};

// Binds meshes to nodes. The rest space is the mesh space of one skin; without skins it is the scene's world.
class GltfSkeleton {
 public:
  // `used` are the skins of the scene's meshes, the one that leads first.
  GltfSkeleton(const GltfFile& file, const GltfNodes& nodes, const std::vector<UsedSkin>& used);

  bool has_skins() const { return !skins_.empty(); }
  const GltfSkin& skin(int file_index) const { return *skins_[static_cast<std::size_t>(file_index)]; }
  const std::vector<Bone>& bones() const { return bones_; }
  const Affine& world_to_rest() const { return world_to_rest_; }

  // The joint at or above a node, kNoIndex where there is none.
  Index joint_above(Index node) const { return joint_above_[node]; }

  // How a node carries a rigid mesh.
  struct Rigid {
    Affine to_rest;             // from the mesh's space to the rest space, in the bind pose of the joint above
    std::optional<Index> bone;  // none where the node squashes the mesh flat
  };
  Rigid rigid(Index node);

 private:
  GltfSkin read_skin(std::size_t index) const;
  Affine rest_to_world(const UsedSkin& used) const;
  void find_to_rest(const UsedSkin& used, const GltfSkin& lead, const std::vector<Index>& lead_joint);
  Index bone(Index node, const Affine& inverse_bind);

  const GltfFile& file_;
  const GltfNodes& nodes_;
  std::vector<std::optional<GltfSkin>> skins_;  // by the file's index
  std::vector<Bone> bones_;
  std::vector<std::vector<Index>> bones_of_node_;
  std::vector<Index> joint_above_;
  Affine world_to_rest_ = Affine::Identity();
  double extent_ = 0;  // of the joints in the rest space
};

}  // namespace spherechain::baker

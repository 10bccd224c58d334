// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <assimp/scene.h>

#include <string>
#include <unordered_map>
#include <vector>

#include "baker/import/source_rig.h"

namespace spherechain::baker {

inline Vec3 to_vec3(const aiVector3D& v) { return {v.x, v.y, v.z}; }
Affine to_affine(const aiMatrix4x4& m);

// A mesh of the scene where a node shows it.
struct MeshInstance {
  const aiMesh* mesh;
  Index number;  // of the mesh in the scene
  Index node;
  Affine geometric;  // an FBX file's geometric transform: of this mesh, neither of its node nor of the node's children
  Affine placement;  // mesh space -> rest positions
  Index first_vertex, first_morph;
};

// An assimp scene as a flat list of nodes, parents before children. The rest positions are its world.
struct AssimpScene {
  std::vector<Node> nodes;
  // The scene's nodes that each node replaces; the last one has the name by which assimp refers to it. There are
  // several in FBX, where assimp unfolds a node's pivots into a chain of nodes that no clip of another file would fit.
  // Geometric transforms, which assimp has in the chain and undoes for the node's children, are in no chain.
  std::vector<std::vector<const aiNode*>> chains;
  std::vector<Affine> world;
  std::unordered_map<std::string, Index> by_name;  // the first of that name, as assimp refers to them
  std::vector<MeshInstance> instances;
  std::vector<std::string> placed_by_rest_pose;  // meshes whose bind pose does not say how they lie to others
};

// The link of a chain that takes an FBX node's PostRotation back; null where there is none.
const aiNode* post_rotation(const std::vector<const aiNode*>& chain);

// Mesh space into the bone's, in the bind pose. FBX's clusters, which are all that assimp looks at, leave out the
// geometric transform.
Affine offset_of(const aiBone& bone, const MeshInstance& instance);

// The names that people know nodes by, where assimp has others for them.
using NamesOfNodes = std::unordered_map<std::string, std::string>;

// `character` chooses meshes (choose_meshes.h). Throws Error(kFile) that begins with `file` where it has none, or a
// transform is not finite.
AssimpScene flatten(const aiScene& scene, const NamesOfNodes& names, const std::string& file,
                    const std::string& character = {});

// The node of the mesh's bones that is nearest to the root; kNoIndex where it has none.
Index top_joint(const AssimpScene& flat, const aiMesh& mesh);

std::vector<Clip> read_clips(const aiScene& scene, const AssimpScene& flat, const std::string& file);

// Skeleton, skin, morph targets and clips; empty where nothing moves a mesh. Throws Error(kFile) where a number is not
// finite.
SourceRig read_rig(const aiScene& scene, const AssimpScene& flat, const std::string& file);

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "baker/import/source_rig.h"

namespace spherechain::baker {

// A mesh where a node of the scene shows it.
struct ShownMesh {
  Index node;
  Index top_joint = kNoIndex;  // of its skin, the nearest to the root
  std::string name, skin;
  bool is_coarse = false;  // the file says that it is a coarser level of another
};

// Which of the meshes are read. `character` is the name of a node, a mesh or a skin: its meshes, those below it, and
// those that move with a skeleton below it; empty: all. Where there are several levels of detail ("body_LOD0",
// "body_LOD1"), the finest is read, which a note says. Throws Error(kFile) where the character has no mesh.
std::vector<bool> choose_meshes(const std::vector<Node>& nodes, const std::vector<ShownMesh>& meshes,
                                const std::string& character, const std::string& file);

// A mesh, or a part of one, that a skeleton moves; where it is at rest, in the scene's axes.
struct SkinnedBox {
  ShownMesh mesh;  // its node may be kNoIndex: not known
  Eigen::AlignedBox3d box;
};

// The characters in a file where there are several: skeletons of their own that move meshes beside each other. Each is
// given by the name by which `choose_meshes` takes it alone. The list is empty where there are not several.
std::vector<std::string> characters_in(const std::vector<Node>& nodes, const std::vector<SkinnedBox>& skinned,
                                       const Vec3& up);
// "has 2 characters ('Hips', 'Hips.001')".
std::string characters_text(const std::vector<std::string>& names);

// Notes that there are several.
void note_characters(const std::vector<Node>& nodes, const std::vector<SkinnedBox>& skinned, const Vec3& up,
                     const std::string& file);

}  // namespace spherechain::baker

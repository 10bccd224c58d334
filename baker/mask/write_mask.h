// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "baker/import/glb_file.h"
#include "baker/layers/skin.h"
#include "baker/mask/find_hidden.h"

namespace spherechain::baker {

// How hidden skin is written into a glTF. Masks are 1 where a vertex is shown, and 0 where all of its triangles are
// hidden.
enum class MaskForm { kTriangles, kVertexColour, kAttribute };

// Hidden triangles of a mesh, in the file's order, primitive after primitive.
struct HiddenMesh {
  std::string name;
  Index triangles = 0;
  std::vector<Index> hidden;
};

// A mesh that several nodes show has a hidden triangle where it is hidden in all of them.
std::vector<HiddenMesh> hidden_meshes(const nlohmann::ordered_json& gltf, const std::vector<PrimitiveRun>& runs,
                                      const HiddenSkin& skin);

// Takes the hidden triangles out of the glTF, or marks its vertices. All else stays; new numbers are appended. `file`
// is for messages. Throws Error(kFile) where a primitive's corners cannot be read.
void write_mask(GlbFile& glb, const std::string& file, const std::vector<PrimitiveRun>& runs, const HiddenSkin& skin,
                MaskForm form);

// docs/json.md
std::string mask_json(const std::vector<HiddenMesh>& meshes, const HiddenSkin& skin,
                      const std::vector<std::string>& clips);

}  // namespace spherechain::baker

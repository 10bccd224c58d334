// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "baker/import/arrays.h"
#include "baker/import/import.h"

namespace spherechain::baker {

// A skinned character in the tables of R2ET (Zhang et al. 2023, datasets/mixamo/*_shape/*.npz): 'rest_vertices',
// 'rest_faces', 'skinning_weights' and 'skeleton', with 'joint_names' and 'parents' where it has them. Centimetres, y
// up. Nothing where the tables hold no vertices and faces. Throws Error(kFile) that begins with `file` where they do
// not fit each other.
std::optional<SourceMesh> array_character(const Arrays& arrays, const std::string& file);

}  // namespace spherechain::baker

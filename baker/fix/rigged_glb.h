// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "baker/pipeline/pipeline.h"

namespace spherechain::baker {

// A copy of a GLB with the automatic rig: its joints become nodes, and each mesh of the character gets a skin. `bytes`
// is what read_as_glb() made of the file that was baked. Throws Error(kFile) that names `file` where it has no such
// rig, or two nodes show one mesh, which has weights for one place alone.
std::string rigged_glb(const std::string& bytes, const std::string& file, const Bake& baked);

}  // namespace spherechain::baker

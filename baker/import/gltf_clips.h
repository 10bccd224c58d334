// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/import/gltf_skeleton.h"

namespace spherechain::baker {

// The morphs of a node's mesh, one a target.
struct GltfMorphs {
  Index first = 0, count = 0;
};

// The file's animations. A channel for weights becomes one channel a morph. Channels without a node, of other
// properties or of meshes that are not shown are skipped, and so are animations without channels. Throws Error(kFile).
std::vector<Clip> read_clips(const GltfFile& file, const GltfNodes& nodes, const std::vector<GltfMorphs>& morphs);

}  // namespace spherechain::baker

// SPDX-License-Identifier: MIT
// The inputs of skinning clusters. Kernels use the spans' pointers alone: they are compiled once a target and may use
// no inline function of the headers.
#pragma once

#include <cstddef>

#include "runtime/src/pose/pose.h"
#include "runtime/src/skin/skin_table.h"

namespace spherechain {

struct SkinInputs {
  const Surface* surface = nullptr;
  BoneMatrices bones;
  const float* morph_weights = nullptr;  // null where nothing morphs
};

// Puts the surface's vertices where the bones have them: positions + stride * v for the source vertex v, in floats;
// other source vertices are left alone. For the repository's own use.
void skin_surface(const Surface& surface, const Pose& pose, Target resolved, float* positions, std::size_t stride);

// The same for the vertices of those clusters, x, y, z each of the surface's.
void skin_vertices(const Surface& surface, const Pose& pose, Target resolved, Span<const std::uint32_t> clusters,
                   float* positions);

}  // namespace spherechain

// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "spherechain/abi.h"
#include "spherechain/asset.h"
#include "spherechain/refit_bones.h"
#include "spherechain/simd.h"
#include "spherechain/status.h"
#include "spherechain/types.h"

namespace spherechain {

// Where the surface's vertices are in a pose: linear blend skinning of the asset's own copy of the mesh, for those who
// have no deformed vertices. Exact contacts from bones are found between these very positions.
//
// The arithmetic is fixed, in single precision, so that every backend gives the same positions, bit for bit; fma as in
// RefitBonesJob. Of a slot of a leaf, p its rest position and a = (0, 0, 0):
//   p_i = fma(weight, delta_i, p_i)                                    for each morph of the slot whose weight is not 0
//   a_i = fma(w, fma(m_i2, p_z, fma(m_i1, p_y, fma(m_i0, p_x, m_i3))), a_i)    for each bone of the leaf, in order
// for i = x, y, z, with w the slot's weight of the bone and m the bone's matrix. A bone of weight 0 leaves a as it is,
// so a vertex in several leaves has one position.
//
// Fill in the fields and call run(). Allocates nothing, takes no lock; jobs on other buffers may run at the same time.
struct SPHERECHAIN_API SkinJob {
  const Asset* asset = nullptr;     // open, with leaves and bones
  BoneMatrices bones;               // as RefitBonesJob takes them: at least asset->bone_count()
  Span<const float> morph_weights;  // empty where nothing morphs, or at least asset->morph_count()
  Target target = Target::kBest;

  // Out: x, y, z of each of Surface::source_vertices, at its index. Other vertices are left alone: those that move as a
  // lower one does, and those no triangle uses.
  float* positions = nullptr;
  std::size_t vertex_count = 0;  // at least info().source_vertex_count
  std::size_t stride = 12;       // bytes between positions; a multiple of 4, at least 12

  // kOk, kNullArgument, kNotOpen, kBadArgument, kBadStride, kNotInAsset, kTooFewBones, kTooFewMorphs, kTooFewVertices,
  // kUnsupportedTarget, kMisaligned or kSharedMemory; nothing is written unless kOk.
  Status run() const noexcept;
};

}  // namespace spherechain

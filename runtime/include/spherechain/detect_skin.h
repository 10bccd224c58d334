// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "spherechain/abi.h"
#include "spherechain/asset.h"
#include "spherechain/filter.h"
#include "spherechain/refit_bones.h"
#include "spherechain/simd.h"
#include "spherechain/status.h"
#include "spherechain/triangle_contacts.h"
#include "spherechain/types.h"

namespace spherechain {

// Which spheres' skins intersect: the pairs of spheres of TriangleContactJob's sphere contacts, none missing and none
// else, for less, since each pair of spheres is done with at its first contact.
//
// DetectJob's pairs, but decided by the skin: whether two spheres touch, at whatever radius, plays no part, so nothing
// that lies between spheres or far out of them is missed. Left out is what TriangleContactJob leaves out of
// ContactScope::kApart: within one sphere's region, ignored pairs, triangles that share a position or intersect at
// rest. What each found pair has in common, and how deep, TriangleContactJob tells; of pairs found otherwise, also
// ignored ones, ConfirmJob tells which are true.
//
// The pose is given as in TriangleContactJob. The same pairs on every target, of whatever is finite.
//
// Fill in the fields and call run(). Allocates nothing, takes no lock; jobs with other outputs and contexts may run at
// the same time.
struct SPHERECHAIN_API DetectSkinJob {
  const Asset* asset = nullptr;      // open, with a surface
  const float* positions = nullptr;  // deformed vertices in the source's order, x y z after another; or null
  std::size_t vertex_count = 0;      // at least asset->info().source_vertex_count
  std::size_t stride = 12;           // bytes from one vertex to the next; a multiple of 4, at least 12
  BoneMatrices bones;                // as in RefitBonesJob; beside positions they may be null
  Span<const float> morph_weights;   // with bones: as in RefitBonesJob
  Target target = Target::kBest;
  const Filter* filter = nullptr;             // null: the asset's ignored pairs; padding is of no effect
  TriangleContactContext* context = nullptr;  // required
  Span<Pair> pairs;                           // out: sorted, each once; may be empty to count

  std::size_t pair_count = 0;  // out: also where the buffer was too small

  // kOk; kOverflow where `pairs` was not empty and too small: the first of the sorted list are written, the count says
  // what is needed; kNullArgument, kNotOpen, kNotInAsset, kTooFewVertices, kBadStride, kTooFewBones, kTooFewMorphs,
  // kContextTooSmall, kBadArgument, kUnsupportedTarget, kBadFilter, kMisaligned, kSharedMemory: nothing is written, the
  // count keeps its value.
  Status run() noexcept;
};

}  // namespace spherechain

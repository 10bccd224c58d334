// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "spherechain/abi.h"
#include "spherechain/asset.h"
#include "spherechain/refit_bones.h"
#include "spherechain/simd.h"
#include "spherechain/status.h"
#include "spherechain/triangle_contacts.h"
#include "spherechain/types.h"

namespace spherechain {

// Of some pairs of spheres, those whose skins intersect: a triangle of the one's surrounding region has a point in
// common with one of the other's. Exactly, as TriangleContactJob decides it, with its exceptions for neighbouring
// triangles and for those that intersect in the rest pose; a pair is done with at its first contact, and only the
// vertices of the spheres named are read or skinned. With bones all spheres are bounded first, once a run.
//
// Made for the pairs that DetectJob reports: spheres are an alarm, this is what is true of it. What spheres miss it
// does not find; DetectSkinJob does.
//
// The pose is given as in TriangleContactJob. The same pairs on every target, of whatever is finite.
//
// Fill in the fields and call run(). Allocates nothing, takes no lock; jobs with other outputs and contexts may run at
// the same time.
struct SPHERECHAIN_API ConfirmJob {
  const Asset* asset = nullptr;      // open, with a surface
  const float* positions = nullptr;  // deformed vertices in the source's order, x y z after another; or null
  std::size_t vertex_count = 0;      // at least asset->info().source_vertex_count
  std::size_t stride = 12;           // bytes from one vertex to the next; a multiple of 4, at least 12
  BoneMatrices bones;                // as in RefitBonesJob; beside positions they may be null
  Span<const float> morph_weights;   // with bones: as in RefitBonesJob
  Target target = Target::kBest;
  Span<const Pair> candidates;  // two spheres each, not the same one; in any order, ignored ones are answered too
  TriangleContactContext* context = nullptr;  // required
  Span<Pair> pairs;                           // out: those confirmed, in the candidates' order; may be empty to count

  std::size_t pair_count = 0;  // out: of those confirmed, also where the buffer was too small

  // kOk; kOverflow where `pairs` was not empty and too small: the first are written, the count says what is needed;
  // kNullArgument, kNotOpen, kNotInAsset, kTooFewVertices, kBadStride, kTooFewBones, kTooFewMorphs, kContextTooSmall,
  // kBadArgument (a candidate that names no two spheres), kUnsupportedTarget, kMisaligned, kSharedMemory: nothing is
  // written, the count keeps its value.
  Status run() noexcept;
};

}  // namespace spherechain

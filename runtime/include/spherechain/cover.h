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

// Balls that contain the skin in the pose, whatever the pose is, from bone matrices alone: one around the vertices of
// each leaf. A guarantee, not a margin found by trying: turned, stretched, sheared and mirrored bones and any morph
// weights are covered, and so are the roundings of this job and of SkinJob, provided that all of them are finite and a
// vertex' weights add up to 1 within 2 units in the last place, as the baker writes them.
//
// How: a leaf's vertices lie within rho of x at rest; w_b are its mid weights, d_b the greatest distance of a vertex'
// weight from them, M_b = (R_b; t_b) the bones' matrices. With the centre m = sum w_b M_b x and R = sum w_b R_b, every
// vertex lies within the smaller of
//   max_b |M_b x - m| + rho |R_b|    and    rho |R| + sum_b d_b (|M_b x - m| + |R_b - R| rho)
// of m. |R| and |R_b| are bounds of the spectral norm: the root of the greatest row sum of |R^T R|, which is 1 for a
// rotation; |R_b - R| is the Frobenius norm. A morph target of weight a whose deltas lie within s of e moves x by a e
// and adds |a| s to rho.
//
// Roundings: with u = 2^-24, X = |x| + |y| + |z| + rho (and as much for each morph, times |a|), T_b = max |t_b|,
// Q = max_b (|R_b| X + T_b), D = sum d_b, and N the bones and moving morph targets of the leaf's group of eight, the
// radius is larger by u Q (64 + 8 N + (64 + 16 N) D), for which runtime/src/cover_kernel.cpp has the sum. And by
// 2^-60 (X + 1) (1 + D), for squares that are less than a float can be: poses shrunk to whatever size are covered too,
// also where the processor takes subnormal floats as zero.
//
// The arithmetic is fixed, in single precision, so that every backend gives the same balls, bit for bit.
//
// Fill in the fields and call run(). Allocates nothing, takes no lock; jobs on other buffers may run at the same time.
struct SPHERECHAIN_API CoverJob {
  const Asset* asset = nullptr;     // open, with leaves and bones
  BoneMatrices bones;               // as RefitBonesJob takes them: at least asset->bone_count()
  Span<const float> morph_weights;  // empty where nothing morphs, or at least asset->morph_count()
  Target target = Target::kBest;

  Span<Sphere> leaves;   // out: at least asset->leaf_count(); further entries are left alone
  Span<Sphere> spheres;  // out, or empty: balls around the leaves of each sphere, at least asset->spheres().size; of
                         // one without leaves a radius of 0 at its rest centre

  // kOk, kNullArgument, kNotOpen, kBadArgument, kBadStride, kNotInAsset, kTooFewBones, kTooFewMorphs, kTooFewSpheres,
  // kUnsupportedTarget, kMisaligned or kSharedMemory; nothing is written unless kOk. Matrices and weights that are not
  // finite give balls that mean nothing.
  Status run() const noexcept;
};

}  // namespace spherechain

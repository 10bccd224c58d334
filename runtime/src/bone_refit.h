// SPDX-License-Identifier: MIT
// Refit from bones, its arguments checked: what RefitBonesJob and jobs on crowds share.
#pragma once

#include <cstddef>

#include "memory.h"
#include "spherechain/refit_bones.h"
#include "spherechain/simd.h"

namespace spherechain {

// MomentTables as bare arrays. Only where the rule is kMoments.
struct MomentInputs {
  Vec3 origin;
  std::uint32_t reference;
  bool own_are_upper;
  std::size_t batch_count;
  const MomentBatch* batches;
  const BonePair* pairs;
  const std::uint32_t* spheres;
  const std::uint8_t* bone_counts;
  const std::uint16_t* bones;
  const CenterTerm* centers;
  const std::uint8_t* pair_places;
  const Moment* moments;
};

// What the kernels read: bare arrays, for they are compiled once a target and may use no inline function of the
// headers.
struct BoneRefitInputs {
  const RestSphere* rest;
  std::size_t sphere_count, group_count, bone_count;
  const PivotLanes* weights;
  const std::uint32_t* term_counts;
  const std::uint32_t* term_bones;
  const BoneTerm* terms;
  const std::uint32_t* morph_term_counts;
  const std::uint32_t* morph_targets;
  const MorphTerm* morph_terms;
  MomentInputs moments;
  RefitRule rule;

  const float* matrices;
  std::size_t stride;  // floats
  MatrixLayout layout;
  const float* morph_weights;  // null where nothing morphs
  RadiusKind radius;
};

// kOk where RefitBonesJob may run on these, its target and outputs aside.
Status check_bone_inputs(const Asset* asset, const BoneMatrices& bones, Span<const float> morph_weights,
                         RadiusKind radius);

// The memory of the first `count` of them, at least one, whose layout and stride are checked.
MemoryRange range_of_matrices(const BoneMatrices& bones, std::size_t count);

// Of arguments that are checked.
BoneRefitInputs bone_refit_inputs(const Asset& asset, const BoneMatrices& bones, Span<const float> morph_weights,
                                  RadiusKind radius);

// Refits all spheres of the asset. For further characters of one asset change `matrices` and `morph_weights`.
void refit_from_bones(const BoneRefitInputs& inputs, Target resolved, Sphere* spheres);

// The same, by the pivots (kPaper, kCalibrated) and by moments.
void refit_from_pivots(const BoneRefitInputs& inputs, Target resolved, Sphere* spheres);
void refit_from_moments(const BoneRefitInputs& inputs, Target resolved, Sphere* spheres);

}  // namespace spherechain

// SPDX-License-Identifier: MIT
// Refit from bones, its arguments checked: what RefitBonesJob and jobs on crowds share.
#pragma once

#include <cstddef>

#include "memory.h"
#include "spherechain/refit_bones.h"
#include "spherechain/simd.h"

namespace spherechain {

// What the kernel reads: bare arrays, for it is compiled once a target and may use no inline function of the headers.
struct BoneRefitInputs {
  const RestSphere* rest;
  std::size_t sphere_count, group_count;
  const PivotLanes* weights;
  const std::uint32_t* term_counts;
  const std::uint32_t* term_bones;
  const BoneTerm* terms;
  const std::uint32_t* morph_term_counts;
  const std::uint32_t* morph_targets;
  const MorphTerm* morph_terms;
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

}  // namespace spherechain

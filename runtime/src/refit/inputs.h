// SPDX-License-Identifier: MIT
// The inputs of refit by moments. Kernels use the spans' pointers alone: they are compiled once a target and may use no
// inline function of the headers.
#pragma once

#include <cstddef>

#include "runtime/src/pose/pose.h"

namespace spherechain {

struct RefitInputs {
  const RestSphere* rest;
  std::size_t sphere_count, bone_count;
  const MomentTables* moments;
  const float* matrices;
  std::size_t stride;  // floats
  MatrixLayout layout;
  Radius radius;
};

// SC_OK where the pose's bones refit this open asset.
Status check_refit_bones(const AssetView& asset, const Pose& pose, Radius radius);

// Inputs for a checked pose. For further characters of one asset change `matrices`.
RefitInputs refit_inputs(const AssetView& asset, const Pose& pose, Radius radius);

void refit_from_moments(const RefitInputs& inputs, Target resolved, Sphere* spheres);

}  // namespace spherechain

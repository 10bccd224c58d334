// SPDX-License-Identifier: MIT
// Where are the character's spheres in this pose?
#pragma once

#include <cstddef>
#include <cstdint>

#include "spherechain/pose.h"

namespace spherechain {

// Moves the spheres with the bones, or with the deformed vertices. From bones it never touches the mesh: a sphere's
// centre and radius are the moments of its pivots, which follow from the matrices (docs/arithmetic.md). Both ways give
// the same spheres but for rounding. Where the pose has both, bones are taken. Morph weights move no sphere. Matrices
// and vertices that are not finite give spheres that are not finite; they touch nothing. The job needs 40 KiB of stack.
struct RefitJob {
  const Asset* asset = nullptr;  // open
  Pose pose;                     // bones or vertices
  Radius radius{};
  Target target{};
  Sphere* spheres = nullptr;  // out: the asset's, in its order; in the pose's space
  std::size_t sphere_capacity = 0;

  // SC_OK, or an error, after which nothing is written. SC_NOT_IN_ASSET: the pose has bones, but the asset has none, or
  // is of profile `paper`.
  Status run() const noexcept;
};

}  // namespace spherechain

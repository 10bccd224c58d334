// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "baker/mesh/mesh.h"

namespace spherechain::baker {

// The self-intersection volume of Herrmann et al. (arXiv 2605.26744, "human sphere proxy"): the character is scaled by
// the sphere around its rest pose to a radius of 1, and its skin's winding number is taken in the middle of each voxel.
// Voxels that it winds around twice or more count as often as it does. The result is their share of all voxels inside.
// With voxels of 0.06, 5 cm on a human, a hand that is 2 cm deep may count nothing or twice its volume; layers that lie
// in each other at rest count in every pose, and open skins as their open sides come to lie.
class VoxelVolume {
 public:
  inline static constexpr double kCoarse = 0.06, kFine = 0.02;

  // `triangles` must outlive it.
  VoxelVolume(const std::vector<Vec3>& rest, const std::vector<Triangle>& triangles);
  // The share in a pose of the same triangles, 0 to 1.
  double share(const std::vector<Vec3>& positions, double voxel) const;

 private:
  const std::vector<Triangle>& triangles_;
  double radius_;
};

}  // namespace spherechain::baker

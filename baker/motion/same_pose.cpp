// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/motion/same_pose.h"

namespace spherechain::baker {

bool same_pose(const Deformation& first, const Deformation& last, const BodyFrame& axes) {
  if (first.bones.empty() || first.morphs != last.morphs) return false;
  constexpr double kSame = 0.002;  // of the height
  const Affine moved = last.bones[0] * first.bones[0].inverse();
  for (std::size_t b = 0; b < first.bones.size(); ++b) {
    for (const double y : {0.0, 1.0}) {
      for (const double x : {-0.5, 0.5}) {
        const Vec3 p = axes.origin + axes.height * (y * axes.up + x * axes.left);
        if (!((moved * (first.bones[b] * p) - last.bones[b] * p).norm() < kSame * axes.height)) return false;
      }
    }
  }
  return true;
}

}  // namespace spherechain::baker

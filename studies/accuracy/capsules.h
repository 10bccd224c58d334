// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/play/play.h"
#include "baker/truth/score.h"
#include "baker/truth/truth.h"

namespace spherechain::baker {

// All points within `radius` of the segment.
struct Capsule {
  Vec3 from, to;
  double radius;
};

// Around points that each stand for some area: along their principal axis, its ends where the points end, its radius
// this quantile, by area, of their distances (as a sphere's detect radius).
Capsule fit_capsule(const std::vector<Vec3>& points, const std::vector<double>& areas, double quantile);

// Negative where they overlap.
double gap(const Capsule& a, const Capsule& b);

// The ragdoll that games have instead of spheres on chains: a capsule a bone, around the triangles that the bone moves
// most. Bones that follow one another on the skeleton are ignored; as for spheres, others are reported where they have
// come nearer than 0.9 of their distance at rest, axis to axis.
class CapsuleRagdoll {
 public:
  // Empty where no bones move the source.
  CapsuleRagdoll(const AnimatedAsset& animated, const TruthSurface& surface, double quantile);

  const std::vector<Capsule>& capsules() const { return capsules_; }
  // The same triangles, each owned by a capsule in place of a sphere.
  const TruthSurface& surface() const { return surface_; }
  bool is_ignored(std::uint32_t a, std::uint32_t b) const;

  // The pairs of capsules that touch in a frame; sorted. A capsule is carried rigidly, its radius as it is.
  std::vector<Pair> pairs(const Deformation& deformation) const;

  // The spheres' true pairs by capsules. True pairs within one capsule become a pair of that capsule with itself, which
  // is never reported.
  FrameTruth by_capsules(const FrameTruth& truth) const;

 private:
  TruthSurface surface_;
  std::vector<Capsule> capsules_;  // rest
  std::vector<std::size_t> bone_;  // of each
  std::vector<std::vector<bool>> ignored_;
};

}  // namespace spherechain::baker

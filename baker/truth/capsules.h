// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "play/play.h"
#include "truth/score.h"
#include "truth/truth.h"

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

// The usual alternative to spheres on chains: one capsule per bone, around the triangles that the bone moves most.
// Neighbours on the skeleton are ignored. As for spheres, other pairs are reported if their axes come nearer than 0.9
// of their distance at rest.
class CapsuleRagdoll {
 public:
  // Empty where no bones move the source.
  CapsuleRagdoll(const AnimatedAsset& animated, const TruthSurface& surface, double quantile);

  const std::vector<Capsule>& capsules() const { return capsules_; }
  // The same triangles, each owned by a capsule in place of a sphere.
  const TruthSurface& surface() const { return surface_; }
  bool is_ignored(std::uint32_t a, std::uint32_t b) const;

  // Sorted pairs of capsules that touch in a frame. Capsules move rigidly and keep their radius.
  std::vector<Pair> pairs(const Deformation& deformation) const;

  // The spheres' true pairs by capsules. Those within one capsule are a pair with itself, which is never reported.
  FrameTruth by_capsules(const FrameTruth& truth) const;

 private:
  TruthSurface surface_;
  std::vector<Capsule> capsules_;  // rest
  std::vector<std::size_t> bone_;  // of each
  std::vector<std::vector<bool>> ignored_;
};

}  // namespace spherechain::baker

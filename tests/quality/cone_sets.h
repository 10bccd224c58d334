// SPDX-License-Identifier: GPL-3.0-or-later
// Sets of cones from an asset's spheres, for cone_study.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cone.h"
#include "play/play.h"
#include "truth/surface.h"

namespace spherechain::quality {

// Links of spheres and what they stand for. A sphere alone is linked with itself.
struct ConeSet {
  std::string name;
  std::vector<Pair> links;
  std::vector<double> factor;                      // of each sphere: what its detect radius is multiplied with
  std::vector<std::uint32_t> owner;                // a place in the surface -> its link
  std::vector<std::vector<baker::Index>> of_link;  // places in the surface
  std::vector<std::vector<bool>> ignored;          // by two links, as the runtime's tables have it

  Cone cone(std::size_t link, const std::vector<Sphere>& spheres) const;
  // Pairs of links that are not ignored; and for each the scale with which they touch, 9 where that is far above 2.
  std::vector<Pair> pairs() const;
  std::vector<double> touching_scales(const std::vector<Sphere>& spheres) const;
};

class ConeSets {
 public:
  ConeSets(const baker::AnimatedAsset& animated, const baker::TruthSurface& surface);

  const std::vector<Sphere>& rest() const { return rest_; }
  const std::vector<baker::Vec3>& centroids() const { return centroid_; }
  // The asset's own.
  ConeSet spheres() const;
  // Each run of spheres thinned to about a part: what goes is what the skin misses least. Along limbs neighbours are
  // linked, in a torso those of one level and those above each other, elsewhere by the shortest tree. Radii are the
  // 0.9 quantile, by area, of the distances of what is near a sphere, as detect radii are.
  ConeSet cones(double part) const;

 private:
  using Run = std::vector<std::uint32_t>;
  std::vector<Pair> links_of(const Run& run) const;
  Run thinned(Run run, double part) const;
  double cost(const Run& run, const std::vector<baker::Index>& triangles) const;
  double share_along(const Pair& link, const baker::Vec3& point) const;
  double axis_distance(const Pair& link, const baker::Vec3& point) const;
  void ignore_neighbours(ConeSet& set) const;

  const baker::AnimatedAsset& animated_;
  const baker::TruthSurface& surface_;
  std::vector<Sphere> rest_;
  std::vector<baker::Vec3> centroid_;
  std::vector<double> area_;
};

}  // namespace spherechain::quality

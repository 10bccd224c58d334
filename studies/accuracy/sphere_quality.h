// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "baker/fit/fit.h"
#include "baker/mesh/mesh.h"
#include "baker/mesh/surface_query.h"

namespace spherechain::baker {

// How well the union of some spheres fills a body or a part of it. Lengths are in the mesh's units.
struct SphereQuality {
  double coverage;           // share of the volume inside some sphere
  double outside;            // volume of the union outside the body, as a share of the part's volume
  double volume_ratio;       // of the union and the part: coverage + outside
  double protrusion_p95;     // depth outside the skin of the union's points outside
  double gap_mean, gap_p95;  // distance of the skin from the union, 0 where it is inside
  double uncovered;          // share of the skin's area outside the union
};

// A closed body as random points, the same in every run, so that sets of spheres can be compared.
class SampledBody {
 public:
  // Draws until `count` points lie inside, and as many points of the skin.
  SampledBody(const Mesh& body, std::size_t count);

  // A point belongs to the part its nearest triangle belongs to.
  using Part = std::function<bool(Index triangle)>;
  SphereQuality measure(const std::vector<Ball>& spheres, const Part& part) const;

 private:
  struct Sample {
    Vec3 point;
    Index triangle;  // the nearest one
  };
  SurfaceQuery surface_;
  std::vector<Sample> inside_, skin_;
  std::vector<Vec3> outside_;
};

}  // namespace spherechain::baker

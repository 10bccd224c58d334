// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "fit/fit.h"
#include "mesh/surface_query.h"

namespace spherechain::baker {

// Triangles with one sphere.
struct Piece {
  std::vector<Index> triangles;
  Ball ball;
  // The skin's area times its distance from the sphere, and the same of the sphere where it is outside the skin. What
  // is farther than a limit counts more.
  double error;
  double far_area;  // of the skin farther than the limit
};

// Fits spheres to pieces of a skin. The skin counts by points that stand for its area, not by triangles: of large ones
// a sphere is near a part only.
class PieceFitter {
 public:
  // Farther than `far` from its sphere the skin is badly fitted.
  PieceFitter(const Mesh& skin, double far);

  // The sphere that fits some triangles best.
  Piece fit(std::vector<Index> triangles) const;
  // The same, searched from a sphere that fits nearly.
  Piece fit_from(const Ball& ball, std::vector<Index> triangles) const;
  // The best of some ways to cut a piece in two; none where there is nothing to cut.
  std::optional<std::pair<Piece, Piece>> halve(const Piece& piece) const;
  // What a triangle adds to the error of a piece with this sphere.
  double error_of(Index triangle, const Ball& ball) const;

 private:
  struct Sample {
    Vec3 point;
    double area;
  };
  struct Samples {
    const Sample *first, *last;
    const Sample* begin() const { return first; }
    const Sample* end() const { return last; }
  };
  Samples of_triangle(Index t) const { return {samples_.data() + first_[t], samples_.data() + first_[t + 1]}; }
  std::vector<Sample> some_samples(const std::vector<Index>& triangles) const;
  double penalty(double distance) const;
  double protrusion(const Ball& ball, double bound) const;  // or more than `bound`
  Ball search(Ball ball, const std::vector<Sample>& samples, const Vec3& normal) const;
  Piece measured(std::vector<Index> triangles, const Ball& ball) const;

  const Mesh& mesh_;
  double far_;
  SurfaceQuery surface_;
  std::vector<Sample> samples_;     // of all triangles, one after another
  std::vector<std::size_t> first_;  // of each triangle
  std::vector<Vec3> directions_;
};

}  // namespace spherechain::baker

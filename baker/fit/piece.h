// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "baker/fit/fit.h"
#include "baker/mesh/surface_query.h"

namespace spherechain::baker {

// Points that stand for parts of the skin's area, by their numbers in a PieceFitter.
using Samples = std::vector<std::uint32_t>;

// Skin with one sphere.
struct Piece {
  Samples samples;
  Ball ball;
  // The skin's area times its distance from the sphere, and the same of the sphere where it is outside the skin. What
  // is farther than a limit counts more.
  double error;
  double far_area;  // of the skin farther than the limit
};

// Fits spheres to pieces of a skin. The skin counts by points that stand for its area, not by triangles: parts of a
// large one may have spheres of their own.
class PieceFitter {
 public:
  // Farther than `far` from its sphere the skin is badly fitted.
  PieceFitter(const Mesh& skin, double far);

  // The samples of some triangles.
  Samples samples_of(const std::vector<Index>& triangles) const;

  // The sphere that fits some skin best.
  Piece fit(Samples samples) const;
  // The same, searched from a sphere that fits nearly.
  Piece fit_from(const Ball& ball, Samples samples) const;
  // The best of some ways to cut a piece in two; none where there is nothing to cut.
  std::optional<std::pair<Piece, Piece>> halve(const Piece& piece) const;
  // The error that a sample adds to a piece with this sphere.
  double error_of(std::uint32_t sample, const Ball& ball) const;

 private:
  struct Sample {
    Vec3 point;
    double area;
    Index triangle;
  };
  std::vector<Sample> some_samples(const Samples& samples) const;
  double penalty(double distance) const;
  double protrusion(const Ball& ball, double bound) const;  // or more than `bound`
  Ball search(Ball ball, const std::vector<Sample>& samples, const Vec3& normal) const;
  Piece measured(Samples samples, const Ball& ball) const;

  const Mesh& mesh_;
  double far_;
  SurfaceQuery surface_;
  std::vector<Sample> samples_;     // of all triangles, one after another
  std::vector<std::size_t> first_;  // of each triangle
  std::vector<Vec3> directions_;
};

}  // namespace spherechain::baker

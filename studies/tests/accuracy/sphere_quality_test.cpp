// SPDX-License-Identifier: GPL-3.0-or-later
// The field's measures on spheres in a ball, where every one of them is known.
#include <doctest/doctest.h>

#include <cmath>

#include "closed_shapes.h"
#include "sphere_quality.h"

using namespace spherechain::baker;

namespace {

const Mesh& unit_ball() {
  static const Mesh mesh = build_character(ball_mesh(48), "ball").largest_piece.mesh;
  return mesh;
}

const SampledBody& sampled_ball() {
  static const SampledBody body(unit_ball(), 10000);
  return body;
}

SphereQuality quality_of(const Ball& sphere) {
  return sampled_ball().measure({sphere}, [](Index) { return true; });
}

}  // namespace

// 10,000 samples: a share has a standard error of at most 0.005; the mesh's facets are 0.2 % inside the ball.
TEST_CASE("a sphere of half the radius covers an eighth of the ball and leaves its skin half a radius away") {
  const SphereQuality q = quality_of({Vec3(0, 0, 0), 0.5});
  CHECK(q.coverage == doctest::Approx(0.125).epsilon(0.1));
  CHECK(q.outside == 0);
  CHECK(q.volume_ratio == q.coverage);
  CHECK(q.protrusion_p95 == 0);
  CHECK(q.gap_mean == doctest::Approx(0.5).epsilon(0.01));
  CHECK(q.gap_p95 == doctest::Approx(0.5).epsilon(0.01));
  CHECK(q.uncovered == 1);
}

TEST_CASE("a larger sphere covers the ball, sticks out by its shell, and leaves no skin uncovered") {
  const SphereQuality q = quality_of({Vec3(0, 0, 0), 1.08});
  CHECK(q.coverage == 1);
  CHECK(q.outside == doctest::Approx(std::pow(1.08, 3) - 1).epsilon(0.05));
  CHECK(q.protrusion_p95 == doctest::Approx(0.08).epsilon(0.1));
  CHECK(q.gap_mean == 0);
  CHECK(q.uncovered == 0);
}

TEST_CASE("a part counts only what is nearest to its triangles") {
  const auto upper = [](Index t) { return triangle_centroid(unit_ball(), t).z() > 0; };
  const SphereQuality q = sampled_ball().measure({{Vec3(0, 0, -0.5), 0.5}}, upper);  // touches the middle from below
  CHECK(q.coverage < 0.01);
  CHECK(q.uncovered == 1);
}

TEST_CASE("the same body gives the same samples") {
  const SampledBody again(unit_ball(), 10000);
  const Ball sphere{Vec3(0.3, 0.2, -0.1), 0.7};
  const auto all = [](Index) { return true; };
  CHECK(again.measure({sphere}, all).coverage == sampled_ball().measure({sphere}, all).coverage);
  CHECK(again.measure({sphere}, all).gap_mean == sampled_ball().measure({sphere}, all).gap_mean);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// The runtime's exact predicates against exact rationals, and its triangle test against CGAL's.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>
#include <doctest/doctest.h>
#include <gmpxx.h>

#include <cmath>
#include <limits>
#include <random>

#include "runtime/src/triangles/exact_orientation.h"
#include "runtime/src/triangles/exact_triangles.h"

namespace {

using spherechain::Vec2;
using spherechain::Vec3;
using Corners = spherechain::TriangleCorners;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

using Random = std::mt19937;
using Limits = std::numeric_limits<float>;

float uniform(Random& random, float low, float high) {
  return std::uniform_real_distribution<float>(low, high)(random);
}
int pick(Random& random, int count) { return std::uniform_int_distribution<int>(0, count - 1)(random); }

// Harmless, on a coarse grid, of all magnitudes, subnormal, huge.
float draw_coordinate(Random& random, int kind) {
  switch (kind) {
    case 0:
      return uniform(random, -1, 1);
    case 1:
      return static_cast<float>(pick(random, 5) - 2);
    case 2:
      return std::ldexp(uniform(random, -1, 1), pick(random, 276) - 148);
    case 3:
      return static_cast<float>(pick(random, 9) - 4) * Limits::denorm_min();
    case 4:
      return pick(random, 3) == 0 ? Limits::max() : -std::ldexp(uniform(random, 0.5F, 1), 128 - pick(random, 3));
    default:
      return 100 + uniform(random, -1e-4F, 1e-4F);  // far away and small
  }
}
constexpr int kKinds = 6;

Vec3 draw_point(Random& random, int kind) {
  return {draw_coordinate(random, kind), draw_coordinate(random, kind), draw_coordinate(random, kind)};
}

float nudge(Random& random, float x) {
  switch (pick(random, 4)) {
    case 0:
      return std::nextafter(x, -Limits::max());
    case 1:
      return std::nextafter(x, Limits::max());
    default:
      return x;
  }
}

// A point of the plane of a, b, c but for rounding, or for a step more.
Vec3 draw_beside(Random& random, const Vec3& a, const Vec3& b, const Vec3& c) {
  constexpr float kShares[] = {0, 1, 0.5F, -0.5F, 2};
  const bool round = pick(random, 2) == 0;
  const float s = round ? kShares[pick(random, 5)] : uniform(random, -1, 2);
  const float t = round ? kShares[pick(random, 5)] : uniform(random, -1, 2);
  const auto mix = [&](float p, float q, float r) {
    const double x = double{p} + double{s} * (double{q} - double{p}) + double{t} * (double{r} - double{p});
    const double limit = Limits::max();
    return nudge(random, static_cast<float>(std::min(std::max(x, -limit), limit)));
  };
  return {mix(a.x, b.x, c.x), mix(a.y, b.y, c.y), mix(a.z, b.z, c.z)};
}

int exact_side(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const auto row = [&](const Vec3& p, mpq_class(&out)[3]) {
    out[0] = mpq_class(p.x) - mpq_class(a.x);
    out[1] = mpq_class(p.y) - mpq_class(a.y);
    out[2] = mpq_class(p.z) - mpq_class(a.z);
  };
  mpq_class p[3], q[3], r[3];
  row(b, p), row(c, q), row(d, r);
  return sgn(mpq_class((p[1] * q[2] - p[2] * q[1]) * r[0] + (p[2] * q[0] - p[0] * q[2]) * r[1] +
                       (p[0] * q[1] - p[1] * q[0]) * r[2]));
}

int exact_side(const Vec2& a, const Vec2& b, const Vec2& c) {
  const mpq_class ax(a.x), ay(a.y);
  return sgn(mpq_class((b.x - ax) * (c.y - ay) - (b.y - ay) * (c.x - ax)));
}

CGAL::Triangle_3<Kernel> to_cgal(const Corners& t) {
  const auto point = [](const Vec3& p) { return CGAL::Point_3<Kernel>(p.x, p.y, p.z); };
  return {point(t.p[0]), point(t.p[1]), point(t.p[2])};
}

bool cgal_intersects(const Corners& a, const Corners& b) {
  const auto ta = to_cgal(a), tb = to_cgal(b);
  return !spherechain::is_point(a) && !spherechain::is_point(b) && !ta.is_degenerate() && !tb.is_degenerate() &&
         CGAL::do_intersect(ta, tb);
}

// Any; or with corners beside the plane, an edge or a corner of the first.
void draw_triangles(Random& random, Corners& a, Corners& b) {
  const int kind = pick(random, kKinds);
  for (Vec3& p : a.p) p = draw_point(random, kind);
  for (Vec3& p : b.p) {
    switch (pick(random, 4)) {
      case 0:
        p = a.p[pick(random, 3)];
        break;
      case 1:
        p = draw_point(random, pick(random, 8) == 0 ? pick(random, kKinds) : kind);
        break;
      default:
        p = draw_beside(random, a.p[0], a.p[1], a.p[2]);
    }
  }
}

}  // namespace

TEST_CASE("the side of a plane is that of exact rationals: random, degenerate, subnormal, huge, nearly in the plane" *
          doctest::test_suite("long runs")) {
  Random random(1);
  int counts[3] = {};
  for (int i = 0; i < 60000; ++i) {
    const int kind = pick(random, kKinds);
    const Vec3 a = draw_point(random, kind), b = draw_point(random, kind), c = draw_point(random, kind);
    const Vec3 d = pick(random, 3) == 0 ? draw_point(random, pick(random, kKinds)) : draw_beside(random, a, b, c);
    const int side = exact_side(a, b, c, d);
    ++counts[side + 1];
    REQUIRE(spherechain::side_of_plane(a, b, c, d) == side);
  }
  for (const int count : counts) CHECK(count > 3000);  // of each side, and of none
}

TEST_CASE("the side of a line is that of exact rationals") {
  Random random(2);
  int counts[3] = {};
  for (int i = 0; i < 60000; ++i) {
    const int kind = pick(random, kKinds);
    const Vec3 a = draw_point(random, kind), b = draw_point(random, kind);
    const Vec3 c = pick(random, 3) == 0 ? draw_point(random, pick(random, kKinds)) : draw_beside(random, a, b, a);
    const int side = exact_side(Vec2{a.x, a.y}, {b.x, b.y}, {c.x, c.y});
    ++counts[side + 1];
    REQUIRE(spherechain::side_of_line({a.x, a.y}, {b.x, b.y}, {c.x, c.y}) == side);
  }
  for (const int count : counts) CHECK(count > 6000);
}

TEST_CASE("200,000 pairs of triangles intersect where CGAL says so: any, touching, in one plane, nearly so" *
          doctest::test_suite("long runs")) {
  Random random(3);
  int intersecting = 0, different = 0;
  for (int i = 0; i < 200000; ++i) {
    Corners a, b;
    draw_triangles(random, a, b);
    const bool expected = cgal_intersects(a, b);
    intersecting += expected ? 1 : 0;
    different += spherechain::triangles_intersect(a, b) == expected ? 0 : 1;
    different += spherechain::triangles_intersect(b, a) == expected ? 0 : 1;
  }
  CHECK(different == 0);
  CHECK(intersecting > 20000);
  CHECK(intersecting < 180000);
}

TEST_CASE("triangles whose corners are on one line, or are not finite, intersect nothing") {
  const Corners triangle{{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}};
  const Corners line{{{0.5F, 0.5F, -1}, {0.5F, 0.5F, 0}, {0.5F, 0.5F, 1}}};
  const Corners point{{{0.5F, 0.5F, 0}, {0.5F, 0.5F, 0}, {0.5F, 0.5F, 0}}};
  CHECK(spherechain::triangles_intersect(triangle, triangle));
  for (const Corners& degenerate : {line, point}) {
    CHECK_FALSE(spherechain::triangles_intersect(triangle, degenerate));
    CHECK_FALSE(spherechain::triangles_intersect(degenerate, triangle));
    CHECK_FALSE(spherechain::triangles_intersect(degenerate, degenerate));
  }
  for (const float bad : {Limits::quiet_NaN(), Limits::infinity(), -Limits::infinity()}) {
    Corners spoiled = triangle;
    spoiled.p[1].y = bad;
    CHECK_FALSE(spherechain::triangles_intersect(triangle, spoiled));
    CHECK_FALSE(spherechain::triangles_intersect(spoiled, spoiled));
  }
}

TEST_CASE("triangles smaller than a millionth of their greatest coordinate intersect nothing") {
  const Corners large{{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}}};
  const auto upright = [](float x, float size, float height) {  // on edge across the plane of the large one
    return Corners{{{x, -size, -height}, {x, size, -height}, {x, 0, height}}};
  };
  for (const float place : {0.0F, 0.5F, -0.25F}) {
    CHECK(spherechain::triangles_intersect(large, upright(place, 1e-5F, 1e-5F)));
    CHECK(spherechain::triangles_intersect(large, upright(place, 0.1F, 1e-8F)));
  }
  CHECK(spherechain::triangles_intersect(large, upright(0, 1e-20F, 1e-20F)));  // no rounding there
  for (const float place : {0.5F, -0.25F}) {
    CHECK_FALSE(spherechain::triangles_intersect(large, upright(place, 5e-8F, 5e-8F)));
    CHECK_FALSE(spherechain::triangles_intersect(upright(place, 5e-8F, 5e-8F), large));
  }
}

TEST_CASE("the segment in which two triangles cross lies in both") {
  Random random(4);
  int count = 0;
  for (int i = 0; i < 40000; ++i) {
    Corners a, b;
    const bool flat = pick(random, 4) == 0;  // both in the plane z = 0
    for (Corners* t : {&a, &b}) {
      for (Vec3& p : t->p) p = {uniform(random, -1, 1), uniform(random, -1, 1), flat ? 0 : uniform(random, -1, 1)};
    }
    if (!cgal_intersects(a, b)) continue;
    ++count;
    const spherechain::Segment segment = spherechain::crossing_segment(a, b);
    for (const Vec3& point : {segment.from, segment.to}) {
      for (const Corners& t : {a, b}) {
        const CGAL::Point_3<Kernel> p(point.x, point.y, point.z);
        // Needles make the rounding of the point worse: none here is thinner than a thousandth.
        CHECK(CGAL::to_double(CGAL::squared_distance(p, to_cgal(t))) < 1e-10);
      }
    }
  }
  CHECK(count > 4000);
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Parts inside others, of shapes for which it is known.
#include <doctest/doctest.h>

#include <algorithm>

#include "two_shapes.h"

using Vec = spherechain::baker::Vec3;
using spherechain::Penetration;

namespace {

Vec way_of(const Penetration& of) {
  return double{of.distance} * Vec(double{of.direction.x}, double{of.direction.y}, double{of.direction.z});
}

Shape turned_inside_out(Shape shape) {
  for (auto& t : shape.triangles) std::swap(t[0], t[1]);
  return shape;
}

Shape double_sided(Shape shape) {
  const Shape back = turned_inside_out(shape);
  shape.triangles.insert(shape.triangles.end(), back.triangles.begin(), back.triangles.end());
  return shape;
}

}  // namespace

TEST_CASE("a ball inside a larger one is inside it, where no skins meet, and its way out is clear") {
  const Shape large = ball(1, 12), small = ball(0.2, 8);
  Shape open = large;
  open.triangles.resize(open.triangles.size() - 3);
  for (const Shape& around : {large, turned_inside_out(large), double_sided(large), open}) {
    const TwoShapes balls(around, small);
    for (const double x : {0.0, 0.5, 0.7}) {
      const Penetration found = only(balls.ask(shifted(x, 0.01, 0.02)));
      CHECK(found.kind == SC_CLASS_INSIDE);
      CHECK(found.part == 1);
      CHECK(found.measures.swallowed == 1);
      CHECK(found.measures.through == 0);
      CHECK(found.measures.contour_length == 0);
      CHECK(found.distance == doctest::Approx(1.2 - x).epsilon(0.05));
      const Vec out = Vec(x, 0.01, 0.02) + 1.001 * way_of(found);
      CHECK(balls.ask(shifted(out.x(), out.y(), out.z())).empty());
    }
    CHECK(balls.ask(shifted(1.3, 0, 0)).empty());
  }
}

TEST_CASE("a ball that goes into another is inside from where most of its core is, and mirrored answers are mirrored") {
  const TwoShapes balls(ball(1, 12), ball(0.3, 8));
  const auto mirrored = [](const Vec& p) { return Vec(-p.x(), p.y(), p.z()); };
  for (const double x : {1.1, 1.02, 0.94, 0.8}) {
    const Penetration found = only(balls.ask(shifted(x, 0, 0)));
    CHECK((found.kind == SC_CLASS_INSIDE) == (x < 1));
    CHECK(found.measures.contour_length > 0);
    const Penetration back = only(balls.ask(shifted(x, 0, 0), mirrored));
    CHECK(back.kind == found.kind);
    CHECK(back.measures.swallowed == found.measures.swallowed);
    CHECK(back.distance == doctest::Approx(found.distance).epsilon(0.01));
  }
}

TEST_CASE("as a ball sinks into another, its share, its depth and its fault depth grow without a jump") {
  constexpr double kStep = 0.002;
  const TwoShapes balls(ball(1, 12), ball(0.3, 8));
  Penetration before = only(balls.ask(shifted(1.2, 0.01, 0.02)));
  for (double x = 1.2 - kStep; x > 0.5; x -= kStep) {
    const Penetration now = only(balls.ask(shifted(x, 0.01, 0.02)));
    // The share jumps once, as the sphere's centre goes in: core points are not looked at before.
    const float first = before.measures.swallowed > 0 ? 0.0F : 0.5F;
    CHECK(now.measures.swallowed >= before.measures.swallowed);
    CHECK(now.measures.swallowed - before.measures.swallowed < 0.05F + first);
    CHECK(now.measures.depth - before.measures.depth == doctest::Approx(kStep).epsilon(0.05));
    CHECK(now.fault_depth - before.fault_depth > -kStep);
    CHECK(now.fault_depth - before.fault_depth < 10 * kStep);
    before = now;
  }
}

TEST_CASE("of a rod through a ball the share is inside that is nearer than the ball's skin") {
  const TwoShapes rod(ball(1.6, 12), capsule(0.1, 3, 8));
  const Penetration middle = only(rod.ask(shifted(0, 0, 0)));
  CHECK(middle.part == 1);
  CHECK(middle.kind == SC_CLASS_PENETRATION);
  CHECK(middle.measures.swallowed == doctest::Approx(1.6 / 3).epsilon(0.06));
  CHECK(only(rod.ask(shifted(0, 3, 0))).measures.swallowed == doctest::Approx(1.6 / 6).epsilon(0.06));
  CHECK(only(rod.ask(shifted(1.65, 0, 0))).measures.swallowed == 0);
}

TEST_CASE("of two bodies, parts that are ignored are inside nothing and hold nothing") {
  const TwoShapes balls(ball(1, 12), ball(0.2, 8));
  const auto inside = shifted(0.3, 0, 0);
  const std::uint64_t large = 1, small = 2;
  CHECK(balls.count_inside(inside, large, small) == 1);  // the first body's small ball in the other's large one
  CHECK(balls.count_inside(inside, small, large) == 1);
  CHECK(balls.count_inside(inside, large, large) == 1);  // the small balls in each other: the same place
  CHECK(balls.count_inside(inside, large | small, 0) == 0);
  CHECK(balls.count_inside(inside, 0, large | small) == 0);
}

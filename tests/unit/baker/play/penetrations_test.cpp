// SPDX-License-Identifier: GPL-3.0-or-later
// Depth, direction and volume of bodies for which they are known.
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "jobs.h"
#include "two_shapes.h"

using Vec = spherechain::baker::Vec3;
using Turn = Eigen::AngleAxisd;

namespace {

constexpr double kPi = std::numbers::pi;

// In which b, the second part, comes out.
Vec direction_of(const spherechain::Penetration& of) {
  return (of.part == 1 ? 1 : -1) * Vec(double{of.direction.x}, double{of.direction.y}, double{of.direction.z});
}

// The same shape, stored the other way round.
Shape reversed(Shape shape) {
  const auto count = static_cast<std::uint32_t>(shape.positions.size());
  std::reverse(shape.positions.begin(), shape.positions.end());
  std::reverse(shape.triangles.begin(), shape.triangles.end());
  for (auto& triangle : shape.triangles) {
    triangle = {count - 1 - triangle[1], count - 1 - triangle[2], count - 1 - triangle[0]};
  }
  return shape;
}

double lens(double r, double d) { return kPi * (4 * r + d) * (2 * r - d) * (2 * r - d) / 12; }

}  // namespace

TEST_CASE("two balls are as deep as their radii are longer than their distance, and part along it") {
  const TwoShapes balls(ball(1, 24), ball(1, 24));
  for (const double distance : {1.9, 1.5, 1.1}) {
    const spherechain::Penetration found = only(balls.measure(shifted(0, 0.6 * distance, -0.8 * distance)));
    CHECK(found.measures.depth == doctest::Approx(2 - distance).epsilon(0.01));
    CHECK(direction_of(found).dot(Vec(0, 0.6, -0.8)) > 0.99);
    REQUIRE(found.measures.volume >= 0);
    CHECK(found.measures.volume == doctest::Approx(lens(1, distance)).epsilon(0.01));
    CHECK(found.measures.contour_length ==
          doctest::Approx(2 * kPi * std::sqrt(1 - distance * distance / 4)).epsilon(0.01));
    CHECK(found.measures.visible == 1);
    CHECK(found.kind == (distance < 1.2 ? SC_CLASS_PENETRATION : SC_CLASS_TOUCH));
  }
}

TEST_CASE("boxes are as deep as their shortest overlap") {
  const TwoShapes boxes(box(1, 1, 1), box(0.5, 0.5, 0.5));
  const spherechain::Penetration found = only(boxes.measure(shifted(1.4, 0.3, 0.2)));
  CHECK(found.measures.depth == doctest::Approx(0.1).epsilon(1e-4));
  CHECK(direction_of(found).x() > 0.9999);
  CHECK(found.measures.volume == doctest::Approx(0.1).epsilon(1e-3));
  // The corner alone: 0.2 by 0.3 by 0.4.
  const spherechain::Penetration corner = only(boxes.measure(shifted(-1.3, 1.2, 1.1)));
  CHECK(corner.measures.depth == doctest::Approx(0.2).epsilon(1e-4));
  CHECK(direction_of(corner).x() < -0.9999);
  CHECK(corner.measures.volume == doctest::Approx(0.2 * 0.3 * 0.4).epsilon(1e-3));
}

TEST_CASE("tubes that cross part over each other's back") {
  const double radius = 0.3;
  const TwoShapes capsules(capsule(radius, 1, 12), capsule(radius, 1, 12)),
      cylinders(cylinder(radius, 1, 12), cylinder(radius, 1, 12));
  for (const TwoShapes* tubes : {&capsules, &cylinders}) {
    for (const double angle : {90.0, 50.0}) {
      const auto place = [&](const Vec& p) { return Vec(Turn(angle * kPi / 180, Vec::UnitX()) * p + Vec(0.4, 0, 0)); };
      const spherechain::Penetration found = only(tubes->measure(place));
      CHECK(found.measures.depth == doctest::Approx(2 * radius - 0.4).epsilon(0.01));
      CHECK(direction_of(found).x() > 0.99);
    }
  }
  // At right angles, axes in one plane: Steinmetz' solid.
  const spherechain::Penetration through =
      only(cylinders.measure([&](const Vec& p) { return Vec(p.x(), p.z(), -p.y()); }));
  CHECK(through.measures.depth == doctest::Approx(2 * radius).epsilon(0.01));
  CHECK(through.measures.volume == doctest::Approx(16.0 / 3 * radius * radius * radius).epsilon(0.01));
}

TEST_CASE("depth goes to zero where a contact ends, and is never zero") {
  const TwoShapes balls(ball(1, 12), ball(1, 12));
  double last = 1;
  for (const double distance : {1.9, 1.97, 1.98, 1.985}) {
    const auto found = balls.measure(shifted(distance, 0, 0));
    if (found.empty()) break;
    CHECK(found[0].measures.depth > 0);
    CHECK(double{found[0].measures.depth} < last);
    last = double{found[0].measures.depth};
  }
  CHECK(last < 0.03);
  const TwoShapes boxes(box(1, 1, 1), box(0.5, 0.5, 0.5));
  CHECK(only(boxes.measure(shifted(1.5, 0.3, 0.2))).measures.depth > 0);  // faces that touch
}

TEST_CASE("the deepest points are the ends of the way, and at its end the body is free") {
  const TwoShapes shapes(box(1, 1, 1), capsule(0.3, 0.5, 8));
  const auto place = [](const Vec& p) { return Vec(Turn(0.5, Vec(1, 2, 3).normalized()) * p + Vec(0.4, 1.3, -0.2)); };
  const spherechain::Penetration plain = only(shapes.measure(place));
  const spherechain::SkinPoint &a = plain.deepest_other, &b = plain.deepest;
  CHECK(plain.distance == plain.measures.depth);
  CHECK(a.position.x - b.position.x == doctest::Approx(plain.distance * plain.direction.x).epsilon(0.001));
  CHECK(a.position.y - b.position.y == doctest::Approx(plain.distance * plain.direction.y).epsilon(0.001));
  for (const spherechain::SkinPoint& point : {a, b}) {
    CHECK(point.weights[0] + point.weights[1] + point.weights[2] == doctest::Approx(1).epsilon(1e-4));
  }
  // Moved so far and a little farther it is free; nine tenths of the way it is not.
  const auto after = [&](double share) {
    return
        [&, share](const Vec& p) { return Vec(place(p) + share * double{plain.measures.depth} * direction_of(plain)); };
  };
  CHECK(shapes.measure(after(1.001)).empty());
  CHECK(!shapes.measure(after(0.9)).empty());
}

TEST_CASE("the answer turns, grows and mirrors with the bodies, in whatever order they are stored") {
  const Shape tile = box(1, 0.7, 1), pin = capsule(0.3, 0.5, 8);
  const TwoShapes shapes(tile, pin), shuffled(reversed(tile), reversed(pin));
  const auto place = [](const Vec& p) { return Vec(Turn(0.5, Vec(1, 2, 3).normalized()) * p + Vec(0.4, 1.1, -0.2)); };
  const spherechain::Penetration plain = only(shapes.measure(place));
  const auto check = [&](const spherechain::Penetration& found, double size, const Vec& direction) {
    CHECK(found.measures.depth == doctest::Approx(size * double{plain.measures.depth}).epsilon(1e-3));
    CHECK(direction_of(found).dot(direction) > 0.9999);
    CHECK(found.measures.volume == doctest::Approx(size * size * size * double{plain.measures.volume}).epsilon(1e-3));
    CHECK(found.kind == plain.kind);
  };
  const Turn turn(1.1, Vec(3, -1, 2).normalized());
  const Vec way = direction_of(plain);
  check(only(shapes.measure(place, {}, [&](const Vec& p) { return Vec(turn * p + Vec(5, 6, 7)); })), 1, turn * way);
  check(only(shapes.measure(place, {}, [](const Vec& p) { return Vec(2 * p); })), 2, way);
  check(only(shapes.measure(place, {}, [](const Vec& p) { return Vec(-p.x(), p.y(), p.z()); })), 1,
        {-way.x(), way.y(), way.z()});
  check(only(shuffled.measure(place)), 1, way);
}

TEST_CASE("a palette's scale changes lengths, and no class") {
  const TwoShapes balls(ball(1, 12), ball(1, 12));
  for (const double distance : {1.5, 1.95}) {
    const spherechain::Penetration plain = only(balls.measure(shifted(distance, 0, 0)));
    for (const float scale : {0.01F, 100.0F}) {
      float bones[24];
      for (int i = 0; i < 24; ++i) bones[i] = i % 12 % 5 == 0 ? scale : 0;
      bones[15] = scale * static_cast<float>(distance - 40);
      const auto with_bones = [&](spherechain::PenetrationJob& job) {
        job.pose.bones = bones;
        job.pose.bone_count = 2;
        job.pose.bone_layout = SC_ROWS_3X4;
      };
      const auto grown = [&](const Vec& p) { return Vec(double{scale} * p); };
      const spherechain::Penetration found = only(balls.measure(shifted(distance, 0, 0), with_bones, grown));
      CHECK(found.measures.depth == doctest::Approx(scale * plain.measures.depth).epsilon(1e-3));
      CHECK(found.kind == plain.kind);
    }
  }
}

TEST_CASE("a body that went most of the way in is not pushed inside") {
  const TwoShapes shapes(ball(2, 16), capsule(0.2, 0.5, 6));
  // Nearly all of the pin is in the ball: inwards is shorter, but there it would be lost.
  const spherechain::Penetration found = only(shapes.measure(shifted(0, 1.4, 0)));
  CHECK(direction_of(found).y() > 0.5);
  // A limb goes on in the one that it hangs on, and is never lost there: a crease has no inside.
  const TwoShapes limbs(ball(2, 16), capsule(0.2, 0.5, 6), 5, true);
  const spherechain::Penetration crease = only(limbs.measure(shifted(0, 1.4, 0)));
  CHECK(crease.measures.depth < found.measures.depth);
  CHECK(direction_of(crease).y() < -0.5);
}

TEST_CASE("spots that are near at rest make a fold, layers a shell, all others a penetration") {
  const auto kind = [](double gap) {  // at rest, of a body about 4 long
    const TwoShapes boxes(box(1, 1, 1), box(1, 1, 1), 2 + gap);
    return only(boxes.measure(shifted(1.9, 0, 0))).kind;
  };
  CHECK(kind(0.1) == SC_CLASS_SHELL);
  CHECK(kind(0.18) == SC_CLASS_FOLD);
  CHECK(kind(0.3) == SC_CLASS_PENETRATION);
}

TEST_CASE("a limb folds into the limb that it hangs on; others it penetrates") {
  const auto kind = [](bool is_child) {
    const TwoShapes rods(box(4, 1, 1), box(2, 0.8, 0.8), 12, is_child);
    return only(rods.measure(shifted(0.3, 1.4, 0.1))).kind;
  };
  CHECK(kind(false) == SC_CLASS_PENETRATION);
  CHECK(kind(true) == SC_CLASS_FOLD);
}

TEST_CASE("what a third layer hides is a shell, not a fault") {
  const auto found = [](const Shape& a) { return only(TwoShapes(a, box(1, 1, 1)).measure(shifted(1.6, 0.1, 0.2))); };
  Shape a = box(1, 1, 1);
  const spherechain::Penetration seen = found(a);
  CHECK(seen.measures.visible > 0.3F);
  CHECK(seen.kind == SC_CLASS_PENETRATION);

  const Shape around = box(6, 6, 6);
  const auto first = static_cast<std::uint32_t>(a.positions.size());
  a.positions.insert(a.positions.end(), around.positions.begin(), around.positions.end());
  for (const auto& t : around.triangles) a.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  const spherechain::Penetration hidden = found(a);
  CHECK(hidden.measures.visible == 0);
  CHECK(hidden.kind == SC_CLASS_SHELL);
}

TEST_CASE("bodies below suits, or with linings, have the faults of bare ones: the outermost layers alone count" *
          doctest::test_suite("long runs")) {
  const auto with_layer = [](const Shape& outer, double scale, bool is_lining) {
    Shape out = outer;
    const auto first = static_cast<std::uint32_t>(outer.positions.size());
    for (const Vec& p : outer.positions) out.positions.push_back(scale * p);
    for (const auto& [a, b, c] : outer.triangles) {
      out.triangles.push_back(is_lining ? std::array{first + a, first + c, first + b}
                                        : std::array{first + a, first + b, first + c});
    }
    return out;
  };
  const Shape wall = box(1, 1, 1), arm = capsule(0.3, 0.8, 12);
  const auto into_wall = shifted(0.7, 0, 0);
  const spherechain::Penetration bare = only(TwoShapes(wall, arm).measure(into_wall));
  REQUIRE(bare.kind == SC_CLASS_PENETRATION);
  for (const bool is_lining : {false, true}) {
    const TwoShapes suited(with_layer(wall, 0.97, is_lining), with_layer(arm, 0.9, is_lining));
    for (const int quick : {0, 1}) {
      const auto found = only(suited.measure(into_wall, [&](auto& job) { job.quick = quick; }));
      CHECK(found.kind == SC_CLASS_PENETRATION);
      CHECK(found.measures.contour_length == doctest::Approx(bare.measures.contour_length).epsilon(1e-4));
      CHECK(found.measures.visible == bare.measures.visible);
      if (quick == 0) CHECK(found.measures.volume == doctest::Approx(bare.measures.volume).epsilon(1e-3));
    }
  }
}

TEST_CASE("what a scale shrinks to a point meets nothing") {
  const TwoShapes balls(ball(1, 6), ball(1, 6));
  const auto scaled = [](double x, double y, double z) {
    return [=](const Vec& p) { return Vec(Vec(0.3, 1.1, 0.7) + Vec(x * p.x(), y * p.y(), z * p.z())); };
  };
  CHECK(balls.measure(shifted(1, 0, 0), {}, scaled(0.01, 0.01, 0.01)).size() == 1);
  for (const double scale : {0.0, 1e-20, 1e-8, -1e-8}) {
    CHECK(balls.measure(shifted(1, 0, 0), {}, scaled(scale, scale, scale)).empty());
  }
}

TEST_CASE("skins touch up to 3 mm, and up to ten times that where little of the smaller part is seen to go in") {
  // 1.8 m long.
  const auto kind = [](const Shape& b, double depth) {
    const double half = -b.positions[0][0];
    return only(TwoShapes(box(0.2, 0.2, 0.2), b, 1.4).measure(shifted(0.2 + half - depth, 0.03, 0.02))).kind;
  };
  const Shape block = box(0.1, 0.1, 0.1), stick = box(0.1, 0.015, 0.015);
  for (const Shape& shape : {block, stick}) CHECK(kind(shape, 0.0028) == SC_CLASS_TOUCH);
  for (const double depth : {0.005, 0.02, 0.03}) CHECK(kind(block, depth) == SC_CLASS_TOUCH);
  CHECK(kind(block, 0.036) == SC_CLASS_PENETRATION);
  CHECK(kind(stick, 0.005) == SC_CLASS_TOUCH);
  for (const double depth : {0.025, 0.03, 0.1}) CHECK(kind(stick, depth) == SC_CLASS_PENETRATION);
}

TEST_CASE("with a touch depth of the caller's, depth alone tells a touch") {
  const TwoShapes shapes(box(0.2, 0.2, 0.2), box(0.1, 0.1, 0.1), 1.4);
  const auto kind = [&](float limit) {
    spherechain::Rule rule = sc_default_rule();
    rule.touch_depth = limit;
    const auto set = [&](spherechain::PenetrationJob& job) { job.rule = &rule; };
    return only(shapes.measure(shifted(0.28, 0.03, 0.02), set)).kind;
  };
  CHECK(kind(0) == SC_CLASS_TOUCH);
  CHECK(kind(0.019F) == SC_CLASS_PENETRATION);
  CHECK(kind(0.021F) == SC_CLASS_TOUCH);
}

TEST_CASE("the quick form finds the faults of the full one, and the rest alike") {
  const TwoShapes balls(ball(1, 16), ball(1, 16));
  const auto quickly = [](spherechain::PenetrationJob& job) { job.quick = 1; };
  for (const double distance : {0.9, 1.36, 1.8}) {
    const spherechain::Penetration full = only(balls.measure(shifted(distance, 0.4, 0)));
    spherechain::Penetration quick = only(balls.measure(shifted(distance, 0.4, 0), quickly));
    CHECK(quick.kind == full.kind);
    CHECK(quick.measures.depth == doctest::Approx(full.measures.depth).epsilon(0.05));
    if (!spherechain::is_fault(full.kind)) continue;
    quick.measures.volume = full.measures.volume;
    CHECK(spherechain::test::same_bits<spherechain::Penetration>({quick}, {full}));
  }
}

TEST_CASE("the direction of a fault stays while it is nearly as good as the shortest; depth and class do not care") {
  const TwoShapes balls(ball(1, 16), ball(1, 16));
  const auto place = shifted(0.9, 0.4, 0);
  const spherechain::Penetration full = only(balls.measure(place));
  REQUIRE(full.kind == SC_CLASS_PENETRATION);
  const auto after = [&](const spherechain::Vec3& direction) {
    spherechain::Penetration last = full;
    last.direction = direction;
    const spherechain::Penetration out = only(balls.measure(place, [&](spherechain::PenetrationJob& job) {
      job.previous = &last;
      job.previous_count = 1;
    }));
    CHECK(out.kind == full.kind);
    CHECK(out.measures.depth == full.measures.depth);
    return out;
  };
  // Out on the other side, all directions are far worse than the best. At 65 degrees some between the two are not.
  CHECK(after({-full.direction.x, -full.direction.y, -full.direction.z}).distance == full.distance);
  const spherechain::Penetration across = after({0.42F * full.direction.x, 0.42F * full.direction.y, 0.9F});
  CHECK(across.distance > full.distance);
  CHECK(across.distance <= 1.25F * full.distance);
  CHECK(across.direction.z > full.direction.z + 0.05F);
}

TEST_CASE(
    "a fault of the frame before stays one until it is clearly shallower than is allowed, whichever part was named "
    "first") {
  const TwoShapes balls(ball(1, 16), ball(1, 16));
  const auto place = shifted(1.5, 0, 0);
  const spherechain::Penetration alone = only(balls.measure(place));
  spherechain::Rule rule = sc_default_rule();
  for (const bool swaps : {false, true}) {
    spherechain::Penetration last = alone;
    last.kind = SC_CLASS_PENETRATION;
    if (swaps) std::swap(last.part, last.other);
    const auto kind = [&](float allowed, bool has_history) {
      rule.touch_depth = allowed * alone.measures.depth;
      const spherechain::Penetration out = only(balls.measure(place, [&](spherechain::PenetrationJob& job) {
        job.rule = &rule;
        job.previous = &last;
        job.previous_count = has_history ? 1 : 0;
      }));
      CHECK((out.fault_depth > 0) == (allowed < 1));
      return out.kind;
    };
    CHECK(kind(0.99F, false) == SC_CLASS_PENETRATION);
    CHECK(kind(1.01F, false) == SC_CLASS_TOUCH);
    CHECK(kind(1.01F, true) == SC_CLASS_PENETRATION);
    CHECK(kind(1.4F, true) == SC_CLASS_PENETRATION);
    CHECK(kind(1.45F, true) == SC_CLASS_TOUCH);
    last.kind = SC_CLASS_TOUCH;
    CHECK(kind(1.01F, true) == SC_CLASS_TOUCH);
  }
}

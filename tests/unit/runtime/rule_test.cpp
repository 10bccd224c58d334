// SPDX-License-Identifier: MIT
// The rule that makes a class of measurements, one limit at a time.
#include "depth/rule.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

using namespace spherechain;

namespace {

// A hand that goes 50 mm into a thigh of a human of 1.75 m in metres.
Measures hand_in_thigh() {
  Measures out{1.75, 1, Relation::kApart, false, true, 0.3, 0, 0.1};
  out.depth = 0.05;
  out.swallowed = 1;
  return out;
}

}  // namespace

TEST_CASE("a class changes at its limit, and what is measured beyond that changes nothing") {
  struct Row {
    double Measures::*measure;
    double below, above;
    PenetrationClass class_below, class_above;
  };
  const Rule rule;
  const Row rows[] = {
      {&Measures::touching, 0.49, 0.5, SC_CLASS_PENETRATION, SC_CLASS_REST},
      {&Measures::visible, 0.29, 0.31, SC_CLASS_SHELL, SC_CLASS_PENETRATION},
      {&Measures::depth, 0.0033, 0.0034, SC_CLASS_TOUCH, SC_CLASS_PENETRATION},  // 0.19 % of the height, above 3 mm
      {&Measures::rest_distance, 0.054, 0.056, SC_CLASS_FOLD, SC_CLASS_PENETRATION},
  };
  for (const Row& row : rows) {
    Measures of = hand_in_thigh();
    of.*row.measure = row.below;
    CHECK(classify(rule, of) == row.class_below);
    of.*row.measure = row.above;
    CHECK(classify(rule, of) == row.class_above);
  }
}

TEST_CASE("a fold depends on how the parts hang together, and is a fault once it is deep") {
  const Rule rule;
  Measures of = hand_in_thigh();
  of.rest_distance = 0.1;
  CHECK(classify(rule, of) == SC_CLASS_PENETRATION);
  of.relation = Relation::kSiblings;
  CHECK(classify(rule, of) == SC_CLASS_FOLD);
  of.relation = Relation::kNear;
  CHECK(classify(rule, of) == SC_CLASS_PENETRATION);
  of.facing = 0.3;  // a thigh lies flat on the abdomen
  CHECK(classify(rule, of) == SC_CLASS_FOLD);
  of.relation = Relation::kJoined;
  of.rest_distance = 0.3;
  CHECK(classify(rule, of) == SC_CLASS_FOLD);
  of.depth = 0.08;
  CHECK(classify(rule, of) == SC_CLASS_DEEP_FOLD);
  of.is_one_piece = false;  // skin in cloth
  CHECK(classify(rule, of) == SC_CLASS_FOLD);
  of.rest_distance = 0.03;
  CHECK(classify(rule, of) == SC_CLASS_SHELL);
  of.are_two_bodies = true;
  of.rest_distance = std::numeric_limits<double>::infinity();
  CHECK(classify(rule, of) == SC_CLASS_PENETRATION);
}

TEST_CASE("little that goes in touches up to ten times the depth, unless a depth is given") {
  Measures of = hand_in_thigh();
  of.depth = 0.03;
  of.swallowed = 0.2;
  CHECK(depends_on_swallowed({}, of));
  CHECK(classify({}, of) == SC_CLASS_TOUCH);
  CHECK(classify(rule_of(0.02F), of) == SC_CLASS_PENETRATION);
  CHECK_FALSE(depends_on_swallowed(rule_of(0.02F), of));
  of.depth = 0.034;
  CHECK(classify({}, of) == SC_CLASS_PENETRATION);
  CHECK_FALSE(depends_on_swallowed({}, of));
  // Files without a unit make giants and dwarfs: their touches are shares of the height.
  CHECK(touch_depth_of({}, 1, 175) == doctest::Approx(0.0019 * 175));
  CHECK(touch_depth_of({}, 1, 0.0175) == doctest::Approx(0.0066 * 0.0175));
}

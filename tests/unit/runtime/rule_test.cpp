// SPDX-License-Identifier: MIT
// The rule that makes a class of measurements, one limit at a time.
#include "runtime/src/penetrations/rule.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

using namespace spherechain;

namespace {

// A hand that goes 50 mm into a thigh of a human of 1.75 m in metres.
Measures hand_in_thigh() {
  Measures out{};
  out.height = 1.75F;
  out.metre = 1;
  out.is_one_piece = 1;
  out.rest_distance = 0.3F;
  out.facing = 0.1F;
  out.visible = 1;
  out.depth = 0.05F;
  out.extent = 1;
  return out;
}

PenetrationClass classify(const Measures& of, float touch_depth = 0) {
  Rule rule = sc_default_rule();
  rule.touch_depth = touch_depth;
  return sc_classify(&rule, &of);
}

}  // namespace

TEST_CASE("a class changes at its limit, and what is measured beyond that changes nothing") {
  struct Row {
    float Measures::*measure;
    float below, above;
    PenetrationClass class_below, class_above;
  };
  const auto below = [](float limit) { return std::nextafter(limit, 0.0F); };
  const Row rows[] = {
      {&Measures::touching, below(0.5F), 0.5F, SC_CLASS_PENETRATION, SC_CLASS_REST},
      {&Measures::visible, below(0.3F), 0.3F, SC_CLASS_SHELL, SC_CLASS_PENETRATION},
      {&Measures::depth, 0.0033F, 0.0034F, SC_CLASS_TOUCH, SC_CLASS_PENETRATION},  // 0.19 % of the height, above 3 mm
      // 50 mm are 2.86 % of the height: 63 % of what a fold may have.
      {&Measures::rest_distance, 0.047F, 0.049F, SC_CLASS_FOLD, SC_CLASS_DEEP_FOLD},
      {&Measures::rest_distance, below(0.055F), 0.055F, SC_CLASS_DEEP_FOLD, SC_CLASS_PENETRATION},
      {&Measures::swallowed, below(0.6F), 0.6F, SC_CLASS_PENETRATION, SC_CLASS_INSIDE},
  };
  Measures thin = hand_in_thigh();
  thin.depth = 0.02F;
  thin.extent = below(0.25F);
  CHECK(classify(thin) == SC_CLASS_TOUCH);
  thin.extent = 0.25F;
  CHECK(classify(thin) == SC_CLASS_PENETRATION);
  for (const Row& row : rows) {
    Measures of = hand_in_thigh();
    of.*row.measure = row.below;
    CHECK(classify(of) == row.class_below);
    of.*row.measure = row.above;
    CHECK(classify(of) == row.class_above);
    CHECK(sc_classify(nullptr, &of) == row.class_above);
  }
}

TEST_CASE("a fault that goes through a part is inside it, and what is no fault stays none") {
  Measures of = hand_in_thigh();
  for (const float depth : {0.001F, 0.05F}) {
    of.depth = depth;
    of.through = 0;
    const PenetrationClass kind = classify(of);
    of.through = 1;
    CHECK(classify(of) == (is_fault(kind) ? SC_CLASS_INSIDE : kind));
  }
}

TEST_CASE("a fold depends on how the parts hang together, and is a fault once it is deep") {
  Measures of = hand_in_thigh();
  of.rest_distance = 0.09F;
  CHECK(classify(of) == SC_CLASS_PENETRATION);
  for (const Relation near : {SC_RELATION_SIBLINGS, SC_RELATION_NEAR}) {
    of.relation = near;
    of.rest_distance = 0.09F;
    CHECK(classify(of) == SC_CLASS_FOLD);
    of.rest_distance = 0.11F;
    CHECK(classify(of) == SC_CLASS_PENETRATION);
  }
  of.relation = SC_RELATION_JOINED;
  of.rest_distance = 0.3F;
  CHECK(classify(of) == SC_CLASS_FOLD);
  of.depth = 0.08F;
  CHECK(classify(of) == SC_CLASS_DEEP_FOLD);
  of.is_one_piece = 0;  // a sleeve on its arm
  of.depth = 0.3F;
  CHECK(classify(of) == SC_CLASS_FOLD);
  of.relation = SC_RELATION_TWO_BODIES;
  of.rest_distance = std::numeric_limits<float>::infinity();
  CHECK(classify(of) == SC_CLASS_PENETRATION);
}

TEST_CASE("layers of one place are a fault where they go far beyond what they may") {
  Measures of = hand_in_thigh();
  of.is_one_piece = 0;
  of.rest_distance = 0.02F;
  CHECK(classify(of) == SC_CLASS_SHELL);
  of.depth = 0.15F;  // 0.14 is allowed
  CHECK(classify(of) == SC_CLASS_PENETRATION);
  of.relation = SC_RELATION_JOINED;
  CHECK(classify(of) == SC_CLASS_SHELL);
}

TEST_CASE("fault depth is 0 where there is no fault, and small steps of any measure change it little") {
  const Rule rule = sc_default_rule();
  const auto has_fault_depth = [&](const Measures& of) {
    CHECK(is_fault(classify(of)) == (fault_depth_of(rule, of) > 0));
    return fault_depth_of(rule, of);
  };
  Measures of = hand_in_thigh();
  CHECK(has_fault_depth(of) == doctest::Approx(0.05F - 0.0033F * 10 / 4).epsilon(0.01));
  struct Sweep {
    float Measures::*measure;
    float from, to;
  };
  const Sweep sweeps[] = {{&Measures::depth, 0.001F, 0.2F},           {&Measures::visible, 0.01F, 0.99F},
                          {&Measures::touching, 0.01F, 0.99F},        {&Measures::swallowed, 0.01F, 0.99F},
                          {&Measures::rest_distance, 0.001F, 0.199F}, {&Measures::extent, 0.05F, 2}};
  for (const Relation relation : {SC_RELATION_APART, SC_RELATION_NEAR, SC_RELATION_JOINED, SC_RELATION_TWO_BODIES}) {
    for (const float swallowed : {0.0F, 0.5F}) {
      for (const Sweep& sweep : sweeps) {
        of = hand_in_thigh();
        of.relation = relation;
        of.swallowed = swallowed;
        constexpr int kSteps = 1000;
        float last = -1;
        for (int i = 0; i <= kSteps; ++i) {
          of.*sweep.measure = sweep.from + (sweep.to - sweep.from) * static_cast<float>(i) / kSteps;
          const float now = has_fault_depth(of);
          if (last >= 0) CHECK(std::abs(now - last) < 0.001F);
          last = now;
        }
      }
    }
  }
}

TEST_CASE("little that goes in touches up to ten times the depth, unless a depth is given") {
  const Rule rule = sc_default_rule();
  Rule limited = rule;
  limited.touch_depth = 0.02F;
  Measures of = hand_in_thigh();
  of.depth = 0.03F;
  of.extent = 0.2F;
  CHECK(depends_on_extent(rule, of));
  CHECK(classify(of) == SC_CLASS_TOUCH);
  CHECK(classify(of, 0.02F) == SC_CLASS_PENETRATION);
  CHECK_FALSE(depends_on_extent(limited, of));
  of.depth = 0.034F;
  CHECK(classify(of) == SC_CLASS_PENETRATION);
  CHECK(depends_on_extent(rule, of));  // its fault depth does
  // Files without a unit make giants and dwarfs: their touches are shares of the height.
  CHECK(touch_depth_of(rule, 1, 175) == doctest::Approx(0.0019 * 175));
  CHECK(touch_depth_of(rule, 1, 0.0175) == doctest::Approx(0.0066 * 0.0175));
}

TEST_CASE("two parts may be a fault exactly where some depth makes them one") {
  std::size_t never = 0, count = 0;
  for (const Relation relation : {SC_RELATION_APART, SC_RELATION_NEAR, SC_RELATION_JOINED, SC_RELATION_TWO_BODIES}) {
    for (const int pieces : {0, 1}) {
      for (const float touching : {0.0F, 0.5F, 1.0F}) {
        for (const float swallowed : {0.0F, 0.5F, 0.7F}) {
          Measures of = hand_in_thigh();
          of.relation = relation;
          of.is_one_piece = pieces;
          of.touching = touching;
          of.swallowed = swallowed;
          const bool may_be = may_be_fault(sc_default_rule(), of);
          bool is_some = false;
          for (const float depth : {0.001F, 0.05F, 1.0F, 1e6F, 1e35F}) {
            for (const float extent : {0.0F, 0.2F, 1e6F}) {
              of.depth = depth;
              of.extent = extent;
              is_some = is_some || is_fault(classify(of));
            }
          }
          CHECK(is_some == may_be);
          never += may_be ? 0 : 1;
          ++count;
        }
      }
    }
  }
  CHECK(never > 0);
  CHECK(never < count);
}

TEST_CASE("a rule of another version, or with a limit that is no number, is refused") {
  Rule rule = sc_default_rule();
  CHECK(check_rule(&rule) == SC_OK);
  CHECK(check_rule(nullptr) == SC_OK);
  rule.version = 1;
  CHECK(check_rule(&rule) == SC_BAD_VALUE);
  rule = sc_default_rule();
  rule.fold_depth = std::numeric_limits<float>::quiet_NaN();
  CHECK(check_rule(&rule) == SC_BAD_VALUE);
  rule = sc_default_rule();
  rule.touch_depth = -1;
  CHECK(check_rule(&rule) == SC_BAD_VALUE);
}

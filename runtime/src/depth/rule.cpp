// SPDX-License-Identifier: MIT
#include "depth/rule.h"

#include <algorithm>

namespace spherechain {

double touch_depth_of(const Rule& rule, double metre, double height) {
  return rule.touch_depth > 0
             ? rule.touch_depth
             : std::min(std::max(rule.touch_metres * metre, rule.touch_min * height), rule.touch_max * height);
}

bool is_fold(const Rule& rule, const Measures& of) {
  if (of.are_two_bodies) {
    return false;
  }
  if (of.relation == Relation::kJoined || of.rest_distance < rule.neighbours) {
    return true;
  }
  const bool lie_close = of.relation == Relation::kNear && (of.facing > rule.fold_facing || !of.is_one_piece);
  return (of.relation == Relation::kSiblings || lie_close) && of.rest_distance < rule.fold;
}

PenetrationClass classify(const Rule& rule, const Measures& of) {
  if (of.touching >= rule.at_rest) {
    return SC_CLASS_REST;
  }
  if (of.visible < rule.hidden || (!of.is_one_piece && of.rest_distance < rule.shell)) {
    return SC_CLASS_SHELL;
  }
  const double touch = touch_depth_of(rule, of.metre, of.height);
  if (of.depth < touch) {
    return SC_CLASS_TOUCH;
  }
  if (is_fold(rule, of)) {
    return of.depth > rule.deep_fold * of.height && of.is_one_piece ? SC_CLASS_DEEP_FOLD : SC_CLASS_FOLD;
  }
  // A depth that the caller sets is a limit: nothing deeper is a touch.
  const bool may_touch = !(rule.touch_depth > 0) && of.depth < rule.touch_most * touch;
  return may_touch && !(of.swallowed >= rule.swallowed) ? SC_CLASS_TOUCH : SC_CLASS_PENETRATION;
}

bool depends_on_swallowed(const Rule& rule, const Measures& of) {
  Measures all = of, none = of;
  all.swallowed = 2 * rule.swallowed;
  none.swallowed = 0;
  return classify(rule, all) != classify(rule, none);
}

}  // namespace spherechain

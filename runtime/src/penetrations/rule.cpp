// SPDX-License-Identifier: MIT
#include "runtime/src/penetrations/rule.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace spherechain {
namespace {

constexpr Rule kDefault = [] {
  Rule out{};
  out.version = SC_RULE_VERSION;
  out.touch_metres = 0.003F;
  out.touch_min = 0.0019F;  // files without a unit make giants and dwarfs
  out.touch_max = 0.0066F;
  out.touch_times = 10;
  out.inside = 0.6F;
  out.extent = 0.25F;
  out.at_rest = 0.5F;
  out.hidden = 0.3F;
  out.shell = 0.035F;
  out.fold = 0.11F;
  out.neighbours = 0.055F;
  out.fold_facing = 0.2F;
  out.deep_fold = 0.045F;
  return out;
}();

PenetrationClass classify(const Rule& rule, const Measures& of) {
  if (of.swallowed >= rule.inside || of.through != 0) {
    return SC_CLASS_INSIDE;
  }
  if (of.touching >= rule.at_rest) {
    return SC_CLASS_REST;
  }
  if (of.visible < rule.hidden || (of.is_one_piece == 0 && of.rest_distance < rule.shell)) {
    return SC_CLASS_SHELL;
  }
  const double touch = touch_depth_of(rule, double{of.metre}, double{of.height}), depth = double{of.depth};
  if (depth < touch) {
    return SC_CLASS_TOUCH;
  }
  if (is_fold(rule, of)) {
    return depth > double{rule.deep_fold} * double{of.height} && of.is_one_piece != 0 ? SC_CLASS_DEEP_FOLD
                                                                                      : SC_CLASS_FOLD;
  }
  // A depth that the caller sets is a limit: nothing deeper is a touch.
  const bool may_touch = !(rule.touch_depth > 0) && depth < double{rule.touch_times} * touch;
  return may_touch && !(of.extent >= rule.extent) ? SC_CLASS_TOUCH : SC_CLASS_PENETRATION;
}

}  // namespace

Status check_rule(const sc_rule* rule) {
  if (rule == nullptr) {
    return done();
  }
  const float limits[] = {rule->touch_depth, rule->touch_metres, rule->touch_min, rule->touch_max, rule->touch_times,
                          rule->extent,      rule->at_rest,      rule->hidden,    rule->shell,     rule->fold,
                          rule->neighbours,  rule->fold_facing,  rule->deep_fold, rule->inside};
  const bool are_finite = std::all_of(std::begin(limits), std::end(limits), [](float l) { return std::isfinite(l); });
  return rule->version == SC_RULE_VERSION && are_finite && rule->touch_depth >= 0 ? done()
                                                                                  : refuse(SC_BAD_VALUE, SC_FIELD_RULE);
}

double touch_depth_of(const Rule& rule, double metre, double height) {
  return rule.touch_depth > 0 ? double{rule.touch_depth}
                              : std::min(std::max(double{rule.touch_metres} * metre, double{rule.touch_min} * height),
                                         double{rule.touch_max} * height);
}

bool is_fold(const Rule& rule, const Measures& of) {
  if (of.relation == SC_RELATION_TWO_BODIES) {
    return false;
  }
  if (of.relation == SC_RELATION_JOINED || of.rest_distance < rule.neighbours) {
    return true;
  }
  const bool lie_close = of.relation == SC_RELATION_NEAR && (of.facing > rule.fold_facing || of.is_one_piece == 0);
  return (of.relation == SC_RELATION_SIBLINGS || lie_close) && of.rest_distance < rule.fold;
}

bool depends_on_extent(const Rule& rule, const Measures& of) {
  Measures all = of, none = of;
  all.extent = rule.extent;
  none.extent = 0;
  return classify(rule, all) != classify(rule, none);
}

}  // namespace spherechain

using namespace spherechain;

extern "C" {

sc_rule sc_default_rule() noexcept { return kDefault; }

sc_penetration_class sc_classify(const sc_rule* rule, const sc_measures* measures) noexcept {
  return measures == nullptr ? SC_CLASS_REST : classify(rule == nullptr ? kDefault : *rule, *measures);
}

const char* sc_penetration_class_name(sc_penetration_class kind) noexcept {
  constexpr const char* kNames[] = {"rest", "shell", "touch", "fold", "deep_fold", "penetration", "inside"};
  return kind >= 0 && kind <= SC_CLASS_INSIDE ? kNames[kind] : "unknown";
}

}  // extern "C"

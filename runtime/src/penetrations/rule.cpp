// SPDX-License-Identifier: MIT
#include "runtime/src/penetrations/rule.h"

#include <algorithm>
#include <cfloat>
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
  out.extent = 0.25F;
  out.at_rest = 0.5F;
  out.hidden = 0.3F;
  out.shell = 0.035F;
  out.fold = 0.11F;
  out.neighbours = 0.055F;
  out.fold_depth = 0.045F;
  out.loose_depth = 0.08F;
  out.inside = 0.6F;
  return out;
}();

constexpr double kAnyDepth = 1e300;  // above any measured depth; finite: a share of 0 leaves nothing of it
constexpr double kMargin = 0.65;     // of the depth at which a thin intersection is none any more
constexpr float kEase = 0.7F;        // of what is allowed

// How close two spots are at rest: 1 up to half of the limit, a half at it, 0 from one and a half times it on.
double closeness(float distance, float limit) {
  return limit > 0 ? std::clamp(1.5 - double{distance} / double{limit}, 0.0, 1.0) : 0.0;
}

// The same of two parts that a joint folds.
double fold_closeness(const Rule& rule, const Measures& of) {
  switch (of.relation) {
    case SC_RELATION_TWO_BODIES:
      return 0;
    case SC_RELATION_JOINED:
      return 1;
    case SC_RELATION_APART:
      return closeness(of.rest_distance, rule.neighbours);
    default:
      return closeness(of.rest_distance, rule.fold);
  }
}

// From 0 at the limit to 1 at twice the limit.
double share_above(double value, double limit) { return limit > 0 ? std::clamp(value / limit - 1, 0.0, 1.0) : 1.0; }

double containment_of(const Rule& rule, const Measures& of) {
  return spherechain::containment_of(rule, double{of.swallowed});
}

// The depths up to which an intersection is no fault, by the reason.
struct Allowed {
  double shell, touch, fold, thin;
  double most() const { return std::max({shell, touch, fold, thin}); }
};

Allowed allowed(const Rule& rule, const Measures& of) {
  const bool is_loose = of.is_one_piece == 0;
  // Pieces on parts that a joint joins, a sleeve on an arm, slide in each other as deep as they like.
  const double deepest = is_loose && of.relation == SC_RELATION_JOINED
                             ? kAnyDepth
                             : double{is_loose ? rule.loose_depth : rule.fold_depth} * double{of.height};
  Allowed out{};
  out.shell = is_loose ? deepest * closeness(of.rest_distance, rule.shell) : 0;
  out.touch = touch_depth_of(rule, double{of.metre}, double{of.height});
  out.fold = deepest * fold_closeness(rule, of);
  // A depth that the caller sets is a limit: nothing deeper is a touch.
  if (!(rule.touch_depth > 0)) {
    const double most = double{rule.touch_times} * out.touch;
    out.thin = of.extent > 0 ? std::min(most, double{of.depth} * double{rule.extent} / double{of.extent}) : most;
  }
  const double share = 1 - containment_of(rule, of);
  return {share * out.shell, share * out.touch, share * out.fold, share * out.thin};
}

PenetrationClass classify(const Rule& rule, const Measures& of) {
  if (of.swallowed >= rule.inside) {
    return SC_CLASS_INSIDE;
  }
  const bool is_out = containment_of(rule, of) == 0;
  if (is_out && of.touching >= rule.at_rest) {
    return SC_CLASS_REST;
  }
  const Allowed up_to = allowed(rule, of);
  const double depth = double{of.depth};
  if ((is_out && of.visible < rule.hidden) || depth < up_to.shell) {
    return SC_CLASS_SHELL;
  }
  if (depth < up_to.touch) {
    return SC_CLASS_TOUCH;
  }
  if (depth < up_to.fold) {
    return SC_CLASS_FOLD;
  }
  if (depth < up_to.thin) {
    return SC_CLASS_TOUCH;
  }
  if (of.through != 0) {
    return SC_CLASS_INSIDE;
  }
  return of.is_one_piece != 0 && fold_closeness(rule, of) > 0.5 ? SC_CLASS_DEEP_FOLD : SC_CLASS_PENETRATION;
}

}  // namespace

Status check_rule(const sc_rule* rule) {
  if (rule == nullptr) {
    return done();
  }
  const float limits[] = {rule->touch_depth, rule->touch_metres, rule->touch_min,   rule->touch_max, rule->touch_times,
                          rule->extent,      rule->at_rest,      rule->hidden,      rule->shell,     rule->fold,
                          rule->neighbours,  rule->fold_depth,   rule->loose_depth, rule->inside};
  const bool is_known =
      rule->version == SC_RULE_VERSION &&
      std::all_of(std::begin(rule->reserved), std::end(rule->reserved), [](float r) { return r == 0; });
  const bool are_finite = std::all_of(std::begin(limits), std::end(limits), [](float l) { return std::isfinite(l); });
  return is_known && are_finite && rule->touch_depth >= 0 ? done() : refuse(SC_BAD_VALUE, SC_FIELD_RULE);
}

double containment_of(const Rule& rule, double swallowed) {
  return !(rule.inside > 0) ? 1 : std::clamp(4 * swallowed / double{rule.inside} - 3, 0.0, 1.0);
}

double touch_depth_of(const Rule& rule, double metre, double height) {
  return rule.touch_depth > 0 ? double{rule.touch_depth}
                              : std::min(std::max(double{rule.touch_metres} * metre, double{rule.touch_min} * height),
                                         double{rule.touch_max} * height);
}

float fault_depth_of(const Rule& rule, const Measures& of) {
  const double seen = share_above(double{of.visible}, double{rule.hidden}) *
                      share_above(1 - double{of.touching}, 1 - double{rule.at_rest});
  return static_cast<float>(std::max(seen, containment_of(rule, of)) *
                            std::max(double{of.depth} - allowed(rule, of).most(), 0.0));
}

double stays_allowed(const Rule& rule, const Measures& of) {
  const Allowed up_to = allowed(rule, of);
  const double others = std::max({up_to.shell, up_to.touch, up_to.fold});
  if (of.extent < 0 || rule.touch_depth > 0) {
    return others;
  }
  // As it gets shallower, its line gets shorter, and `extent` falls with more than the depth.
  const double share = 1 - containment_of(rule, of),
               thin = double{of.depth} * std::sqrt(double{rule.extent} / std::max(double{of.extent}, 1e-6));
  return std::max(others, share * kMargin * std::min(thin, double{rule.touch_times} * up_to.touch));
}

double fold_depth_of(const Rule& rule, const Measures& of) {
  return double{rule.fold_depth} * double{of.height} * fold_closeness(rule, of);
}

bool depends_on_extent(const Rule& rule, const Measures& of) {
  Measures all = of, none = of;
  all.extent = HUGE_VALF;
  none.extent = 0;
  return classify(rule, all) != classify(rule, none) || fault_depth_of(rule, all) != fault_depth_of(rule, none);
}

bool may_be_fault(const Rule& rule, Measures of) {
  of.depth = FLT_MAX;
  of.extent = HUGE_VALF;
  of.visible = 1;
  return is_fault(classify(rule, of));
}

Rule eased(Rule rule) {
  for (float* limit : {&rule.touch_depth, &rule.touch_metres, &rule.touch_min, &rule.touch_max, &rule.extent,
                       &rule.hidden, &rule.fold_depth, &rule.loose_depth}) {
    *limit *= kEase;
  }
  rule.at_rest = 1 - kEase * (1 - rule.at_rest);
  return rule;
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

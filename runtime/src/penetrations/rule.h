// SPDX-License-Identifier: MIT
// The steps of sc_classify() that the measuring asks about before all is measured.
#pragma once

#include "runtime/src/base/status.h"
#include "spherechain/rule.h"

namespace spherechain {

// SC_BAD_VALUE where a limit is no number, or the rule is of another version; null is fine.
Status check_rule(const sc_rule* rule);
// The depth below which two skins just touch.
double touch_depth_of(const Rule& rule, double metre, double height);
// How deep a fold may be; 0 where no joint folds the two spots.
double fold_depth_of(const Rule& rule, const Measures& of);
// The depth at which the intersection would be no fault any more, with a margin, if the two parted so far.
double stays_allowed(const Rule& rule, const Measures& of);
// sc_penetration.fault_depth.
float fault_depth_of(const Rule& rule, const Measures& of);
// How near a part is to being inside another: from 0 at three quarters of the share that makes it so, to 1.
double containment_of(const Rule& rule, double swallowed);
// The rule for two parts that were a fault a frame ago: a fault goes on until it is clearly none.
Rule eased(Rule rule);
// Does class or fault depth depend on `extent`, which is the dearest to measure?
bool depends_on_extent(const Rule& rule, const Measures& of);
// Could these two parts be a fault at some depth, and in full view? Reads what is known before a depth is measured.
bool may_be_fault(const Rule& rule, Measures of);

}  // namespace spherechain

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "baker/events/event.h"
#include "baker/fix/compare.h"
#include "baker/fix/turned_clip.h"
#include "baker/play/play.h"
#include "baker/roles/roles.h"

namespace spherechain::baker {

struct ClipFacts;  // mend_state.h

struct MendOptions {
  double budget_degrees = 25;   // largest turn of a joint for one event
  double margin_mm = 1.5;       // distance of separated parts
  bool is_soft_parted = false;  // part belly, chest, hips and thighs of one skin, too
};

// kOverBudget to kNoWayOut say why a fault stayed about as deep: a joint would exceed the budget, or the range of an
// elbow or knee; or every way out shakes or causes other penetrations. kRefused: an animator left it as animated.
enum class MendOutcome { kCleared, kReduced, kFold, kAccepted, kOverBudget, kJointLimits, kNoWayOut, kRefused };
const char* outcome_name(MendOutcome outcome);

// A penetration of two body parts over some frames, before and after the fix.
struct MendedEvent {
  // As found in the source clip, in whole frames. Only the parts, the class, the frames and the depth in mm are set.
  Event before;
  std::uint32_t part, other;  // numbers of its parts
  double depth_after_mm;
  double turn_degrees;  // largest turn of a joint in its frames
  MendOutcome outcome;
  double needed_degrees = 0;  // for kOverBudget: the budget that would free its deepest frame
};

struct Mend {
  std::vector<TurningJoint> joints;
  Turns turns;                  // all zero if nothing changes
  std::vector<char> in_window;  // per frame: 1 if it may have changed
  std::vector<MendedEvent> events;
  Comparison compared;
  // Separated pairs in a frame that were at most 10 mm deep; and how many of them are still within 5 mm after the fix.
  int shallow = 0, still_near = 0;
  // Penetrated volume of the selected faults, as far as their contours close: cm3, summed over frames.
  double volume_before = 0, volume_after = 0;
  int rounds = 0;

  bool is_still() const {
    return std::all_of(turns.begin(), turns.end(), [](const Vec3& turn) { return turn.isZero(0); });
  }
};

// Turns joints until a clip has no faults in its frames and between them. Feet stay in place. No joint turns beyond the
// budget, so some faults are only reduced, or stay. `leave` returns true for events that must stay as they are; it
// receives an event as MendedEvent::before has it. `report` receives the current step as text.
Mend mend_clip(const ClipFacts& facts, const std::function<bool(const Event&)>& leave,
               const std::function<void(const std::string&)>& report);

}  // namespace spherechain::baker

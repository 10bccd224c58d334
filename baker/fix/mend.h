// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "check/events.h"
#include "fix/compare.h"
#include "fix/turned_clip.h"
#include "play/play.h"
#include "roles/roles.h"

namespace spherechain::baker {

struct MendOptions {
  double budget_degrees = 25;  // the farthest that an event may turn a joint
  double margin_mm = 1.5;      // what is pushed out ends so far apart
};

// The last three say why a fault is about as deep as it was: a joint would turn beyond the budget, or beyond how far an
// elbow or a knee bends; or no way out was found that neither shakes nor pushes others in.
enum class Outcome { kCleared, kReduced, kFold, kAccepted, kOverBudget, kJointLimits, kNoWayOut };
const char* outcome_name(Outcome outcome);

// Two body parts in each other over some frames, before and after.
struct MendedEvent {
  std::uint32_t part, other;
  int from, to;  // frames of the clip
  PenetrationClass kind;
  double depth_before, depth_after;  // mm
  double turn_degrees = 0;           // the largest in its frames
  Outcome outcome = Outcome::kReduced;
  int worst = 0;              // the frame in which it is deepest, before
  double needed_degrees = 0;  // of kOverBudget: the budget that frees its worst frame
};

struct Mend {
  std::vector<TurningJoint> joints;
  Turns turns;                  // all zero where nothing is changed
  std::vector<char> in_window;  // of each frame: may it have changed?
  std::vector<MendedEvent> events;
  Comparison compared;
  // Pairs of parts in a frame, pushed, at most 10 mm deep before; of these, those within 5 mm of each other after.
  int shallow = 0, still_near = 0;
  // Penetrated volume of the selected faults, as far as their contours close: cm3, summed over frames.
  double volume_before = 0, volume_after = 0;
  int rounds = 0;

  bool is_still() const {
    return std::all_of(turns.begin(), turns.end(), [](const Vec3& turn) { return turn.isZero(0); });
  }
};

// Turns joints so that what is a fault in a clip's frames, and between them, is none any more; feet stay where they
// are. No joint turns beyond the budget: what then stays is reduced, or as it was. `leave` says which are to be left as
// they are. `told` is called with what is being done.
Mend mend_clip(const AnimatedAsset& animated, const Roles& roles, const ClipFrames& clip, const MendOptions& options,
               const std::function<bool(const MendedEvent&)>& leave,
               const std::function<void(const std::string&)>& told);

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>

#include "baker/events/event.h"
#include "baker/fix/separations.h"

namespace spherechain::baker {

// The state of an event while its clip is being fixed. The result has a MendOutcome instead.
enum class WorkingState {
  kOpen,     // its parts have to be separated; after the last round, they penetrate less than before
  kFreed,    // its parts do not penetrate any more
  kGivenUp,  // its parts penetrate about as deep as before
  kFold,     // left alone: a deep fold, or a part that penetrates itself
  kAccepted  // left alone, because the caller says so
};

// An event counts as reduced below this share of its depth or residual.
inline constexpr double kReducedShare = 0.8;

// The least residual of all rounds so far.
struct LeastResidual {
  double value = HUGE_VAL;
  int round = 0;  // the round that reached it

  // Returns false if `residual` is not clearly less than before.
  bool gets_better(double residual, int now) {
    constexpr double kBetterShare = 0.9;
    if (residual >= kBetterShare * value) return false;
    value = residual;
    round = now;
    return true;
  }
};

// An event of the source clip, and how far its fix has come.
struct WorkingEvent {
  // As found in the source clip. Only the parts, the class, the frames and the depth in mm are set.
  Event found;
  std::uint32_t part, other;  // numbers of its parts
  WorkingState state = WorkingState::kOpen;

  double depths_before = 0;  // sum over its frames, in mm
  // Sum of depths over its frames, in the source's units.
  double residual_at_start = 0;
  LeastResidual least = {};
  bool was_searched = false;  // a way out was searched for it

  // In the clip as measured last.
  double depth_after_mm = 0;
  double depths_after = 0;  // as depths_before
  double turn_degrees = 0;  // largest turn of a joint in its frames

  int from() const { return static_cast<int>(found.from); }
  int to() const { return static_cast<int>(found.to); }
  int deepest() const { return static_cast<int>(found.deepest); }
  bool is_open() const { return state == WorkingState::kOpen; }
  bool is_left_alone() const { return state == WorkingState::kFold || state == WorkingState::kAccepted; }
  // True for penetrations of the same parts in its frames, or one frame away.
  bool contains(const PenetrationKey& place) const {
    return place.part == part && place.other == other && place.frame >= found.from - 1 && place.frame <= found.to + 1;
  }
};

}  // namespace spherechain::baker

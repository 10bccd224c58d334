// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "baker/bind/body_parts.h"
#include "baker/events/join_events.h"
#include "baker/fix/find_faults.h"
#include "baker/fix/mend.h"
#include "baker/fix/separations.h"
#include "baker/fix/working_event.h"

namespace spherechain::baker {

inline PenetrationKey place_of(const PosePenetration& penetration) {
  return {penetration.frame, penetration.found.part, penetration.found.other};
}

// Targets of a fix: a clip's events, and the depth that each two parts may have in each frame.
class Goals {
 public:
  // `before`: penetrations in the frames of the source clip.
  Goals(std::vector<WorkingEvent> events, std::map<PenetrationKey, Penetration> before, double mm_per_unit,
        double margin_mm)
      : events(std::move(events)), mm_(mm_per_unit), margin_mm_(margin_mm), before_(std::move(before)) {}

  std::vector<WorkingEvent> events;

  bool has_open_events() const;

  // Penetrations in the frames of the source clip.
  const std::map<PenetrationKey, Penetration>& before() const { return before_; }
  const Penetration* before(const PenetrationKey& place) const;  // null: no penetration
  const WorkingEvent* event_at(const PenetrationKey& place) const;
  // The allowed depth in the source's units. Negative: the parts must be that far apart.
  double allowed(const PosePenetration& penetration) const;
  // Residual: the depth beyond the allowed one. 0 for penetrations that are left alone.
  double too_deep(const PosePenetration& penetration) const;
  bool is_let_be(const PosePenetration& penetration) const;
  // How much deeper a fault is than the same two parts were around that time, where that is seen; HUGE_VAL: they were
  // no fault.
  double worse_by(const PosePenetration& penetration) const;
  // Pairs of parts that never do worse than lie in layers or intersect as at rest.
  std::set<std::pair<std::uint32_t, std::uint32_t>> harmless() const;

 private:
  // True if the two parts have events, and all are left alone.
  bool is_left_alone(std::uint32_t part, std::uint32_t other) const;

  double mm_, margin_mm_;
  std::map<PenetrationKey, Penetration> before_;
};

// The event of a span of faults. Only the parts, the class, the frames and the depth in mm are set.
Event event_of(const EventSpan& span, const std::vector<FramePenetration>& faults, const std::vector<BodyPart>& parts,
               double mm_per_unit);

// Joins the penetrations of a source clip to events. `before`: in all of its frames, strictly; `sequence`: as `check`
// finds them. `leave` returns true for events that must stay as they are.
Goals goals_of(const std::vector<PosePenetration>& before, const std::vector<PosePenetration>& sequence, int frames,
               const std::vector<BodyPart>& parts, double mm_per_unit, const MendOptions& options,
               const std::function<bool(const Event&)>& leave);

}  // namespace spherechain::baker

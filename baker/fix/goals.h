// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "fix/find_faults.h"
#include "fix/mend.h"
#include "fix/pushes.h"

namespace spherechain::baker {

inline MeetingPlace place_of(const Meeting& meeting) {
  return {meeting.frame, meeting.found.part, meeting.found.other};
}

// Targets of a fix: a clip's events, and the depth that each two parts may have in each frame.
class Goals {
 public:
  // `before`: what the clip's frames have. `leave` says which events are to be left as they are.
  Goals(const std::vector<Meeting>& before, int frames, double mm_per_unit, double margin_mm,
        const std::function<bool(const MendedEvent&)>& leave);

  std::vector<MendedEvent> events;

  static bool is_wanted(const MendedEvent& event) { return event.outcome == Outcome::kReduced; }
  static bool is_in(const MeetingPlace& place, const MendedEvent& event) {
    return place.part == event.part && place.other == event.other && place.frame >= event.from - 1 &&
           place.frame <= event.to + 1;
  }

  // Penetrations in the frames of the source clip.
  const std::map<MeetingPlace, Penetration>& before() const { return before_; }
  const Penetration* before(const MeetingPlace& place) const;  // null where the two did not meet
  const MendedEvent* event_at(const MeetingPlace& place) const;
  // How deep they may be, in the source's units; negative: so far apart.
  double allowed(const Meeting& meeting) const;
  // By how much a fault is deeper than that; 0 where it is let be.
  double too_deep(const Meeting& meeting) const;
  bool is_let_be(const Meeting& meeting) const;
  // Than the same parts were around that time.
  bool is_worse(const Meeting& meeting) const;
  // Pairs of parts that are never more than layers of each other, or as at rest.
  std::set<std::pair<std::uint32_t, std::uint32_t>> harmless() const;

 private:
  double mm_, margin_mm_;
  std::map<MeetingPlace, Penetration> before_;
};

}  // namespace spherechain::baker

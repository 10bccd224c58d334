// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>
#include <vector>

#include "baker/fix/mend_state.h"

namespace spherechain::baker {

// A decision of an animator about an event of a fix. The clip, the parts and the frames name the event.
struct Decision {
  std::string clip;
  std::array<std::string, 2> parts;
  int from = 0, to = 0;
  bool is_refused = false;

  bool is_of(const std::string& its_clip, const MendedEvent& event) const;
};

// "clip: left hand, head, frames 80-85"
std::string decision_text(const Decision& decision);

// Reads the file that the pages of `fix --report` save. Throws Error(kFile) that names the entry and the key if it is
// no such file, or if it says two things about one event.
std::vector<Decision> read_decisions(const std::string& file);

struct Refusals {
  // By event: those that keep a refused one's joints turned in some of its frames.
  std::vector<std::vector<std::size_t>> held_by;
  // Faults that the source clip does not have, and that the accepted turns alone cause: as event_of() has them.
  std::vector<Event> new_faults;
};

// Takes the turns of refused events back; `is_refused` is by event. Accepted events keep their poses: where both need a
// joint, it fades from one to the other within the refused event's frames. Measures the clip again. Their outcome is
// MendOutcome::kRefused then.
Refusals refuse_events(const ClipFacts& facts, const Roles& roles, const std::vector<char>& is_refused, Mend& mend);

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/fix/acting.h"
#include "baker/fix/decisions.h"
#include "baker/fix/mend.h"

namespace spherechain::baker {

struct MendedClip {
  std::string name;
  Mend mend;           // with the selected events only
  double seconds = 0;  // time that the fix took
  int others = 0;      // number of events that were not selected
  Acting acting = {};  // of the whole clip
  std::vector<Acting> event_acting = {};
  Refusals refusals = {};
};

// The file of `fix --report`, and the same as text.
std::string fix_json(const std::vector<MendedClip>& clips);
std::string fix_text(const std::vector<MendedClip>& clips);

// A clip's events for its page, as JSON: as fix_json has them.
std::string page_events(const MendedClip& clip);

// One line for a whole character: "3 clips, 7 events: 6 cleared, 1 fold".
std::string fix_line(const std::vector<MendedClip>& clips);

// True if a joint turns in one of the clips.
bool changes_any(const std::vector<MendedClip>& clips);

// True if an event is left that a user would expect to be cleared.
bool leaves_faults(const std::vector<MendedClip>& clips);

}  // namespace spherechain::baker

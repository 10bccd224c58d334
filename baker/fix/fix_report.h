// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "bind/body_parts.h"
#include "fix/mend.h"

namespace spherechain::baker {

struct MendedClip {
  std::string name;
  Mend mend;           // its events are those that were asked for
  double seconds = 0;  // that it took
  int others = 0;      // events that were not asked for
};

// The file of `fix --report`, and the same for people.
std::string fix_json(const std::vector<MendedClip>& clips, const std::vector<BodyPart>& parts);
std::string fix_text(const std::vector<MendedClip>& clips, const std::vector<BodyPart>& parts);

// The same of a whole character in a line: "3 clips, 7 events: 6 cleared, 1 fold".
std::string fix_line(const std::vector<MendedClip>& clips);

// Whether a joint turns in one of them.
bool changes_any(const std::vector<MendedClip>& clips);

// Whether an event is left that could have been expected to be cleared.
bool leaves_faults(const std::vector<MendedClip>& clips);

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "baker/check/results.h"

namespace spherechain::baker {

enum class EventState { kNew, kKnown, kAccepted, kResolved };
const char* state_name(EventState state);

// A fault recorded in the baseline.
struct KnownEvent {
  std::string character, clip;
  std::array<std::string, 2> parts;
  PenetrationClass kind;
  double from, to;  // seconds; from > to: over the seam of a loop
  double depth_mm;
  EventState state;                   // known or accepted
  nlohmann::ordered_json entry = {};  // the JSON as it was read, with any foreign keys
};

struct Baseline {
  std::vector<KnownEvent> events;
  nlohmann::ordered_json file = {};  // as it was read
};

// Throws Error(kFile) that names the entry and the key where the file is no baseline. One that is not there is empty
// where it `may_be_missing`.
Baseline read_baseline(const std::string& file, bool may_be_missing);
// Keys that this tool does not know stay as they were read.
std::string to_bytes(const Baseline& baseline);

// True if a clip's event is one that is known: of the same parts, at the same time.
bool is_same(const KnownEvent& known, const Event& event, double fps);

// True if a clip's result would have the event if it were still there: one of its frames lies in the event's time, or
// the clip ends before that.
bool is_looked_for(const KnownEvent& known, const ClipResult& result);

// True if it is more than was accepted: deeper by a tenth and a millimetre, or of a worse class.
bool is_worse(const KnownEvent& known, const Event& event);

}  // namespace spherechain::baker

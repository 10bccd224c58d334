// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>
#include <vector>

#include "check/results.h"

namespace spherechain::baker {

enum class EventState { kNew, kKnown, kAccepted, kResolved };
const char* state_name(EventState state);

// A fault that somebody has seen before.
struct KnownEvent {
  std::string character, clip;
  std::array<std::string, 2> parts;
  PenetrationClass kind;
  double from, to;  // seconds; from > to: over the seam of a loop
  double depth_mm;
  EventState state;  // known or accepted
};

struct Baseline {
  std::vector<KnownEvent> events;
};

// Throws Error(kFile) where the file is no baseline. One that is not there is empty where it `may_be_missing`.
Baseline read_baseline(const std::string& file, bool may_be_missing);
std::string to_bytes(const Baseline& baseline);

// Whether a clip's event is one that is known: of the same parts, at the same time.
bool is_same(const KnownEvent& known, const Event& event, double fps);

// Whether it is more than was accepted: deeper by a tenth and a millimetre, or of a worse class.
bool is_worse(const KnownEvent& known, const Event& event);

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "spherechain/contacts.h"

namespace spherechain::baker {

// Two body parts that meet in a frame of a clip.
struct FramePenetration {
  int frame;
  Penetration found;
};

// Frames without a meeting that an event goes on over.
inline constexpr int kGapMax = 3;

// Meetings of the same two parts, joined over frames: what a person would call one clipping.
struct EventSpan {
  int from, to;                       // where an event goes over the seam of a loop, from > to
  std::size_t deepest;                // index of its deepest meeting, the earliest of equals; ClipChecker: of its worst
  std::vector<std::size_t> meetings;  // indices, in the order of time
};

// `meetings` are those of a clip of `frames` frames, by frame. `loops`: its last frame is its first again. Returns the
// events by where they begin, then by parts.
std::vector<EventSpan> join_events(const std::vector<FramePenetration>& meetings, int frames, bool loops);

// The same of a clip that has frames between its own: `numbers` has the number of each, with a fraction between two.
// Meetings between frames join the event of whole frames that they border on, or are events of their own. Events of
// whole frames stay apart: each is in the answer as it is without the frames between.
std::vector<EventSpan> join_events(const std::vector<FramePenetration>& meetings, const std::vector<double>& numbers,
                                   bool loops);
inline bool is_between(double number) { return number != static_cast<double>(static_cast<long>(number)); }

}  // namespace spherechain::baker

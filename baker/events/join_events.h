// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "spherechain/contacts.h"

namespace spherechain::baker {

// A penetration of two body parts in a frame of a clip.
struct FramePenetration {
  int frame;
  Penetration found;
};

// Largest gap, in frames without penetration, within one event.
inline constexpr int kGapMax = 3;

// Penetrations of the same two parts, joined over frames: one visible fault.
struct EventSpan {
  int from, to;         // where an event goes over the seam of a loop, from > to
  std::size_t deepest;  // index of the deepest penetration, the first of equals; find_events.h: of the worst
  std::vector<std::size_t> penetrations;  // indices, in the order of time
};

// `penetrations` are those of a clip of `frames` frames, by frame. `loops`: its last frame is its first again. Returns
// the events by where they begin, then by parts.
std::vector<EventSpan> join_events(const std::vector<FramePenetration>& penetrations, int frames, bool loops);

// The same of a clip that has frames between its own: `numbers` has the number of each, with a fraction between two.
// Penetrations between frames join a neighbouring event of whole frames, or form events of their own. They never join
// two events of whole frames.
std::vector<EventSpan> join_events(const std::vector<FramePenetration>& penetrations,
                                   const std::vector<double>& numbers, bool loops);
inline bool is_between(double number) { return number != static_cast<double>(static_cast<long>(number)); }

}  // namespace spherechain::baker

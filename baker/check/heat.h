// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "baker/events/find_events.h"

namespace spherechain::baker {

// The frequency and depth with which a triangle of the skin takes part in a fault.
struct HeatSpot {
  std::uint32_t event;     // of the clip's
  std::uint32_t triangle;  // the source's number
  std::uint32_t frames;
  float depth_mm;  // of the deepest
};

// Sums up the faults of a clip over the frames in which they are faults: by event, then by triangle. `mm`: a unit of
// the source.
std::vector<HeatSpot> heat_of(const ClipEvents& found, double mm);

}  // namespace spherechain::baker

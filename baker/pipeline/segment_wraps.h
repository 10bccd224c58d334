// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "baker/mesh/attempt.h"
#include "baker/segment/segment.h"
#include "baker/wrap/closing_report.h"

namespace spherechain::baker {

// The regions of a wrap of the skin.
struct SegmentedWrap {
  Regions regions;
  std::string strategy;  // which wrap it is
};

// True if the regions are what a character most likely has: a biped's, where the settings do not say another body.
bool is_expected(const Regions& regions, const SegmentSettings& settings);

// Segments wraps of the skin by their shape, finer and coarser ones, until one is good. The best one
// is the body of the regions. `of_body` is the reason why the body itself has no regions, which says more than the
// reasons of its wraps. The wraps that were not taken are added to `passed_over`.
Attempt<SegmentedWrap> segment_wraps(const Character& character, const SegmentSettings& settings,
                                     const std::optional<Reason>& of_body, ClosingReport& closing,
                                     std::vector<PassedOver>& passed_over);

}  // namespace spherechain::baker

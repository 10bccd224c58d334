// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

#include "baker/page/page.h"
#include "baker/play/play.h"

namespace spherechain::baker {

// Where the second of two characters stands in its first frame. Both look the same way at rest; then it is turned.
struct Place {
  double left, forward;  // metres from where the first stands, in the first's own axes
  double degrees;        // counterclockwise, seen from above
};

// The page of two characters, frame by frame beside each other: the contacts of each, and those between them. The
// second's motion starts with the first's; where it is shorter, its last pose stays. Without a place both stand where
// their files have them. One character before and after a change stands in one place; the page moves the two
// apart. Throws what view_page() throws; and Error(kUsage) where one plays several clips.
std::string view_page_of_two(const AnimatedAsset& first, const AnimatedAsset& second, const Place* place,
                             const PageOptions& options, const std::function<void(int)>& progress);

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "play/asset_file.h"
#include "volumes/colliders.h"

namespace spherechain::baker {

// How well colliders stand for the skin at rest. Distances are from points of the skin, evenly spread over its area, to
// the nearest surface of the volumes.
struct ColliderFit {
  int volumes = 0, bodies = 0;      // bodies with volumes
  double coverage = 0;              // share of the skin inside the volumes
  double gap_mean = 0, gap_95 = 0;  // metres, inside or outside alike; 95th percentile
  double protrusion_95 = 0;         // metres that the volumes stand beyond the skin; 95th percentile
  double volume_ratio = 0;          // of the volumes, what they share once, to the space that the skin encloses
};

ColliderFit measure_fit(const OpenAsset& asset, const Colliders& colliders);

}  // namespace spherechain::baker

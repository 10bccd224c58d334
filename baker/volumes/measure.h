// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "baker/play/play.h"
#include "baker/volumes/colliders.h"

namespace spherechain::baker {

// How well colliders stand for the skin in a pose. Distances are from points of the skin, evenly spread over its area,
// to the nearest surface of the volumes.
struct ColliderFit {
  int volumes = 0, bodies = 0;           // bodies with volumes
  double coverage = 0;                   // share of the skin inside the volumes
  std::vector<double> coverage_of_body;  // the same of each body's own skin, in any volume; 1: it has none
  double gap_mean = 0, gap_95 = 0;       // metres, inside or outside alike; 95th percentile
  double protrusion_95 = 0;              // metres that the volumes stand beyond the skin; 95th percentile
  double volume_ratio = 0;               // of the volumes, what they share once, to the space that the skin encloses
};

ColliderFit measure_fit(const OpenAsset& asset, const Colliders& colliders);  // at rest

// The means of at most `frames` frames, evenly over what plays: bodies are rigid, skin bends. The volume ratio is left
// out.
ColliderFit measure_fit(const AnimatedAsset& animated, const Colliders& colliders, int frames);

}  // namespace spherechain::baker

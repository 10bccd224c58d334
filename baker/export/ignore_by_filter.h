// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "baker/filter/part_filter.h"
#include "baker/volumes/colliders.h"

namespace spherechain::baker {

// Adds to `ignored` the bodies of which no two parts that they stand for need a test, by what `filter` found. Why two
// bodies hang together, or what the filter knows, goes before what their volumes do at rest.
void ignore_by_filter(const PartFilter& filter, Colliders& colliders);

}  // namespace spherechain::baker

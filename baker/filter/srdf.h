// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "baker/filter/part_filter.h"
#include "baker/import/robot_rig.h"
#include "baker/import/source_rig.h"

namespace spherechain::baker {

// An SRDF file for a robot: the pairs of its links that need no test. Links that fixed joints connect, and neighbours,
// are "Adjacent".
std::string srdf_of(const PartFilter& filter, const SourceRig& robot);

}  // namespace spherechain::baker

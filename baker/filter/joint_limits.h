// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "baker/calibrate/random_poses.h"

namespace spherechain::baker {

// Sets limits that a file has (docs/formats.md, "Joint limits"). Throws Error(kFile) that names the file: it is broken,
// or names a joint that there is not.
void read_joint_limits(const std::string& file, RandomPoses& poses);

}  // namespace spherechain::baker

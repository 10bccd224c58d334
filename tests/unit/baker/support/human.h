// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "baker/import/import.h"
#include "baker/segment/by_shape.h"

// Debian's assimp-testmodels.
inline const std::filesystem::path kModels = "/usr/share/assimp/models";

// A MakeHuman body in an A-pose, 26,756 triangles, without a skeleton.
inline constexpr const char* kHumanFile = "/usr/share/assimp/models/Collada/human.zae";

struct HumanFixture {
  spherechain::baker::Character character;
  spherechain::baker::Regions regions;
};

// Imported and segmented once for all tests of a run.
const HumanFixture& human();

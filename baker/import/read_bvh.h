// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "baker/import/source_rig.h"

namespace spherechain::baker {

// True if a file is a BVH recording by its content, or says so by its ending.
bool is_recording(const std::filesystem::path& path);

// The joints as nodes, by their numbers, and the recording as a clip. Adds a note (notes.h) where something is wrong
// with it that does not keep it from being read. Throws Error(kFile) as parse_bvh does.
SourceRig read_bvh(const std::filesystem::path& path);

}  // namespace spherechain::baker

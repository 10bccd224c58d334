// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "baker/import/import.h"

namespace spherechain::baker {

// The character's own clips, and the recordings carried over to its skeleton. `file`: the character's, read with
// `options`. `progress` gets a word for what is done. Throws Error(kFile) where there is no clip at all, or a recording
// cannot be carried over.
std::vector<Clip> clips_for_mask(const Character& character, const std::string& file, const ImportOptions& options,
                                 const std::vector<std::string>& recordings,
                                 const std::function<void(const std::string&)>& progress);

}  // namespace spherechain::baker

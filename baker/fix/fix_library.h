// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "baker/check/verdict.h"

namespace spherechain::baker {

// Throws Error if a fixed character would overwrite a file of the library or another fixed one (kUsage), or a file that
// is no GLB (kFile).
void check_fix_folder(const std::vector<LibraryCharacter>& library, const std::filesystem::path& folder);

// Fixes each character with a penetration that neither its rules nor the baseline accept, and writes it to
// folder / relative, with .glb appended if it is another format. Fixes its clips with penetrations, and adds recordings
// with penetrations as new clips. `verdict` is the library's. Each character has a process of its own, so that a
// failure stops no other. Returns a line for each, in the library's order.
std::vector<std::string> fix_library(const std::vector<LibraryCharacter>& library, const Verdict& verdict,
                                     const Baseline& baseline, const std::filesystem::path& folder, int jobs,
                                     const std::function<void(const RunState&)>& progress);

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "check/verdict.h"

namespace spherechain::baker {

// Throws Error where a mended character would be written over a file of the library, or over another one (kUsage), or
// over a file that is no GLB (kFile).
void check_fix_folder(const std::vector<LibraryCharacter>& library, const std::filesystem::path& folder);

// Mends each character that has a penetration which neither its rules nor the baseline accept, and writes it to
// folder / relative, with .glb after it where it is another format: the clips of its own that have one, and as new
// clips the recordings that have one. `verdict` is the library's. Each in a process of its own: what keeps one from
// being mended stops no other. Returns a line for each, in the library's order.
std::vector<std::string> fix_library(const std::vector<LibraryCharacter>& library, const Verdict& verdict,
                                     const Baseline& baseline, const std::filesystem::path& folder, int jobs,
                                     const std::function<void(const RunState&)>& progress);

}  // namespace spherechain::baker

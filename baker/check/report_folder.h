// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "baker/check/verdict.h"

namespace spherechain::baker {

// Before the check: throws Error(kFile) where `folder` cannot be made, or holds what is not this tool's (OwnFolder).
void check_report_folder(const std::filesystem::path& folder);

// Pages that open from disk: index.html is the library, clip.html a clip with its events. They load `library.js`, and
// of the folder `data` what they show. `pages` is where the tool's own pages are; where they were not built, the report
// has none, and false is returned.
bool write_report(const std::filesystem::path& folder, const Verdict& verdict, const Store& store,
                  const std::filesystem::path& pages);

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "baker/play/asset_file.h"

namespace spherechain::baker {

// The text of what `bake --report` or `validate --json` wrote, for the page about `asset`, which was read from
// `asset_file`. The page's script takes it as it is: Error(kFile) names the file and the key where one that the page
// shows is missing or of another kind, and both files where they are of different sources or settings.
std::string read_bake_report(const std::string& file, const OpenAsset& asset, const std::string& asset_file);
std::string read_validation(const std::string& file, const OpenAsset& asset, const std::string& asset_file);

}  // namespace spherechain::baker

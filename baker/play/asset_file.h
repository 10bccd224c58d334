// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "spherechain/asset.h"

namespace spherechain::baker {

// Whole contents, of a file or a pipe; throws Error(kFile).
std::string read_file(const std::string& path);

// An asset and the bytes it views.
struct AssetFile {
  std::unique_ptr<std::uint64_t[]> bytes;  // aligned as open() wants
  Asset asset;
};
// Throws Error(kFile) that says what is wrong with the file.
AssetFile open_asset(const std::string& path);

}  // namespace spherechain::baker

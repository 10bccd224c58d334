// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

namespace spherechain::baker {

// A page that the build made for the tool: build tree and installation have the same shape, bin/spherechain and
// share/spherechain/NAME.
inline std::filesystem::path installed_page(const std::string& name) {
  return std::filesystem::canonical("/proc/self/exe").parent_path().parent_path() / "share/spherechain" / name;
}

}  // namespace spherechain::baker

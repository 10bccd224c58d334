// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "baker/mesh/error.h"

namespace spherechain::baker {

// A page that the build made for the tool: build tree and installation have the same shape, bin/spherechain and
// share/spherechain/NAME.
inline std::filesystem::path installed_page(const std::string& name) {
  return std::filesystem::canonical("/proc/self/exe").parent_path().parent_path() / "share/spherechain" / name;
}

// The page of `view` without data. Throws Error(kFile) where the build made none.
inline std::filesystem::path viewer_template() {
  const std::filesystem::path page = installed_page("viewer.html");
  if (!std::filesystem::is_regular_file(page)) {
    throw Error(ExitCode::kFile, page.string() + ": the viewer's page is not installed (build spherechain with Node)");
  }
  return page;
}

}  // namespace spherechain::baker

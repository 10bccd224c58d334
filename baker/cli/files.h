// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>

#include "spherechain/asset.h"

namespace spherechain::baker {

// Whole contents; throws Error(kFile).
std::string read_file(const std::string& path);

// An asset and the bytes it views.
struct AssetFile {
  std::unique_ptr<std::uint64_t[]> bytes;  // aligned as open() wants
  Asset asset;
};
// Throws Error(kFile) that says what is wrong with the file.
AssetFile open_asset(const std::string& path);

// A line on stderr that is replaced by the next; silent where stderr is no terminal.
class Progress {
 public:
  explicit Progress(std::string title);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void show(const std::string& text);

 private:
  std::string title_;
  bool terminal_;
};

}  // namespace spherechain::baker

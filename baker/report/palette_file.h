// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "baker/play/play.h"
#include "baker/write/npz.h"

namespace spherechain::baker {

// Writer of `play --palettes`: the skinning matrices of every frame (docs/formats.md has the tables).
class PaletteFile {
 public:
  // Throws Error(kFile) where bones do not move the asset, or the frames are too many for a file.
  PaletteFile(const std::filesystem::path& path, const AnimatedAsset& animated);
  void add(int frame, const Deformation& deformation);
  void finish();  // after the last frame

 private:
  const AnimatedAsset& animated_;
  NpzFile file_;
  std::vector<float> palettes_, morphs_;
  std::vector<std::int32_t> clips_;
  std::vector<double> numbers_, times_;
};

}  // namespace spherechain::baker

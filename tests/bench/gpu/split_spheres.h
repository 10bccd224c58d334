// SPDX-License-Identifier: MIT
// A character with many times its spheres, for a GPU to have something to do.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "spherechain/asset.h"

namespace spherechain::bench {

// Each sphere of an asset replaced by `parts` smaller ones inside it, together of its volume, at fixed offsets in
// proportion to its radius.
// Sphere s becomes parts * s and those after it, in every chain that holds it. Pairs within a sphere are ignored, and
// of parts of two spheres as the two are; so are rest pairs and their scale, for the fit radius.
class SplitAsset {
 public:
  // Throws std::runtime_error where that is no asset: too many spheres.
  SplitAsset(const Asset& whole, std::uint32_t parts);

  const Asset& asset() const { return asset_; }  // for detection: it cannot be refitted
  std::vector<Sphere> split(const std::vector<Sphere>& spheres) const;

 private:
  struct Offset {
    float x, y, z;
  };
  std::vector<Offset> offsets_;  // of a unit sphere's parts
  float radius_;                 // of each of them
  std::vector<std::uint8_t> bytes_;
  Asset asset_;
};

}  // namespace spherechain::bench

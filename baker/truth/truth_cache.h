// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "baker/truth/intersections.h"

namespace spherechain::baker {

// Where intersections found before are kept, a small file a pose: what the environment variable SPHERECHAIN_CACHE
// names, none where that is "off"; else $XDG_CACHE_HOME/spherechain or ~/.cache/spherechain; none (empty) without a
// home. Anything in it may be deleted at any time.
std::filesystem::path cache_folder();

// find_intersections, not done again for the same surface in the same pose: spheres, their number and their regions do
// not matter. Files are written whole or not at all; one that is broken is not used, and a folder that cannot be
// written to is no error. May be called by several threads.
class CachedIntersections {
 public:
  // `surface` must outlive it. An empty folder keeps nothing.
  CachedIntersections(const TruthSurface& surface, std::filesystem::path folder);

  Intersections find(const std::vector<float>& positions) const;

 private:
  const TruthSurface& surface_;
  std::filesystem::path folder_;
  std::string surface_key_;
};

}  // namespace spherechain::baker

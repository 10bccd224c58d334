// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/truth/surface.h"

#include <algorithm>

#include "baker/mesh/error.h"

namespace spherechain::baker {

TruthSurface surface_of(const OpenAsset& asset, const Character& character) {
  TruthSurface out;
  const Span<const RestSphere> spheres = asset->spheres();
  std::vector<std::uint32_t> owner(character.source_triangles.size(), kNoIndex);
  for (std::uint32_t s = 0; s < spheres.size; ++s) {
    for (const std::uint32_t t : asset.triangles_of(s)) {
      if (t >= owner.size()) throw Error(ExitCode::kInternal, "a triangle of the asset is not in its source");
      owner[t] = s;
    }
  }
  out.of_source.assign(owner.size(), kNoIndex);
  out.of_sphere.resize(spheres.size);
  for (Index t = 0; t < owner.size(); ++t) {
    if (owner[t] == kNoIndex) continue;
    const Triangle& corners = character.source_triangles[t];
    Triangle welded{};
    for (std::size_t k = 0; k < 3; ++k) welded[k] = character.skin_of_source[corners[k]];
    const auto place = static_cast<Index>(out.corners.size());
    out.of_source[t] = place;
    out.of_sphere[owner[t]].push_back(place);
    out.source_triangle.push_back(t);
    out.corners.push_back(corners);
    out.welded.push_back(welded);
    out.sphere.push_back(owner[t]);
  }
  return out;
}

bool are_neighbours(const Triangle& a, const Triangle& b) {
  return std::any_of(a.begin(), a.end(), [&](Index v) { return v == b[0] || v == b[1] || v == b[2]; });
}

bool is_ignored(const OpenAsset& asset, std::uint32_t a, std::uint32_t b) {
  if (a > b) std::swap(a, b);
  const std::size_t bit = std::size_t{b} * (b - 1) / 2 + a;
  return (asset->ignored()[bit / 64] >> (bit % 64) & 1) != 0;
}

}  // namespace spherechain::baker

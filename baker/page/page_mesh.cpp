// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/page/page_mesh.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "baker/page/base64.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

// The skin's weights in 16 bits; a vertex's sum stays exact.
ordered_json weights_json(const std::vector<VertexWeights>& weights) {
  std::size_t influences = 0;
  for (const VertexWeights& w : weights) {
    const auto used = std::count_if(w.weight.begin(), w.weight.end(), [](double x) { return x > 0; });
    influences = std::max(influences, static_cast<std::size_t>(used));
  }
  std::vector<std::uint16_t> joints, shares;
  for (const VertexWeights& w : weights) {
    const std::size_t first = shares.size();
    int left = w.weight[0] > 0 ? 65535 : 0;
    for (std::size_t k = 0; k < influences; ++k) {
      const int share = std::min(left, static_cast<int>(std::lround(w.weight[k] * 65535)));
      joints.push_back(static_cast<std::uint16_t>(w.joint[k]));
      shares.push_back(static_cast<std::uint16_t>(share));
      left -= share;
    }
    if (left > 0) shares[first] = static_cast<std::uint16_t>(shares[first] + left);
  }
  return {{"influences", influences}, {"joints", base64(joints)}, {"weights", base64(shares)}};
}

}  // namespace

ordered_json page_mesh(const std::vector<Vec3>& rest, const std::vector<Triangle>& triangles,
                       const std::vector<VertexWeights>& weights, const PageParts& parts,
                       const std::vector<PageSphere>& spheres) {
  std::vector<std::uint32_t> corners;
  for (const Triangle& t : triangles) corners.insert(corners.end(), t.begin(), t.end());
  std::vector<std::uint16_t> sphere_of(triangles.size(), 0xFFFF);
  for (std::size_t s = 0; s < spheres.size(); ++s) {
    for (const std::uint32_t t : spheres[s].triangles) sphere_of[t] = static_cast<std::uint16_t>(s);
  }
  ordered_json out{{"positions", base64(pack(rest))},
                   {"triangles", base64(corners)},
                   {"spheres", base64(sphere_of)},
                   {"parts", base64(parts.of_triangle)}};
  out.update(weights_json(weights));
  return out;
}

ordered_json page_mesh(const AnimatedAsset& animated, const std::vector<Vec3>& rest, const PageParts& parts,
                       const std::vector<PageSphere>& spheres) {
  return page_mesh(rest, animated.character().source_triangles, animated.weights(), parts, spheres);
}

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/calibrate/skin_gap.h"

#include <algorithm>
#include <limits>

namespace spherechain::baker {

SkinGaps::SkinGaps(const Mesh& skin, const Binding& binding) : mesh_(skin) {
  std::vector<std::vector<Index>> triangles(binding.spheres.size());
  for (Index t = 0; t < binding.sphere_of_triangle.size(); ++t) triangles[binding.sphere_of_triangle[t]].push_back(t);
  for (const std::vector<Index>& of_sphere : triangles) {
    SphereSkin& own = skins_.emplace_back();
    if (of_sphere.empty()) continue;
    own.surface = std::make_unique<SurfaceQuery>(skin, of_sphere);
    for (const Index t : of_sphere) {
      own.vertices.insert(own.vertices.end(), skin.triangles[t].begin(), skin.triangles[t].end());
    }
    std::sort(own.vertices.begin(), own.vertices.end());
    own.vertices.erase(std::unique(own.vertices.begin(), own.vertices.end()), own.vertices.end());
    for (const Index v : own.vertices) own.box.extend(skin.positions[v]);
  }
}

double SkinGaps::nearest(const SphereSkin& from, const SphereSkin& to, double bound) const {
  std::vector<std::pair<double, Index>> order;  // by a lower bound of the distance
  for (const Index v : from.vertices) {
    const double least = to.box.exteriorDistance(mesh_.positions[v]);
    if (least < bound) order.emplace_back(least, v);
  }
  std::sort(order.begin(), order.end());
  for (const auto& [least, v] : order) {
    if (least >= bound) break;
    bound = std::min(bound, to.surface->closest(mesh_.positions[v]).distance);
  }
  return bound;
}

double SkinGaps::between(std::uint32_t a, std::uint32_t b) const {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  if (!skins_[a].surface || !skins_[b].surface) return kFar;
  const auto share_a_vertex = [](const std::vector<Index>& l, const std::vector<Index>& r) {
    for (auto i = l.begin(), k = r.begin(); i != l.end() && k != r.end(); *i < *k ? ++i : ++k) {
      if (*i == *k) return true;
    }
    return false;
  };
  if (share_a_vertex(skins_[a].vertices, skins_[b].vertices)) return 0;
  return nearest(skins_[b], skins_[a], nearest(skins_[a], skins_[b], kFar));
}

}  // namespace spherechain::baker

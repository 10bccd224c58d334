// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibrate/skin_gap.h"

#include <algorithm>
#include <limits>

namespace spherechain::baker {

SkinGaps::SkinGaps(const Mesh& skin, const Binding& binding) {
  std::vector<std::vector<Index>> triangles(binding.spheres.size());
  for (Index t = 0; t < binding.sphere_of_triangle.size(); ++t) triangles[binding.sphere_of_triangle[t]].push_back(t);
  for (std::size_t s = 0; s < triangles.size(); ++s) {
    Skin& own = skins_.emplace_back();
    if (triangles[s].empty()) continue;
    own.surface = std::make_unique<SurfaceQuery>(skin, triangles[s]);
    std::vector<Index> vertices;
    for (const Index t : triangles[s]) {
      vertices.insert(vertices.end(), skin.triangles[t].begin(), skin.triangles[t].end());
    }
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    own.around = {binding.spheres[s].rest.center, 0};
    for (const Index v : vertices) {
      own.vertices.push_back(skin.positions[v]);
      own.around.radius = std::max(own.around.radius, (skin.positions[v] - own.around.center).norm());
    }
  }
}

double SkinGaps::nearest(const Skin& from, const Skin& to, double bound) {
  std::vector<std::pair<double, std::size_t>> order;  // by a lower bound of the distance
  for (std::size_t v = 0; v < from.vertices.size(); ++v) {
    order.emplace_back((from.vertices[v] - to.around.center).norm() - to.around.radius, v);
  }
  std::sort(order.begin(), order.end());
  for (const auto& [least, v] : order) {
    if (least >= bound) break;
    bound = std::min(bound, to.surface->closest(from.vertices[v]).distance);
  }
  return bound;
}

double SkinGaps::between(std::uint32_t a, std::uint32_t b) const {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  if (!skins_[a].surface || !skins_[b].surface) return kFar;
  return nearest(skins_[b], skins_[a], nearest(skins_[a], skins_[b], kFar));
}

}  // namespace spherechain::baker

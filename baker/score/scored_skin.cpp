// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/score/scored_skin.h"

#include <array>
#include <map>

namespace spherechain::baker {

ScoredSkin scored_skin(const std::vector<Vec3>& rest, const std::vector<Triangle>& triangles) {
  ScoredSkin out{rest, triangles, {}, std::vector<VertexPlace>(rest.size())};
  std::map<std::array<double, 3>, Index> first;
  for (Index v = 0; v < rest.size(); ++v) {
    out.joined.push_back(first.try_emplace({rest[v].x(), rest[v].y(), rest[v].z()}, v).first->second);
  }
  return out;
}

}  // namespace spherechain::baker

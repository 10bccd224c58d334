// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/score/star_rate.h"

#include <algorithm>
#include <cmath>
#include <nanoflann.hpp>

namespace spherechain::baker {
namespace {

struct Cloud {
  std::vector<Vec3> points;
  std::vector<Index> vertices;  // of each point

  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const { return points[i][static_cast<Eigen::Index>(axis)]; }
  template <typename Box>
  bool kdtree_get_bbox(Box& /*box*/) const {
    return false;
  }
};

// The skin without a limb and what the limb hangs on.
class SkinWithout {
 public:
  SkinWithout(const ScoredSkin& skin, const std::vector<Vec3>& positions, ScoredLimb limb)
      : cloud_(cloud_of(skin, positions, limb)), tree_(3, cloud_) {}

  // The nearest vertex.
  Index nearest(const Vec3& to) const {
    std::uint32_t at = 0;
    double squared = 0;
    tree_.knnSearch(to.data(), 1, &at, &squared);
    return cloud_.vertices[at];
  }

 private:
  static Cloud cloud_of(const ScoredSkin& skin, const std::vector<Vec3>& positions, ScoredLimb limb) {
    Cloud out;
    for (Index v = 0; v < positions.size(); ++v) {
      const VertexPlace& place = skin.places[v];
      if ((place.is_on_limb || place.is_beside_limb) && place.limb == limb) continue;
      out.points.push_back(positions[v]);
      out.vertices.push_back(v);
    }
    return out;
  }

  using Metric = nanoflann::L2_Simple_Adaptor<double, Cloud>;
  Cloud cloud_;
  nanoflann::KDTreeSingleIndexAdaptor<Metric, Cloud, 3, std::uint32_t> tree_;
};

}  // namespace

StarCount count_star(const ScoredSkin& skin, const std::vector<Vec3>& positions, const std::vector<Vec3>& normals) {
  StarCount out;
  for (std::size_t l = 0; l < kLimbs; ++l) {
    const auto limb = static_cast<ScoredLimb>(l);
    const SkinWithout others(skin, positions, limb);
    for (Index v = 0; v < positions.size(); ++v) {
      if (!skin.places[v].is_on_limb || skin.places[v].limb != limb) continue;
      const Index nearest = others.nearest(positions[v]);
      ++out.vertices;
      if ((positions[nearest] - positions[v]).dot(normals[nearest]) > 0) ++out.inside;
    }
  }
  return out;
}

std::array<double, kLimbs> ends_from_body(const ScoredSkin& skin, const std::vector<Vec3>& positions) {
  std::array<double, kLimbs> out;
  for (std::size_t l = 0; l < kLimbs; ++l) {
    const auto limb = static_cast<ScoredLimb>(l);
    const SkinWithout others(skin, positions, limb);
    out[l] = HUGE_VAL;
    for (Index v = 0; v < positions.size(); ++v) {
      const VertexPlace& place = skin.places[v];
      if (place.is_end && place.limb == limb)
        out[l] = std::min(out[l], (positions[others.nearest(positions[v])] - positions[v]).norm());
    }
  }
  return out;
}

}  // namespace spherechain::baker

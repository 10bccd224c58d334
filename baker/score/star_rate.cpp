// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/score/star_rate.h"

#include <algorithm>
#include <cmath>
#include <memory>
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

// The nearest of the vertices that were looked at; of equally near ones the first.
struct Nearest {
  Index vertex = kNoIndex;
  double squared = HUGE_VAL;
  const std::vector<Index>* vertices = nullptr;  // of the tree's points

  using DistanceType = double;
  using CountType = std::size_t;
  std::size_t size() const { return 1; }
  bool full() const { return true; }
  void sort() const {}  // nanoflann 1.7 asks for it
  double worstDist() const { return squared; }
  bool addPoint(double to, std::uint32_t point) {
    if (to < squared) {
      squared = to;
      vertex = (*vertices)[point];
    }
    return true;
  }
};

// The skin in pieces: each limb with what it hangs on, and the rest.
class Pieces {
 public:
  Pieces(const ScoredSkin& skin, const std::vector<Vec3>& positions) {
    for (Index v = 0; v < positions.size(); ++v) {
      const VertexPlace& place = skin.places[v];
      Cloud& cloud = clouds_[place.is_on_limb || place.is_beside_limb ? static_cast<std::size_t>(place.limb) : kLimbs];
      cloud.points.push_back(positions[v]);
      cloud.vertices.push_back(v);
    }
    for (const Cloud& cloud : clouds_) trees_.push_back(std::make_unique<Tree>(3, cloud));
  }

  // The nearest vertex to a point that is on no piece of this limb.
  Nearest nearest(const Vec3& to, ScoredLimb without) const {
    Nearest out;
    for (std::size_t piece = clouds_.size(); piece-- > 0;) {
      if (piece == static_cast<std::size_t>(without) || clouds_[piece].points.empty()) continue;
      out.vertices = &clouds_[piece].vertices;
      trees_[piece]->findNeighbors(out, to.data(), {});
    }
    return out;
  }

 private:
  using Tree =
      nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 3, std::uint32_t>;
  std::array<Cloud, kLimbs + 1> clouds_;
  std::vector<std::unique_ptr<Tree>> trees_;
};

}  // namespace

StarCount count_star(const ScoredSkin& skin, const std::vector<Vec3>& positions, const std::vector<Vec3>& normals) {
  StarCount out;
  const Pieces pieces(skin, positions);
  for (Index v = 0; v < positions.size(); ++v) {
    if (!skin.places[v].is_on_limb) continue;
    ++out.vertices;
    const Nearest found = pieces.nearest(positions[v], skin.places[v].limb);
    if (found.vertex != kNoIndex && (positions[found.vertex] - positions[v]).dot(normals[found.vertex]) > 0)
      ++out.inside;
  }
  return out;
}

std::array<double, kLimbs> ends_from_body(const ScoredSkin& skin, const std::vector<Vec3>& positions) {
  const Pieces pieces(skin, positions);
  std::array<double, kLimbs> out;
  out.fill(HUGE_VAL);
  for (Index v = 0; v < positions.size(); ++v) {
    const VertexPlace& place = skin.places[v];
    if (!place.is_end) continue;
    double& least = out[static_cast<std::size_t>(place.limb)];
    least = std::min(least, std::sqrt(pieces.nearest(positions[v], place.limb).squared));
  }
  return out;
}

}  // namespace spherechain::baker

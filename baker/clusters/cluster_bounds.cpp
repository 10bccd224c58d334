// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "baker/clusters/clusters.h"
#include "baker/clusters/round_up.h"

namespace spherechain::baker {
namespace {

// The smallest ball, about a float centre, with a float radius.
Ball ball_around(const Mesh& points) {
  std::vector<Index> all(points.positions.size());
  for (Index i = 0; i < all.size(); ++i) all[i] = i;
  const Vec3 center = minimum_enclosing_ball(points, all).center.cast<float>().cast<double>();
  double radius = 0;
  for (const Vec3& p : points.positions) radius = std::max(radius, (p - center).norm());
  // The norm in double precision is off by a few units in its last place.
  return {center, round_up(radius * (1 + 1e-15))};
}

// Around the points as the asset has them.
ClusterBox box_around(const Mesh& points) {
  ClusterBox out{Vec3::Zero(), Vec3::Zero(), 0};
  std::vector<Vec3> from_center(points.positions.size());
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::vector<float> places;
    for (const Vec3& p : points.positions) places.push_back(static_cast<float>(p[axis]));
    const auto [low, high] = std::ranges::minmax(places);
    const float center = (low + high) / 2;
    out.center[axis] = center;
    for (std::size_t i = 0; i < places.size(); ++i) {
      from_center[i][axis] = double{places[i]} - double{center};
      out.half[axis] = std::max(out.half[axis], std::abs(from_center[i][axis]));
    }
    out.half[axis] = round_up(out.half[axis]);
  }
  for (const Vec3& p : from_center) out.radius = std::max(out.radius, p.norm());
  // The norm in double precision is off by a few units in its last place.
  out.radius = round_up(out.radius * (1 + 1e-15));
  return out;
}

std::vector<ClusterBone> bones_of(const std::vector<SurfaceVertex>& vertices, const Cluster& cluster) {
  struct Range {
    float least = 1, most = 0;
    std::size_t count = 0;
  };
  std::map<Index, Range> ranges;
  for (const Index v : cluster.vertices) {
    for (const Influence& influence : vertices[v].influences) {
      Range& range = ranges[influence.bone];
      range.least = std::min(range.least, influence.weight);
      range.most = std::max(range.most, influence.weight);
      ++range.count;
    }
  }
  double sum = 0;
  for (auto& [bone, range] : ranges) {
    if (range.count < cluster.vertices.size()) range.least = 0;
    sum += (double{range.least} + range.most) / 2;
  }
  std::vector<ClusterBone> out;
  for (const auto& [bone, range] : ranges) {
    const auto weight = static_cast<float>((double{range.least} + range.most) / 2 / sum);
    const double deviation = std::max(double{range.most} - weight, weight - double{range.least});
    out.push_back({bone, weight, round_up(deviation)});
  }
  return out;
}

std::vector<ClusterMorph> morphs_of(const std::vector<SurfaceVertex>& vertices, const Cluster& cluster) {
  std::map<Index, Mesh> deltas;
  for (const Index v : cluster.vertices) {
    for (const MorphDelta& morph : vertices[v].morphs) deltas[morph.target].positions.push_back(morph.delta);
  }
  std::vector<ClusterMorph> out;
  for (auto& [target, points] : deltas) {
    if (points.positions.size() < cluster.vertices.size()) points.positions.push_back(Vec3::Zero());
    out.push_back({target, ball_around(points)});
  }
  return out;
}

}  // namespace

void bound_cluster(const Character& character, const std::vector<SurfaceVertex>& vertices, Cluster& cluster) {
  Mesh points;
  for (const Index v : cluster.vertices) points.positions.push_back(character.source_positions[vertices[v].source]);
  cluster.box = box_around(points);
  cluster.bones = bones_of(vertices, cluster);
  cluster.morphs = morphs_of(vertices, cluster);
}

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "baker/bind/bind.h"

namespace spherechain::baker {
namespace {

// The targets of a set of pivots: `count` directions around the axis, every second one shifted along it by +-stagger
// radii.
struct Pattern {
  int count;
  double stagger;
};

// The triangles nearest to the targets, each once. A quadrant without skin (the inner half of the torso) gets the
// nearest there is.
std::vector<Index> pick(const Mesh& mesh, const std::vector<Index>& triangles, const FittedSphere& sphere,
                        const Vec3& reference, const Pattern& pattern) {
  const Vec3 axis = sphere.axis;
  const Vec3 across = reference - reference.dot(axis) * axis;
  const Vec3 u = across.norm() > 1e-3 * reference.norm() ? across.normalized() : axis.unitOrthogonal();
  const Vec3 v = axis.cross(u);
  // Where a triangle's centre is: along the axis in radii, and in which direction from it.
  struct Seen {
    Index triangle;
    double along;
    Vec3 direction;
  };
  std::vector<Seen> seen;
  seen.reserve(triangles.size());
  for (const Index t : triangles) {
    const Vec3 d = triangle_centroid(mesh, t) - sphere.ball.center;
    seen.push_back({t, d.dot(axis) / sphere.ball.radius, (d - d.dot(axis) * axis).normalized()});
  }
  std::vector<Index> picked;
  for (int k = 0; k < pattern.count; ++k) {
    // In the middle of the k-th sector: with four, of the quadrant.
    const double angle = 2 * std::numbers::pi * (k + 0.5) / pattern.count;
    const Vec3 direction = std::cos(angle) * u + std::sin(angle) * v;
    const double shift = (k % 2 == 0 ? 1 : -1) * pattern.stagger;
    double least = std::numeric_limits<double>::max();
    Index best = kNoIndex;
    for (const Seen& one : seen) {
      const double off = std::abs(one.along - shift);
      if (off >= least) continue;  // an angle only adds to it
      const double cost = off + std::acos(std::clamp(one.direction.dot(direction), -1.0, 1.0));
      if (!(cost < least) || std::find(picked.begin(), picked.end(), one.triangle) != picked.end()) continue;
      least = cost;
      best = one.triangle;
    }
    if (best == kNoIndex) break;
    picked.push_back(best);
  }
  return picked;
}

// Weights that sum to one and put the centre exactly, as close to equal as that allows: a minimum-norm change.
std::vector<double> solve_weights(const Mesh& mesh, const std::vector<Index>& pivots, const Ball& ball) {
  const auto n = static_cast<Eigen::Index>(pivots.size());
  Eigen::MatrixXd rows(4, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    rows.block<3, 1>(0, k) = (triangle_centroid(mesh, pivots[static_cast<std::size_t>(k)]) - ball.center) / ball.radius;
    rows(3, k) = 1;
  }
  const Eigen::VectorXd even = Eigen::VectorXd::Constant(n, 1.0 / static_cast<double>(n));
  const Eigen::Vector4d wanted(0, 0, 0, 1);
  const Eigen::VectorXd weights = even + rows.completeOrthogonalDecomposition().solve(wanted - rows * even);
  if ((rows * weights - wanted).norm() > 1e-9) return {};  // pivots in one plane cannot carry a centre outside it
  return {weights.data(), weights.data() + n};
}

double sum_of_magnitudes(const std::vector<double>& weights) {
  double sum = 0;
  for (const double w : weights) sum += std::abs(w);
  return sum;
}

struct Carriers {
  std::vector<Index> triangles;
  std::vector<double> weights;
  double magnitudes = std::numeric_limits<double>::max();  // their sum
};

// Four pivots in one plane are an ill-posed system (weights of 49 were seen). Staggered ones are not; where skin is on
// one side only, more of them and farther apart help.
Carriers least_ill_posed(const Mesh& mesh, const std::vector<Index>& triangles, const FittedSphere& sphere,
                         const Vec3& reference, int count) {
  Carriers best;
  for (const Pattern& pattern : {Pattern{count, 0.35}, Pattern{count, 0.6}, Pattern{std::max(count, 8), 0.6},
                                 Pattern{std::max(count, 12), 0.5}, Pattern{16, 0.5}, Pattern{16, 0.9}}) {
    const std::vector<Index> picked = pick(mesh, triangles, sphere, reference, pattern);
    if (picked.size() < 4) return {};
    const std::vector<double> weights = solve_weights(mesh, picked, sphere.ball);
    const double sum = sum_of_magnitudes(weights);
    if (weights.empty() || sum >= best.magnitudes) continue;
    best = {picked, weights, sum};
    if (sum <= kIllPosed) break;
  }
  return best;
}

std::vector<BoundPivot> bound(const Carriers& carriers) {
  std::vector<BoundPivot> pivots;
  for (std::size_t k = 0; k < carriers.triangles.size(); ++k) {
    pivots.push_back({carriers.triangles[k], carriers.weights[k]});
  }
  return pivots;
}

}  // namespace

std::vector<BoundPivot> choose_pivots(const Mesh& mesh, const std::vector<Index>& triangles, const FittedSphere& sphere,
                                      const Vec3& reference, RefitRule rule, int count, double magnitudes_max) {
  std::vector<BoundPivot> pivots;
  if (rule == RefitRule::kPaper) {
    const std::vector<Index> picked = pick(mesh, triangles, sphere, reference, {count, 0});
    if (picked.size() < static_cast<std::size_t>(count)) return {};
    for (const Index t : picked) pivots.push_back({t, 1.0 / static_cast<double>(picked.size())});
    return pivots;
  }
  const Carriers found = least_ill_posed(mesh, triangles, sphere, reference, count);
  return found.magnitudes <= magnitudes_max ? bound(found) : pivots;
}

std::vector<BoundPivot> choose_nearest_pivots(const Mesh& mesh, const std::vector<Index>& triangles,
                                              const FittedSphere& sphere, const Vec3& reference, int count) {
  Carriers found = least_ill_posed(mesh, triangles, sphere, reference, count);
  // The magnitudes' sum is convex along the way to even weights, where it is 1: a share that grows in proportion stays
  // below the limit.
  const double share = std::min(1.0, (kIllPosed - 1) / (found.magnitudes - 1));
  for (double& weight : found.weights) {
    weight = share * weight + (1 - share) / static_cast<double>(found.weights.size());
  }
  return bound(found);
}

std::vector<BoundPivot> choose_even_pivots(const Mesh& mesh, const std::vector<Index>& triangles,
                                           const FittedSphere& sphere) {
  constexpr std::size_t kPivotsMax = 16;
  std::vector<std::pair<double, Index>> near;
  for (const Index t : triangles) near.emplace_back((triangle_centroid(mesh, t) - sphere.ball.center).squaredNorm(), t);
  const std::size_t count = std::min(kPivotsMax, near.size());
  std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), near.end());
  std::vector<BoundPivot> pivots;
  for (std::size_t i = 0; i < count; ++i) pivots.push_back({near[i].second, 1.0 / static_cast<double>(count)});
  return pivots;
}

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
// Figure 13: how well phi1, phi1' and phi2 fit the cross-sections of the torso.
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <limits>

#include "baker/mesh/ring.h"
#include "experiments.h"
#include "statistics.h"

namespace spherechain::paper {
namespace {

using baker::Ball;
using baker::Ring;
using baker::Side;

constexpr std::array<const char*, 4> kFits{"phi1", "phi1_adjusted", "phi2", "phi2_rays"};
constexpr std::size_t kAdjustedFit = 1, kEnclosingFit = 2;

// The disk of a level: where baker/fit puts it, its rays numbered from the front over the left.
Ring cast_disk(const Bake& bake, const baker::SurfaceQuery& torso, double height) {
  const baker::Regions& regions = bake.regions;
  const baker::BodyFrame& frame = regions.frame;
  const auto h = [&](const Vec3& p) { return (p - frame.origin).dot(frame.up); };
  const double along = (height - h(regions.hip)) / (h(regions.chest) - h(regions.hip));
  const Vec3 axis = regions.hip + along * (regions.chest - regions.hip);
  const int rays = bake.settings.fit.rays;
  Vec3 center = cast_ring(torso, axis, frame.up, frame.left, rays).section_centroid();
  center -= (center - frame.origin).dot(frame.left) * frame.left;
  return cast_ring(torso, center, frame.up, frame.forward, rays);
}

bool in_half(int ray, int rays, Side side) {
  return side == Side::kLeft ? ray <= rays / 2 : ray >= rays / 2 || ray == 0;
}

// Eccentricity of the ellipse with the polygon's second moments: 0 for a circle.
double eccentricity(const Ring& ring, const std::vector<Vec3>& polygon) {
  double area = 0;
  Eigen::Vector2d first = Eigen::Vector2d::Zero();
  Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
  const auto flat = [&](const Vec3& p) {
    return Eigen::Vector2d((p - ring.center).dot(ring.u), (p - ring.center).dot(ring.v));
  };
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d a = flat(polygon[i]), b = flat(polygon[(i + 1) % polygon.size()]);
    const double cross = a.x() * b.y() - a.y() * b.x();
    area += cross / 2;
    first += cross / 6 * (a + b);
    second += cross / 24 * (a * a.transpose() + b * b.transpose() + (a + b) * (a + b).transpose());
  }
  const Eigen::Vector2d center = first / area;
  const Eigen::Matrix2d moments = second / area - center * center.transpose();
  const Eigen::Vector2d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(moments).eigenvalues();
  return std::sqrt(1 - axes[0] / axes[1]);
}

// "r0-r12 r30-r40" of the rays where `better` is true, each ray's neighbour the next in `order`.
std::string runs(const std::vector<int>& order, const std::vector<bool>& better) {
  std::string out;
  for (std::size_t i = 0; i < order.size();) {
    std::size_t j = i;
    while (j < order.size() && better[j]) ++j;
    if (j > i) out += fmt::format("{}r{}", out.empty() ? "" : " ", order[i]);
    if (j > i + 1) out += fmt::format("-r{}", order[j - 1]);
    i = j > i ? j : i + 1;
  }
  return out.empty() ? "nowhere" : out;
}

Ball enclosing_ball(const std::vector<Vec3>& points) {
  std::vector<Index> all(points.size());
  for (Index i = 0; i < all.size(); ++i) all[i] = i;
  return baker::minimum_enclosing_ball({points, {}}, all);
}

}  // namespace

AccuracyTables measure_accuracy(const Study& study, const Bake& bake) {
  AccuracyTables out{{"figure13",
                      {"sphere", "level", "side", "ray", "own_half", "ray_length_mm", "abs_f_phi1_mm",
                       "abs_f_phi1_adjusted_mm", "abs_f_phi2_mm", "abs_f_phi2_rays_mm"},
                      {}},
                     {"figure13_spheres",
                      {"sphere", "level", "side", "hits", "eccentricity_half", "eccentricity_section", "rays_phi1_mm",
                       "rays_phi1_adjusted_mm", "rays_phi2_mm", "rays_phi2_rays_mm", "vertices_phi1_mm",
                       "vertices_phi1_adjusted_mm", "vertices_phi2_mm", "rays_better_phi1_adjusted", "rays_better_phi2",
                       "phi1_adjusted_better_at", "phi2_better_at"},
                      {}}};
  const baker::SurfaceQuery torso(bake.regions.body.mesh, triangles_of_region(bake.regions, baker::kTorso));
  const int rays = bake.settings.fit.rays;
  for (std::size_t s = 0; s < bake.spheres.torso.size(); ++s) {
    const baker::FittedSphere& sphere = bake.spheres.spheres[s];
    const baker::TorsoFit& fit = bake.spheres.torso[s];
    const std::string side = sphere.side == Side::kLeft ? "left" : "right";
    const Ring disk = cast_disk(bake, torso, bake.spheres.level_heights[static_cast<std::size_t>(sphere.level)]);

    // Half a turn in the order of the rays, so that runs do not break at r79.
    std::vector<int> order;
    std::vector<Vec3> half, section;
    for (int k = 0; k <= rays / 2; ++k) {
      const int ray = (k + (sphere.side == Side::kLeft ? 0 : rays / 2)) % rays;
      const auto& hit = disk.hits[static_cast<std::size_t>(ray)];
      if (!hit) continue;
      order.push_back(ray);
      half.push_back(hit->point);
    }
    for (const auto& hit : disk.hits) {
      if (hit) section.push_back(hit->point);
    }
    const std::array<Ball, kFits.size()> balls{fit.phi1, fit.phi1_adjusted, fit.phi2, enclosing_ball(half)};

    for (int ray = 0; ray < rays; ++ray) {
      const auto& hit = disk.hits[static_cast<std::size_t>(ray)];
      std::vector<Cell> row{s, sphere.level, side, ray, in_half(ray, rays, sphere.side) ? 1 : 0};
      row.push_back(hit ? Cell(study.mm() * hit->distance) : Cell());
      for (const Ball& ball : balls) {
        row.push_back(hit ? Cell(study.mm() * std::abs(signed_f(ball, hit->point))) : Cell());
      }
      out.rays.add(std::move(row));
    }

    std::vector<Cell> row{s, sphere.level, side, half.size(), eccentricity(disk, half), eccentricity(disk, section)};
    const auto f = [&](std::size_t b, std::size_t i) { return std::abs(signed_f(balls[b], half[i])); };
    for (std::size_t b = 0; b < balls.size(); ++b) {
      std::vector<double> values;
      for (std::size_t i = 0; i < half.size(); ++i) values.push_back(study.mm() * f(b, i));
      row.push_back(mean(values));
    }
    for (const Ball* ball : {&fit.phi1, &fit.phi1_adjusted, &fit.phi2}) {
      row.push_back(study.mm() * f_error(*ball, bake.regions.body.mesh, fit.vertices).mean_abs);
    }
    std::vector<bool> adjusted, enclosing;
    for (std::size_t i = 0; i < half.size(); ++i) {
      adjusted.push_back(f(kAdjustedFit, i) < f(kEnclosingFit, i));
      enclosing.push_back(f(kEnclosingFit, i) < f(kAdjustedFit, i));
    }
    row.push_back(std::count(adjusted.begin(), adjusted.end(), true));
    row.push_back(std::count(enclosing.begin(), enclosing.end(), true));
    row.push_back(runs(order, adjusted));
    row.push_back(runs(order, enclosing));
    out.spheres.add(std::move(row));
  }
  return out;
}

}  // namespace spherechain::paper

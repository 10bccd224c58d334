// SPDX-License-Identifier: GPL-3.0-or-later
// The runtime's refit on the baked human, against the deformed skin.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "baked_human.h"
#include "jobs.h"

using namespace spherechain::baker;
using spherechain::RadiusKind;

namespace {

using spherechain::test::refit;

// The sphere that keeps its rest F to the vertices around it best: the least squares of (r - |c - v_i|) - F_i over
// centre and radius, by Gauss and Newton from the rest sphere moved with the vertices' centroid.
struct BestFit {
  std::vector<Index> vertices;  // source vertices of the surrounding region with |F| < r / 2 at rest
  std::vector<double> rest_f;
  Ball rest;

  Ball fitted_to(const std::vector<Vec3>& rest_positions, const std::vector<Vec3>& positions) const {
    Ball ball = rest;
    for (const Index v : vertices)
      ball.center += (positions[v] - rest_positions[v]) / static_cast<double>(vertices.size());
    for (int pass = 0; pass < 30; ++pass) {
      Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
      Eigen::Vector4d gradient = Eigen::Vector4d::Zero();
      for (std::size_t i = 0; i < vertices.size(); ++i) {
        const Vec3 d = ball.center - positions[vertices[i]];
        const double residual = ball.radius - d.norm() - rest_f[i];
        Eigen::Vector4d row;
        row << -d / d.norm(), 1;
        normal += row * row.transpose();
        gradient += row * residual;
      }
      const Eigen::Vector4d step = normal.ldlt().solve(-gradient);
      ball.center += step.head<3>();
      ball.radius += step[3];
      if (step.norm() < 1e-10) break;
    }
    return ball;
  }
};

// About the fitted sphere, whatever the refit rule: the skin's own motion is what both rules are judged by.
std::vector<BestFit> best_fits(const Bake& bake) {
  std::vector<BestFit> fits(bake.spheres.spheres.size());
  std::vector<std::vector<bool>> taken(fits.size(), std::vector<bool>(bake.character.source_positions.size(), false));
  for (std::size_t i = 0; i < fits.size(); ++i) fits[i].rest = bake.spheres.spheres[i].ball;
  std::vector<Index> source_of_body(bake.character.body.positions.size(), 0);
  for (Index v = 0; v < bake.character.body_of_source.size(); ++v) {
    if (bake.character.body_of_source[v] != kNoIndex) source_of_body[bake.character.body_of_source[v]] = v;
  }
  for (std::size_t t = 0; t < bake.character.body.triangles.size(); ++t) {
    const std::uint32_t s = bake.binding.sphere_of_triangle[t];
    for (const Index w : bake.character.body.triangles[t]) {
      const Index v = source_of_body[w];
      const double f = fits[s].rest.radius - (bake.character.source_positions[v] - fits[s].rest.center).norm();
      if (taken[s][v] || std::abs(f) >= 0.5 * fits[s].rest.radius) continue;
      taken[s][v] = true;
      fits[s].vertices.push_back(v);
      fits[s].rest_f.push_back(f);
    }
  }
  return fits;
}

struct Errors {
  std::vector<double> center, radius;  // millimetres; fraction of the best fit's radius

  static double mean(const std::vector<double>& v) {
    double sum = 0;
    for (const double x : v) sum += x / static_cast<double>(v.size());
    return sum;
  }
  static double p95(std::vector<double> v) {
    const auto at = v.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(v.size()));
    std::nth_element(v.begin(), at, v.end());
    return *at;
  }
  std::string row(const char* name) const {
    return fmt::format("{:<11} {:>6.2f} {:>6.2f} {:>6.2f} {:>8.2f} {:>6.2f}\n", name, mean(center), p95(center),
                       *std::max_element(center.begin(), center.end()), 100 * mean(radius), 100 * p95(radius));
  }
};

Errors refit_errors(const Bake& bake) {
  const spherechain::Asset asset = open_asset_of(bake);
  const std::vector<BestFit> fits = best_fits(bake);
  Errors errors;
  for (const AnimationFrame& frame : animation_frames()) {
    const auto result = refit(asset, pack(frame.positions), RadiusKind::kFit);
    REQUIRE(result.status == spherechain::Status::kOk);
    for (std::size_t i = 0; i < result.spheres.size(); ++i) {
      const Ball best = fits[i].fitted_to(bake.character.source_positions, frame.positions);
      const spherechain::Sphere& s = result.spheres[i];
      errors.center.push_back(1e3 * (Vec3(s.x, s.y, s.z) - best.center).norm());
      errors.radius.push_back(std::abs(static_cast<double>(s.radius) - best.radius) / best.radius);
    }
  }
  return errors;
}

}  // namespace

TEST_CASE("calibrated refit follows the best-fit sphere of the deformed surrounding region over both animations") {
  REQUIRE(animation_frames().size() == 80);
  const Errors calibrated = refit_errors(baked_human()), paper = refit_errors(paper_baked_human());
  const std::string header = fmt::format(
      "refit against a best-fit sphere, 80 frames (centre mm, radius %)\n{:<11} {:>6} {:>6} {:>6} {:>8} {:>6}\n", "",
      "mean", "p95", "max", "mean", "p95");
  MESSAGE(header, calibrated.row("calibrated"), paper.row("paper"));
  CHECK(Errors::mean(calibrated.center) < 3);
  CHECK(Errors::p95(calibrated.center) < 10);
  CHECK(Errors::mean(calibrated.radius) < 0.015);
}

TEST_CASE("at rest the calibrated refit gives the baked spheres to 1e-5 of the height, and both radii") {
  const Bake& bake = baked_human();
  const spherechain::Asset asset = open_asset_of(bake);
  const std::vector<float> rest = pack(bake.character.source_positions);
  for (const RadiusKind kind : {RadiusKind::kFit, RadiusKind::kDetect}) {
    const auto result = refit(asset, rest, kind);
    double worst = 0;
    for (std::size_t i = 0; i < result.spheres.size(); ++i) {
      const spherechain::Sphere& s = result.spheres[i];
      const double wanted =
          kind == RadiusKind::kFit ? bake.spheres.spheres[i].ball.radius : bake.binding.spheres[i].detect_radius;
      worst = std::max({worst, (Vec3(s.x, s.y, s.z) - bake.spheres.spheres[i].ball.center).norm(),
                        std::abs(static_cast<double>(s.radius) - wanted)});
    }
    CHECK(worst < 1e-5 * bake.regions.frame.height);
  }
}

TEST_CASE("the asset knows its own rest pose from any other buffer") {
  const Bake& bake = baked_human();
  const spherechain::Asset asset = open_asset_of(bake);
  std::vector<float> positions = pack(bake.character.source_positions);
  CHECK(spherechain::check_source(asset, positions.data(), positions.size() / 3) == spherechain::Status::kOk);
  positions[3000] += 1e-3f;
  CHECK(spherechain::check_source(asset, positions.data(), positions.size() / 3) == spherechain::Status::kWrongSource);
}

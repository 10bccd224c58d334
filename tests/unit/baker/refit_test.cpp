// SPDX-License-Identifier: GPL-3.0-or-later
// The runtime's refit on the baked human, against the deformed skin.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "baked_human.h"
#include "jobs.h"
#include "measure/refit_error.h"

using namespace spherechain::baker;
using spherechain::Radius;

namespace {

using spherechain::test::refit;

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
  const spherechain::baker::OpenAsset asset = open_asset_of(bake);
  const std::vector<SkinFollower> followers = skin_followers(bake);
  Errors errors;
  for (const AnimationFrame& frame : animation_frames()) {
    const auto result = refit(asset, pack(frame.positions), SC_RADIUS_FIT);
    REQUIRE(result.status == SC_OK);
    for (std::size_t i = 0; i < result.spheres.size(); ++i) {
      const Ball best = followers[i].at(frame.positions);
      const spherechain::Sphere& s = result.spheres[i];
      errors.center.push_back(1e3 * (Vec3(s.x, s.y, s.z) - best.center).norm());
      errors.radius.push_back(std::abs(static_cast<double>(s.radius) - best.radius) / best.radius);
    }
  }
  return errors;
}

}  // namespace

TEST_CASE("refit by moments follows the best-fit sphere of the deformed skin over both animations" *
          doctest::test_suite("long runs")) {
  REQUIRE(animation_frames().size() == 80);
  const Errors moments = refit_errors(baked_human()), paper = refit_errors(paper_baked_human());
  const std::string header = fmt::format(
      "refit against a best-fit sphere, 80 frames (centre mm, radius %)\n{:<11} {:>6} {:>6} {:>6} {:>8} {:>6}\n", "",
      "mean", "p95", "max", "mean", "p95");
  MESSAGE(header, moments.row("moments"), paper.row("paper"));
  CHECK(Errors::mean(moments.center) < 3);
  CHECK(Errors::p95(moments.center) < 10);
  CHECK(Errors::mean(moments.radius) < 0.015);
}

TEST_CASE("at rest refit by moments gives the baked spheres to 1e-5 of the height, and both radii") {
  const Bake& bake = baked_human();
  const spherechain::baker::OpenAsset asset = open_asset_of(bake);
  const std::vector<float> rest = pack(bake.character.source_positions);
  for (const Radius kind : {SC_RADIUS_FIT, SC_RADIUS_DETECT}) {
    const auto result = refit(asset, rest, kind);
    double worst = 0;
    for (std::size_t i = 0; i < result.spheres.size(); ++i) {
      const spherechain::Sphere& s = result.spheres[i];
      const double wanted =
          kind == SC_RADIUS_FIT ? bake.spheres.spheres[i].ball.radius : bake.binding.spheres[i].detect_radius;
      worst = std::max({worst, (Vec3(s.x, s.y, s.z) - bake.spheres.spheres[i].ball.center).norm(),
                        std::abs(static_cast<double>(s.radius) - wanted)});
    }
    CHECK(worst < 1e-5 * bake.regions.frame.height);
  }
}

TEST_CASE("the asset knows its own rest pose from any other buffer") {
  const Bake& bake = baked_human();
  const spherechain::baker::OpenAsset asset = open_asset_of(bake);
  std::vector<float> positions = pack(bake.character.source_positions);
  CHECK(sc_check_source(asset.handle(), SC_WHOLE_SOURCE, positions.data(), positions.size() / 3, 12) == SC_OK);
  positions[3000] += 1e-3f;
  CHECK(sc_check_source(asset.handle(), SC_WHOLE_SOURCE, positions.data(), positions.size() / 3, 12) ==
        SC_WRONG_SOURCE);
}

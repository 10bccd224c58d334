// SPDX-License-Identifier: GPL-3.0-or-later
// The runtime's refit over two animations, against the best-fit spheres of the deformed skin.
#include "refit_error.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "baked_human.h"
#include "jobs.h"

using namespace spherechain::baker;

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

TEST_CASE("refit by moments follows the best-fit sphere of the deformed skin over both animations") {
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

// SPDX-License-Identifier: GPL-3.0-or-later
// The runtime's refit on the baked human, against the deformed skin.
#include <doctest/doctest.h>

#include <cmath>

#include "baked_human.h"
#include "jobs.h"

using namespace spherechain::baker;
using spherechain::Radius;
using spherechain::test::refit;

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

// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/segment/by_rig.h"

#include <doctest/doctest.h>

#include "baker/mesh/error.h"
#include "baker/pipeline/pipeline.h"

using namespace spherechain::baker;

namespace {

// Debian's assimp-testmodels: a person in five open pieces, with a 3ds Max Biped.
const Bake& person_in_pieces() {
  static const Bake result =
      bake("/usr/share/assimp/models/X/BCN_Epileptic.X", make_settings("balanced", R"({"body": "biped"})", "test"), {});
  return result;
}

Vec3 centroid_of(const Bake& bake, std::uint8_t region) {
  Vec3 sum = Vec3::Zero();
  double area = 0;
  for (std::size_t t = 0; t < bake.character.skin.triangles.size(); ++t) {
    if (bake.regions.of_skin[t] != region) continue;
    sum += triangle_area(bake.character.skin, t) * triangle_centroid(bake.character.skin, t);
    area += triangle_area(bake.character.skin, t);
  }
  return sum / area;
}

}  // namespace

TEST_CASE("a rigged person in open pieces is segmented by the rig, and left is left" *
          doctest::test_suite("many bakes")) {
  const Bake& bake = person_in_pieces();
  CHECK(bake.regions.provider == "rig");
  REQUIRE(is_biped(bake.regions));
  CHECK(bake.character.report.components > 1);
  CHECK(bake.regions.of_skin.size() == bake.character.skin.triangles.size());
  const BodyFrame& frame = bake.regions.frame;
  CHECK(std::abs(frame.left.cross(frame.up).dot(frame.forward) - 1) < 1e-9);
  const auto place = [&](int region) {
    return Vec3(centroid_of(bake, static_cast<std::uint8_t>(region)) - frame.origin);
  };
  for (const int left : {0, 2}) {
    CHECK(place(left).dot(frame.left) > 0);
    CHECK(place(left + 1).dot(frame.left) < 0);
  }
  for (const int arm : {0, 1}) CHECK(place(arm).dot(frame.up) > place(arm + 2).dot(frame.up));
  // Toes are in front of the heels: the last foot sphere is ahead of the first leg sphere.
  for (const std::size_t leg : {2U, 3U}) {
    const std::vector<std::uint32_t>& ids = bake.spheres.of_region[leg];
    const Vec3 forward = bake.spheres.spheres[ids.back()].ball.center - bake.spheres.spheres[ids.front()].ball.center;
    CHECK(forward.dot(frame.forward) > 0);
  }
  for (const auto& ids : bake.spheres.of_region) CHECK(ids.size() >= 4);
}

TEST_CASE("clothes that meet in a seam leave the hips to the torso: both legs are alike") {
  const Bake& bake = person_in_pieces();
  std::array<double, 5> area{};
  for (std::size_t t = 0; t < bake.character.skin.triangles.size(); ++t) {
    area[bake.regions.of_skin[t]] += triangle_area(bake.character.skin, t);
  }
  CHECK(std::abs(area[2] / area[3] - 1) < 0.05);
  const auto& torso = bake.spheres.of_region[kTorso];
  const double lowest =
      (bake.spheres.spheres[torso[0]].ball.center - bake.regions.frame.origin).dot(bake.regions.frame.up);
  CHECK(lowest < 0.6 * bake.regions.frame.height);
}

TEST_CASE("a facing direction may say what the rig says; across it, or against it, it is refused") {
  const Bake& bake = person_in_pieces();
  const auto reason_against = [&](const Vec3& facing) -> std::string {
    SegmentSettings settings;
    settings.facing = facing;
    const Attempt<Regions> regions = segment_by_rig(bake.character, bake.regions.body, bake.roles, settings);
    if (!regions) return regions.reason().what;
    CHECK(regions->of_skin == segment_by_rig(bake.character, bake.regions.body, bake.roles, {})->of_skin);
    return "none";
  };
  const BodyFrame& frame = bake.regions.frame;
  CHECK(reason_against(3 * frame.forward + frame.left) == "none");
  for (const Vec3& facing : {frame.left, frame.up, Vec3(-frame.left + 0.2 * frame.forward)}) {
    CHECK(reason_against(facing).find("facing direction in the settings is not along") != std::string::npos);
  }
  CHECK(reason_against(-frame.forward).find("facing direction in the settings is against") != std::string::npos);
}

TEST_CASE("a rig without a trunk is refused as no body") {
  const Character& character = person_in_pieces().character;
  Roles none;
  none.of_node.resize(character.rig.nodes.size());
  const Attempt<Regions> regions = segment_by_rig(character, character.largest_piece, none, {});
  REQUIRE_FALSE(regions);
  CHECK(regions.reason().what.find("no trunk") != std::string::npos);
}

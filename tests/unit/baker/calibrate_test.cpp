// SPDX-License-Identifier: GPL-3.0-or-later
// Detect radii and rest pairs against other random poses than those they were fitted to.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "baked_human.h"
#include "calibrate/random_poses.h"
#include "calibrate/reach.h"
#include "jobs.h"
#include "motion/motion.h"
#include "play/player.h"

using namespace spherechain::baker;
using spherechain::Pair;
using spherechain::Sphere;
using spherechain::test::detect;
using spherechain::test::refit;

namespace {

constexpr std::uint64_t kOtherSeed = 4711;
constexpr double kRadiansADegree = 3.14159265358979323846 / 180;

const std::vector<VertexWeights>& weights_of_human() {
  return weights_to_bones(baked_human().character, baked_human().rig_weights);
}

// The skins that intersect, by spheres, found from vertices; without what intersects at rest.
std::set<Pair> touching_skins(Player& player, const std::vector<float>& positions) {
  const std::vector<Pair> pairs = player.spheres_of(player.detect_triangles(positions).pairs);
  return {pairs.begin(), pairs.end()};
}

double distance_at_rest(const Bake& bake, const Pair& pair) {
  return (bake.binding.spheres[pair.a].rest.center - bake.binding.spheres[pair.b].rest.center).norm();
}

double radii(const Bake& bake, const Pair& pair) {
  return bake.binding.spheres[pair.a].detect_radius + bake.binding.spheres[pair.b].detect_radius;
}

}  // namespace

TEST_CASE("in random poses of another seed the calibrated spheres report nearly all that truly touches") {
  const Bake& bake = baked_human();
  const OpenAsset asset = open_asset_of(bake);
  Player player(asset, SC_RADIUS_DETECT, false, true, SC_TARGET_SCALAR);
  const RandomPoses poses(bake.character, bake.joints);
  REQUIRE(poses.any());
  Random random(kOtherSeed);
  std::size_t touching = 0, found = 0;
  for (int i = 0; i < 40; ++i) {
    const std::vector<float> positions =
        pack(deform(bake.character.source_positions, weights_of_human(), poses.next(random).bones));
    const std::vector<Pair> reported =
        detect(asset, refit(asset, positions, SC_RADIUS_DETECT).spheres, SC_RADIUS_DETECT).pairs;
    for (const Pair& pair : touching_skins(player, positions)) {
      ++touching;
      found += std::binary_search(reported.begin(), reported.end(), pair) ? 1u : 0u;
    }
  }
  CHECK(touching > 100);
  CHECK(static_cast<double>(found) >= 0.9 * static_cast<double>(touching));
}

TEST_CASE("calibration changes only pairs that touch at rest or nearly, and no radius of limbs and torso") {
  const Bake& bake = baked_human();
  const Attempt<Binding> before = bind_spheres(bake.character, bake.regions, bake.spheres, bake.settings.bind);
  REQUIRE(before);
  for (std::size_t s = 0; s < before->spheres.size(); ++s) {
    CHECK(bake.binding.spheres[s].detect_radius == before->spheres[s].detect_radius);
    CHECK(bake.binding.spheres[s].rest.radius == before->spheres[s].rest.radius);
  }
  CHECK(bake.binding.ignored == before->ignored);
  CHECK(!bake.binding.rest_detect.empty());
  for (const BoundPair& pair : bake.binding.rest_detect) {
    CHECK(0.9 * distance_at_rest(bake, {pair.a, pair.b}) < radii(bake, {pair.a, pair.b}));
    CHECK(pair.rest_scale < 1);
  }
}

TEST_CASE("two bakes give the same bytes, and profile paper keeps nine tenths for all rest pairs") {
  const Bake& bake = baked_human();
  CHECK(rebake(bake, bake.settings).asset == bake.asset);
  const Bake& paper = paper_baked_human();
  CHECK(!paper.binding.rest_detect.empty());
  for (const BoundPair& pair : paper.binding.rest_detect) {
    const Pair spheres{pair.a, pair.b};
    CHECK(pair.rest_scale * radii(paper, spheres) == doctest::Approx(0.9 * distance_at_rest(paper, spheres)));
  }
}

TEST_CASE("the best line finds contacts for no more false alarms than they are worth") {
  CHECK(best_line({}, 5).value == 0);
  CHECK(best_line({{1, false}, {2, false}}, 5).value == 0);
  const Line both = best_line({{3, true}, {1, true}, {2, false}}, 5);
  CHECK(both.value == doctest::Approx(3));
  CHECK(both.gain == 9);
  std::vector<std::pair<double, bool>> values{{1, true}, {3, true}};
  for (int i = 0; i < 6; ++i) values.emplace_back(2, false);
  CHECK(best_line(values, 5).value == doctest::Approx(1));
  CHECK(best_line(values, 7).value == doctest::Approx(3));
}

TEST_CASE("a radius grows to contacts that happen often, for its false alarms, and a rest pair asks for no more") {
  // Spheres of radius 1: 0 and 1 touch at 2.2; 0 and 2 are at 2.1 and never touch.
  SampledPair touching{{0, 1}, {}}, apart{{0, 2}, {}};
  for (int i = 0; i < 100; ++i) {
    touching.samples.push_back({2.2F, 1, 1, true});
    apart.samples.push_back({2.1F, 1, 1, false});
  }
  const std::vector<double> grown = grow_radii({touching, apart}, {false, false}, 3);
  CHECK(grown[0] + grown[1] == doctest::Approx(2.2).epsilon(1e-3));
  CHECK(grown[2] == 1);
  CHECK(grow_radii({apart}, {true}, 3) == std::vector<double>{1, 1, 1});
  touching.samples.resize(2);  // too seldom
  CHECK(grow_radii({touching, apart}, {false, false}, 3) == std::vector<double>{1, 1, 1});
}

TEST_CASE("random poses stay within the limits of the clips, and are the same for the same seed") {
  Character character;
  Node root, tip;
  tip.parent = 0;
  tip.translation = {0, 1, 0};
  tip.local.translation() = tip.translation;
  character.rig.nodes = {root, tip};
  character.rig.bones = {{0, Affine::Identity()}, {1, Affine(Eigen::Translation3d(0, -1, 0))}};
  const Eigen::Quaterniond bent(Eigen::AngleAxisd(80 * kRadiansADegree, Vec3::UnitX()));
  Clip clip;
  clip.duration = 1;
  clip.channels = {{ChannelPath::kRotation, 1, Interpolation::kLinear, {0, 1}, {0, 0, 0, 1, bent.x(), 0, 0, bent.w()}}};
  character.rig.clips = {clip};

  const auto widest = [](const RandomPoses& poses) {
    Random random(kOtherSeed);
    Vec3 low = Vec3::Zero(), high = Vec3::Zero();
    for (int i = 0; i < 500; ++i) {
      const RandomPoses::Pose pose = poses.next(random);
      const Eigen::AngleAxisd turn(Eigen::Matrix3d(pose.bones[0].linear().transpose() * pose.bones[1].linear()));
      low = low.cwiseMin(turn.angle() * turn.axis());
      high = high.cwiseMax(turn.angle() * turn.axis());
    }
    return std::pair<Vec3, Vec3>(low / kRadiansADegree, high / kRadiansADegree);
  };
  const auto [low, high] = widest(RandomPoses(character, {}));
  CHECK(low.x() == doctest::Approx(-10).epsilon(0.2));
  CHECK(high.x() == doctest::Approx(90).epsilon(0.05));
  CHECK(high.y() < 16);  // 10 degrees from the middle of the bend
  CHECK(widest(RandomPoses(character, {})) == std::pair<Vec3, Vec3>(low, high));
  character.rig.clips.clear();
  const auto [without_low, without_high] = widest(RandomPoses(character, {}));
  CHECK(without_high.x() == doctest::Approx(45).epsilon(0.05));
  CHECK(without_low.z() == doctest::Approx(-45).epsilon(0.05));
}

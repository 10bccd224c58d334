// SPDX-License-Identifier: GPL-3.0-or-later
// Detect radii and rest pairs against other random poses than those they were fitted to.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "baked_human.h"
#include "baker/calibrate/random_poses.h"
#include "baker/calibrate/reach.h"
#include "baker/calibrate/skin_gap.h"
#include "baker/motion/motion.h"
#include "baker/play/player.h"
#include "jobs.h"

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
  const std::vector<Pair> pairs = player.spheres_of(player.detect_triangles(pose_of(positions), false).pairs);
  return {pairs.begin(), pairs.end()};
}

double distance_at_rest(const Bake& bake, const Pair& pair) {
  return (bake.binding.spheres[pair.a].rest.center - bake.binding.spheres[pair.b].rest.center).norm();
}

double radii(const Bake& bake, const Pair& pair) {
  return bake.binding.spheres[pair.a].detect_radius + bake.binding.spheres[pair.b].detect_radius;
}

}  // namespace

TEST_CASE("in random poses of another seed the calibrated spheres report nearly all that truly touches" *
          doctest::test_suite("many bakes")) {
  const Bake& bake = baked_human();
  const OpenAsset asset = open_asset_of(bake);
  Player player(asset, SC_RADIUS_DETECT, SC_TARGET_SCALAR);
  const RandomPoses poses(bake.character, bake.joints);
  REQUIRE(poses.any());
  Random random(kOtherSeed);
  std::size_t touching = 0, found = 0;
  for (int i = 0; i < 40; ++i) {
    const std::vector<float> positions =
        pack(deform(bake.character.source_positions, weights_of_human(), poses.next(random, i % 3, i / 40.0).bones));
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

TEST_CASE("calibration changes no radius of limbs and torso, and lists few pairs") {
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
    CHECK(pair.rest_scale > 0);
    CHECK(pair.rest_scale < 1);
  }
  CHECK(bake.binding.rest_detect.size() < 100);
  // At rest only pairs are reported whose skins all but touch.
  const OpenAsset asset = open_asset_of(bake);
  const std::vector<float> rest = pack(bake.character.source_positions);
  const SkinGaps gaps(bake.character.skin, bake.binding);
  for (const Pair& pair : detect(asset, refit(asset, rest, SC_RADIUS_DETECT).spheres, SC_RADIUS_DETECT).pairs) {
    CHECK(gaps.between(pair.a, pair.b) < 0.003 * bake.regions.frame.height);
  }
}

TEST_CASE("two bakes give the same bytes, and profile paper keeps nine tenths for all rest pairs" *
          doctest::test_suite("long runs")) {
  const Bake& bake = baked_human();
  CHECK(rebake(bake, bake.settings).asset == bake.asset);
  const Bake& paper = paper_baked_human();
  CHECK(!paper.binding.rest_detect.empty());
  for (const BoundPair& pair : paper.binding.rest_detect) {
    const Pair spheres{pair.a, pair.b};
    CHECK(pair.rest_scale * radii(paper, spheres) == doctest::Approx(0.9 * distance_at_rest(paper, spheres)));
  }
}

namespace {

// A pair of spheres of radius 1, `times` at a distance.
void add(SampledPair& pair, int times, float distance, bool touch, bool expected = true) {
  for (int i = 0; i < times; ++i) pair.samples.push_back({distance, 1, 1, touch, expected});
}

using AtRest = std::optional<double>;

std::vector<double> reaches(const std::vector<SampledPair>& pairs, const AtRest& at_rest) {
  return best_reaches(pairs, std::vector<AtRest>(pairs.size(), at_rest), 4);
}

}  // namespace

TEST_CASE("a rest pair reaches as far as contacts are worth their false alarms") {
  SampledPair often{{0, 2}, {}}, dear{{0, 3}, {}};
  add(often, 100, 1, true);
  add(often, 7, 1.2F, false);
  add(often, 1, 1.4F, true);
  add(dear, 100, 1, true);
  add(dear, 9, 1.2F, false);
  add(dear, 1, 1.4F, true);
  const std::vector<double> found = reaches({often, dear}, 0.2);
  CHECK(found[0] == doctest::Approx(0.7).epsilon(0.02));
  CHECK(found[1] == doctest::Approx(0.5).epsilon(0.02));
}

TEST_CASE("a contact is worth more false alarms where too few contacts would be found") {
  SampledPair often{{0, 1}, {}}, dear{{0, 2}, {}};
  add(often, 10, 1, true);
  add(dear, 60, 1.2F, false);
  add(dear, 3, 1.4F, true);
  CHECK(reaches({often, dear}, 0.2)[1] == doctest::Approx(0.7).epsilon(0.02));
  add(often, 90, 1, true);
  CHECK(reaches({often, dear}, 0.2)[1] < 0.6);
  // Fewer samples are enough for poses that are not expected.
  SampledPair other{{0, 3}, {}};
  add(other, 9, 1, true, false);
  add(other, 20, 1.2F, false, false);
  add(other, 1, 1.4F, true, false);
  CHECK(reaches({often, other}, 0.2)[1] == doctest::Approx(0.5).epsilon(0.02));
}

TEST_CASE("an expected pose counts four times, and a contact more where no pose is expected") {
  SampledPair contact{{0, 1}, {}}, alarm{{0, 1}, {}}, unknown{{0, 1}, {}}, often{{0, 2}, {}};
  add(often, 100, 1, true);
  add(often, 100, 1, true, false);
  add(contact, 20, 1.2F, false, false);
  add(contact, 1, 1.4F, true);
  CHECK(reaches({contact, often}, 0.2)[0] == doctest::Approx(0.7).epsilon(0.02));
  add(alarm, 10, 1.2F, false);
  add(alarm, 1, 1.4F, true, false);
  CHECK(reaches({alarm, often}, 0.2)[0] < 0.6);
  add(unknown, 100, 1, true, false);
  add(unknown, 10, 1.2F, false, false);
  add(unknown, 1, 1.4F, true, false);
  CHECK(reaches({unknown}, 0.2)[0] == doctest::Approx(0.7).epsilon(0.02));
  CHECK(reaches({unknown, often}, 0.2)[0] == doctest::Approx(0.5).epsilon(0.02));
}

TEST_CASE("a rest pair reaches what it is at rest, or half of it where it nearly always is so and never touches") {
  SampledPair seldom{{0, 1}, {}}, always{{0, 2}, {}};
  add(seldom, 7, 1, false);
  add(always, 1000, 1, false);
  const std::vector<double> found = reaches({seldom, always}, 0.6);
  CHECK(found[0] == doctest::Approx(0.6).epsilon(0.02));
  CHECK(found[1] == doctest::Approx(0.3));
  // Where more of the gap must close than the centres are apart.
  CHECK(reaches({seldom}, -0.04)[0] == doctest::Approx(0.01));
}

TEST_CASE("a pair without contacts of its own reaches as far as its neighbours do, and never less than 0.3") {
  SampledPair touching{{0, 1}, {}}, silent{{0, 2}, {}}, alone{{2, 3}, {}};
  add(touching, 50, 2.2F, true);
  const std::vector<double> found = reaches({touching, silent, alone}, {});
  CHECK(found[0] == doctest::Approx(1.1).epsilon(0.01));
  CHECK(found[1] == doctest::Approx(1.1).epsilon(0.01));
  add(alone, 5000, 2.1F, false);
  CHECK(reaches({touching, silent, alone}, {})[2] == doctest::Approx(0.3));
  CHECK(reaches({silent}, {})[0] == 1);  // no sample at all
}

TEST_CASE("radii become what their pairs need, the same for mirrored spheres, and no less than the least") {
  const std::vector<SampledPair> pairs{{{0, 1}, {}}, {{0, 2}, {}}, {{1, 2}, {}}};
  const std::vector<double> wanted{1.4, 1.4, 0.7}, radii{2, 1, 1}, least{0.5, 0.5, 0.5};
  const std::vector<double> factors = radius_factors(pairs, wanted, radii, least);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto [a, b] = pairs[i].spheres;
    CHECK(factors[a] * radii[a] + factors[b] * radii[b] >= wanted[i] * (radii[a] + radii[b]) - 1e-9);
  }
  CHECK(factors[1] == factors[2]);
  CHECK(factors[0] < 1.45);
  CHECK(radius_factors(pairs, {0, 0, 0}, radii, least) == least);
  // Both 0 and 1 could give way, for 2 and 4 reach farther than they must; not both at once.
  const std::vector<SampledPair> row{{{0, 1}, {}}, {{0, 2}, {}}, {{2, 3}, {}}, {{1, 4}, {}}, {{4, 5}, {}}};
  const std::vector<double> asked{1.2, 1.4, 2, 1.4, 2};
  const std::vector<double> given = radius_factors(row, asked, std::vector<double>(6, 1), std::vector<double>(6, 0.5));
  for (std::size_t i = 0; i < row.size(); ++i) {
    CHECK(given[row[i].spheres.a] + given[row[i].spheres.b] >= 2 * asked[i] - 1e-9);
  }
  CHECK(given[0] + given[1] < 2.42);
}

TEST_CASE("false alarms beyond a reach are those that the radii report and it does not") {
  SampledPair pair{{0, 1}, {}};
  add(pair, 3, 1.5F, false);
  add(pair, 4, 1.5F, true);
  add(pair, 5, 1.1F, false);
  add(pair, 6, 2.5F, false);
  CHECK(false_alarms_beyond(pair, 0.6, 1, 1) == 3);
  CHECK(false_alarms_beyond(pair, 0.5, 1, 1) == 8);
  CHECK(false_alarms_beyond(pair, 0.6, 1.5, 1.5) == 9);
}

namespace {

// A root with `arms` bones on it, which bend together by 80 degrees in one clip.
Character bending(std::size_t arms) {
  Character character;
  Node root, arm;
  arm.parent = 0;
  arm.translation = {0, 1, 0};
  arm.local.translation() = arm.translation;
  character.rig.nodes = {root};
  character.rig.bones = {{0, Affine::Identity()}};
  const Eigen::Quaterniond bent(Eigen::AngleAxisd(80 * kRadiansADegree, Vec3::UnitX()));
  Clip clip;
  clip.duration = 1;
  for (Index i = 1; i <= arms; ++i) {
    character.rig.nodes.push_back(arm);
    character.rig.bones.push_back({i, Affine(Eigen::Translation3d(0, -1, 0))});
    clip.channels.push_back(
        {ChannelPath::kRotation, i, Interpolation::kLinear, {0, 1}, {0, 0, 0, 1, bent.x(), 0, 0, bent.w()}});
  }
  character.rig.clips = {clip};
  return character;
}

// The turn of a bone against the root's, in degrees about x.
double bend(const RandomPoses::Pose& pose, std::size_t bone) {
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(pose.bones[0].linear().transpose() * pose.bones[bone].linear()));
  return turn.angle() * turn.axis().x() / kRadiansADegree;
}

}  // namespace

TEST_CASE("moments of clips are the clips' own, spread over all their time") {
  const Character character = bending(2);
  const RandomPoses poses(character, {});
  REQUIRE(poses.have_clips());
  Random random(kOtherSeed);
  double least = 180, most = 0;
  for (int i = 0; i < 100; ++i) {
    const RandomPoses::Pose pose = poses.next(random, 0, i / 100.0);
    CHECK(bend(pose, 1) == doctest::Approx(bend(pose, 2)));
    CHECK(bend(pose, 1) == doctest::Approx(std::min(80.0, 0.8 * i * 31 / 30)).epsilon(0.02));
    least = std::min(least, bend(pose, 1));
    most = std::max(most, bend(pose, 1));
  }
  CHECK(least == doctest::Approx(0));
  CHECK(most == doctest::Approx(80));
}

TEST_CASE("with a moment for each branch half of the limbs bend on their own") {
  const Character character = bending(2);
  const RandomPoses poses(character, {});
  Random random(kOtherSeed);
  int apart = 0;
  for (int i = 0; i < 300; ++i) {
    const RandomPoses::Pose branched = poses.next(random, 1, 0);
    apart += std::abs(bend(branched, 1) - bend(branched, 2)) > 12 ? 1 : 0;  // each turns by up to 5 degrees more
  }
  CHECK(apart > 100);
  CHECK(apart < 250);
}

TEST_CASE("random poses stay within the limits of the clips, and are the same for the same seed") {
  Character character = bending(1);

  const auto widest = [](const RandomPoses& poses) {
    Random random(kOtherSeed);
    Vec3 low = Vec3::Zero(), high = Vec3::Zero();
    for (int i = 0; i < 500; ++i) {
      const RandomPoses::Pose pose = poses.next(random, 2, 0);
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

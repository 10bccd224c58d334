// SPDX-License-Identifier: MIT
// Refit by moments on the device has the spheres of the CPU's, bit for bit.
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>

#include "crowd_checks.h"
#include "jobs.h"

namespace spherechain::test {
namespace {

// A NaN is any NaN: the device has another one than the CPU.
bool same_figure(float l, float r) { return (std::isnan(l) && std::isnan(r)) || std::memcmp(&l, &r, sizeof l) == 0; }

bool same_figures(const Sphere& l, const Sphere& r) {
  return same_figure(l.x, r.x) && same_figure(l.y, r.y) && same_figure(l.z, r.z) && same_figure(l.radius, r.radius);
}

}  // namespace

TEST_CASE(
    "by moments: the spheres and pairs are those of the CPU's refit, for few bones and many, few spheres and many") {
  std::mt19937 random(8);
  std::size_t pairs = 0;
  RunCounts runs;
  for (const std::size_t bones : {1U, 2U, 3U, 4U, 9U, 20U}) {
    for (const unsigned spheres : {1U, 2U, 60U}) {
      CAPTURE(bones);
      CAPTURE(spheres);
      const OpenedAsset opened(moment_asset(spheres, bones, static_cast<unsigned>(bones)).parts);
      REQUIRE_MESSAGE(opened.status == Status::kOk, opened.message);
      const RadiusKind radius = spheres == 2 ? RadiusKind::kFit : RadiusKind::kDetect;
      const Tables tables(opened.asset, radius);
      runs.add(tables);
      GroupInput in = group_of(tables, 37);
      give_matrices(in, opened.asset, MatrixLayout::kRowMajor3x4, kPoseKinds[(bones + spheres) % 6], 0, random);
      const Expected wanted = pairs_of_bones(opened.asset, in, radius);
      run_and_check(in, wanted);
      pairs += wanted.pairs.size();
    }
  }
  CHECK(pairs > 1000);
  for (const std::size_t count : runs.of_kind) CHECK(count > 10);
}

TEST_CASE("by moments: every layout, alignment, radius and pose") {
  const OpenedAsset opened(moment_asset(40, 5, 8).parts);
  REQUIRE_MESSAGE(opened.status == Status::kOk, opened.message);
  std::mt19937 random(9);
  for (const MatrixLayout layout : {MatrixLayout::kRowMajor3x4, MatrixLayout::kRowMajor4x4,
                                    MatrixLayout::kColumnMajor4x4, MatrixLayout::kColumnMajor3x4}) {
    for (const std::size_t offset : {0U, 1U}) {
      for (const RadiusKind radius : {RadiusKind::kFit, RadiusKind::kDetect}) {
        for (const PoseKind pose : kPoseKinds) {
          const Tables tables(opened.asset, radius);
          GroupInput in = group_of(tables, 33);
          in.offset = offset;
          give_matrices(in, opened.asset, layout, pose, 4 + offset, random);
          run_and_check(in, pairs_of_bones(opened.asset, in, radius));
        }
      }
    }
  }
}

TEST_CASE("by moments: bones of any size, and none at all, have the CPU's radii") {
  std::mt19937 random(4);
  TinyAsset tiny = moment_asset(30, 3, 4);
  for (std::size_t i = 0; i < 40; ++i) {  // mean squares below 0, which no bones make of themselves
    for (float& value : tiny.parts.bone_refit.moments.moments[i].values) value = -value;
  }
  const OpenedAsset opened(tiny.parts);
  REQUIRE_MESSAGE(opened.status == Status::kOk, opened.message);
  const Tables tables(opened.asset, RadiusKind::kDetect);
  for (const float scale : {0.0F, 1e-38F, 1e-25F, 1e-16F, 1e-14F, 1e14F, 1e16F}) {
    CAPTURE(scale);
    GroupInput in = group_of(tables, 20);
    give_matrices(in, opened.asset, MatrixLayout::kRowMajor3x4, PoseKind::kRigid, 0, random);
    for (float& figure : in.matrices) figure *= scale;
    run_and_check(in, pairs_of_bones(opened.asset, in, RadiusKind::kDetect));
  }
}

TEST_CASE("by moments: matrices that are not finite leave the other instances alone, and other bones' spheres") {
  const TinyAsset tiny = moment_asset(60, 9, 6);
  const OpenedAsset opened(tiny.parts);
  REQUIRE_MESSAGE(opened.status == Status::kOk, opened.message);
  const std::uint32_t reference = opened.asset.moment_tables().reference;
  const Tables tables(opened.asset, RadiusKind::kDetect);
  std::mt19937 random(6);
  GroupInput in = group_of(tables, 40);
  give_matrices(in, opened.asset, MatrixLayout::kRowMajor3x4, PoseKind::kGentle, 0, random);
  const auto figure = [&](std::size_t instance, std::size_t bone, std::size_t i) -> float& {
    return in.matrices[(instance * opened.asset.bone_count() + bone) * 12 + i];
  };
  figure(3, 0, 5) = std::nanf("");
  figure(8, 0, 0) = 1e30F;  // whose square is not finite
  figure(17, 2, 3) = kInfinity;
  figure(21, reference, 7) = std::nanf("");
  figure(39, 1, 0) = -kInfinity;
  const Expected wanted = pairs_of_bones(opened.asset, in, RadiusKind::kDetect);
  in.pair_capacity = wanted.pairs.size();
  const CrowdRun run = run_crowd({in});
  REQUIRE(run.status == Status::kOk);
  check_pairs(in, run.groups[0], wanted);
  std::size_t finite[40] = {};
  bool same = true;
  for (std::size_t i = 0; i < wanted.spheres.size(); ++i) {
    same &= same_figures(run.groups[0].refitted[i], wanted.spheres[i]);
    finite[i / 60] += std::isfinite(wanted.spheres[i].x) && std::isfinite(wanted.spheres[i].radius) ? 1U : 0U;
  }
  CHECK(same);
  for (const std::size_t instance : {3U, 8U, 17U, 39U}) {
    CHECK(finite[instance] > 0);
    CHECK(finite[instance] < 60);
  }
  CHECK(finite[21] == 0);
  CHECK(finite[0] == 60);
}

TEST_CASE("by moments: the reference may be a bone that moves no sphere") {
  TinyAsset tiny = moment_asset(12, 2, 1);
  BoneRefitParts& refit = tiny.parts.bone_refit;
  refit.bones.insert(refit.bones.begin(), 2, refit.bones[0]);  // before the others, whose numbers change
  for (std::uint32_t& bone : refit.term_bones) bone += 2;
  for (std::uint16_t& bone : refit.moments.bones) bone += 2;
  for (BonePair& pair : refit.moments.pairs)
    pair = {static_cast<std::uint16_t>(pair.a + 2), static_cast<std::uint16_t>(pair.b + 2)};
  refit.moments.reference = 1;
  const OpenedAsset opened(tiny.parts);
  REQUIRE_MESSAGE(opened.status == Status::kOk, opened.message);
  const Tables tables(opened.asset, RadiusKind::kFit);
  std::mt19937 random(2);
  GroupInput in = group_of(tables, 5);
  give_matrices(in, opened.asset, MatrixLayout::kRowMajor3x4, PoseKind::kRigid, 0, random);
  run_and_check(in, pairs_of_bones(opened.asset, in, RadiusKind::kFit));
}

}  // namespace spherechain::test

// SPDX-License-Identifier: MIT
// Refit by moments on the device has the spheres of the CPU's, bit for bit.
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>

#include "crowd_checks.h"
#include "jobs.h"
#include "palette.h"

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
      REQUIRE_MESSAGE(opened.status == SC_OK, opened.message);
      const Radius radius = spheres == 2 ? SC_RADIUS_FIT : SC_RADIUS_DETECT;
      GroupInput in = group_of(opened.asset, radius, 37);
      runs.add(in.table);
      give_matrices(in, opened.asset, SC_ROWS_3X4, kPoseKinds[(bones + spheres) % 6], 0, random);
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
  REQUIRE_MESSAGE(opened.status == SC_OK, opened.message);
  std::mt19937 random(9);
  for (const MatrixLayout layout : {SC_ROWS_3X4, SC_ROWS_4X4, SC_COLUMNS_4X4, SC_COLUMNS_3X4}) {
    for (const std::size_t offset : {0U, 1U}) {
      for (const Radius radius : {SC_RADIUS_FIT, SC_RADIUS_DETECT}) {
        for (const PoseKind pose : kPoseKinds) {
          GroupInput in = group_of(opened.asset, radius, 33);
          in.offset = offset;
          give_matrices(in, opened.asset, layout, pose, 4 + offset, random);
          in.pose.bone_stride = offset * floats_of(layout) * sizeof(float);  // said, or left to the layout
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
    for (float& value : tiny.parts.moments.moments[i].values) value = -value;
  }
  const OpenedAsset opened(tiny.parts);
  REQUIRE_MESSAGE(opened.status == SC_OK, opened.message);
  for (const float scale : {0.0F, 1e-38F, 1e-25F, 1e-16F, 1e-14F, 1e14F, 1e16F}) {
    CAPTURE(scale);
    GroupInput in = group_of(opened.asset, SC_RADIUS_DETECT, 20);
    give_matrices(in, opened.asset, SC_ROWS_3X4, PoseKind::kRigid, 0, random);
    for (float& figure : in.matrices) figure *= scale;
    run_and_check(in, pairs_of_bones(opened.asset, in, SC_RADIUS_DETECT));
  }
}

TEST_CASE("by moments: matrices that are not finite leave the other instances alone, and other bones' spheres") {
  const TinyAsset tiny = moment_asset(60, 9, 6);
  const OpenedAsset opened(tiny.parts);
  REQUIRE_MESSAGE(opened.status == SC_OK, opened.message);
  const std::uint32_t reference = opened.view().moment_tables().reference;
  std::mt19937 random(6);
  GroupInput in = group_of(opened.asset, SC_RADIUS_DETECT, 40);
  give_matrices(in, opened.asset, SC_ROWS_3X4, PoseKind::kGentle, 0, random);
  const auto figure = [&](std::size_t instance, std::size_t bone, std::size_t i) -> float& {
    return in.matrices[(instance * opened.view().bone_count() + bone) * 12 + i];
  };
  figure(3, 0, 5) = std::nanf("");
  figure(8, 0, 0) = 1e30F;  // whose square is not finite
  figure(17, 2, 3) = kInfinity;
  figure(21, reference, 7) = std::nanf("");
  figure(39, 1, 0) = -kInfinity;
  const Expected wanted = pairs_of_bones(opened.asset, in, SC_RADIUS_DETECT);
  in.pair_capacity = wanted.pairs.size();
  const CrowdRun run = run_crowd({in});
  REQUIRE(run.status == SC_OK);
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
  AssetParts& parts = tiny.parts;
  parts.bones.insert(parts.bones.begin(), 2, parts.bones[0]);  // before the others, whose numbers change
  for (std::uint16_t& bone : parts.moments.bones) bone += 2;
  for (BonePair& pair : parts.moments.pairs)
    pair = {static_cast<std::uint16_t>(pair.a + 2), static_cast<std::uint16_t>(pair.b + 2)};
  parts.moments.reference = 1;
  const OpenedAsset opened(tiny.parts);
  REQUIRE_MESSAGE(opened.status == SC_OK, opened.message);
  std::mt19937 random(2);
  GroupInput in = group_of(opened.asset, SC_RADIUS_FIT, 5);
  give_matrices(in, opened.asset, SC_ROWS_3X4, PoseKind::kRigid, 0, random);
  run_and_check(in, pairs_of_bones(opened.asset, in, SC_RADIUS_FIT));
}

}  // namespace spherechain::test

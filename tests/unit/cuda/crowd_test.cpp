// SPDX-License-Identifier: MIT
// A crowd on the device has the spheres and pairs of the CPU's jobs, bit for bit.
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "crowd_checks.h"
#include "owned_filter.h"

namespace spherechain::test {
TEST_CASE("a crowd of spheres has each instance's pairs, whatever its size") {
  for (const unsigned n : {1U, 2U, 9U, 12U, 64U, 75U, 140U}) {
    std::mt19937 random(n);
    const OpenedAsset opened(random_asset(n, n).parts);
    for (const std::size_t instances : {1U, 3U, 32U, 33U, 70U}) {
      CAPTURE(n);
      CAPTURE(instances);
      const Radius radius = instances % 2 == 0 ? SC_RADIUS_FIT : SC_RADIUS_DETECT;
      GroupInput in = group_of(opened.asset, radius, instances);
      in.instance_stride = n + instances % 2;
      in.spheres = spheres_of(n, instances, in.instance_stride, random);
      const Expected wanted = pairs_of_spheres(opened.asset, in, radius);
      in.pair_capacity = wanted.pairs.size() + 1;
      CrowdRun run = run_crowd({in});
      REQUIRE(run.status == SC_OK);
      check_pairs(in, run.groups[0], wanted);
      in.wants_bits = in.wants_spheres = false;
      run = run_crowd({in});
      REQUIRE(run.status == SC_OK);
      check_pairs(in, run.groups[0], wanted);
      in.wants_bits = true;
      in.pair_capacity = 0;
      run = run_crowd({in});
      REQUIRE(run.status == SC_OK);
      check_pairs(in, run.groups[0], wanted);
    }
  }
}

TEST_CASE("a crowd of spheres that nearly all touch, more than a warp has room for, loses none") {
  for (const unsigned n : {60U, 75U, 140U}) {
    CAPTURE(n);
    std::mt19937 random(n);
    const OpenedAsset opened(random_asset(n, n).parts);
    GroupInput in = group_of(opened.asset, SC_RADIUS_DETECT, 40);
    in.spheres = spheres_of(n, 40, n, random);
    for (std::size_t i = 0; i < in.spheres.size(); ++i) in.spheres[i].radius *= i / n % 2 == 0 ? 1000.0F : 1.0F;
    const Expected wanted = pairs_of_spheres(opened.asset, in, SC_RADIUS_DETECT);
    CHECK(wanted.pairs.size() > std::size_t{15} * n * (n - 1) / 4);
    run_and_check(in, wanted);
  }
}

TEST_CASE("a crowd of spheres takes a filter") {
  for (const unsigned n : {20U, 60U, 75U}) {
    CAPTURE(n);
    std::mt19937 random(n);
    const OpenedAsset opened(random_asset(n, n).parts);
    OwnedFilter owned(opened.asset);
    edit_randomly(opened.asset, owned, random);
    GroupInput in = group_of(opened.asset, SC_RADIUS_DETECT, 70, &owned.filter);
    in.spheres = spheres_of(n, 70, n, random);
    const Expected wanted = pairs_of_spheres(opened.asset, in, SC_RADIUS_DETECT, &owned.filter);
    CHECK(!wanted.pairs.empty());
    run_and_check(in, wanted);
  }
}

namespace {

void check_touching(unsigned count) {
  TinyAsset tiny = random_asset(count, 3);
  tiny.parts.ignored.assign(tiny.parts.ignored.size(), 0);
  tiny.parts.rest_detect.clear();
  const OpenedAsset opened(tiny.parts);
  REQUIRE_MESSAGE(opened.status == SC_OK, opened.message);
  std::mt19937 random(4);
  for (const float away : {0.0F, 1.0F, 3e3F, 1e7F}) {
    for (const float size : {1e-19F, 1e-3F, 1.0F, 1e16F, 1e18F}) {  // the last: squares from the origin overflow
      CAPTURE(away);
      CAPTURE(size);
      GroupInput in = group_of(opened.asset, SC_RADIUS_DETECT, 64);
      for (std::size_t i = 0; i < in.instance_count; ++i) {
        const float x = away * size, step = uniform(random, 0.5F, 1.5F) * size;
        for (unsigned k = 0; k < count; ++k) {  // in a row, radii half of the steps but for a rounding or two
          const float nudge = 1.0F + static_cast<float>(static_cast<int>(random() % 5) - 2) * 0x1p-24F;
          in.spheres.push_back({x + step * static_cast<float>(k), x, -x, step * 0.5F * nudge});
        }
      }
      in.pair_capacity = 64 * count * count;
      const Expected wanted = pairs_of_spheres(opened.asset, in, SC_RADIUS_DETECT);
      const CrowdRun run = run_crowd({in});
      REQUIRE(run.status == SC_OK);
      check_pairs(in, run.groups[0], wanted);
    }
  }
}

}  // namespace

TEST_CASE("spheres that just touch, or just do not, near the origin and far from it, are distinguished as on the CPU") {
  for (const unsigned spheres : {41U, 60U, 77U}) {
    CAPTURE(spheres);
    check_touching(spheres);
  }
}

TEST_CASE("a crowd takes a filter as a single job does") {
  const OpenedAsset opened(moment_asset(70, 6, 5).parts);
  REQUIRE_MESSAGE(opened.status == SC_OK, opened.message);
  std::mt19937 random(5);
  OwnedFilter owned(opened.asset);
  edit_randomly(opened.asset, owned, random);
  GroupInput in = group_of(opened.asset, SC_RADIUS_DETECT, 50, &owned.filter);
  give_matrices(in, opened.asset, SC_ROWS_3X4, PoseKind::kGentle, 0, random);
  const Expected wanted = pairs_of_bones(opened.asset, in, SC_RADIUS_DETECT, &owned.filter);
  CHECK(!wanted.pairs.empty());
  in.instance_stride = 0;  // side by side
  run_and_check(in, wanted);
}

TEST_CASE("several assets, as bones and as spheres, share a launch") {
  std::mt19937 random(9);
  const OpenedAsset first(moment_asset(33, 5, 1).parts), second(random_asset(50, 2).parts),
      third(moment_asset(9, 3, 4).parts);
  REQUIRE(first.status == SC_OK);
  REQUIRE(third.status == SC_OK);
  std::vector<GroupInput> in = {group_of(first.asset, SC_RADIUS_DETECT, 45), group_of(second.asset, SC_RADIUS_FIT, 65),
                                group_of(third.asset, SC_RADIUS_DETECT, 0),
                                group_of(third.asset, SC_RADIUS_DETECT, 31)};
  give_matrices(in[0], first.asset, SC_ROWS_3X4, PoseKind::kRigid, 0, random);
  in[1].spheres = spheres_of(50, 65, 50, random);
  give_matrices(in[3], third.asset, SC_COLUMNS_4X4, PoseKind::kScaled, 0, random);
  run_and_check(in, {pairs_of_bones(first.asset, in[0], SC_RADIUS_DETECT),
                     pairs_of_spheres(second.asset, in[1], SC_RADIUS_FIT),
                     {},
                     pairs_of_bones(third.asset, in[3], SC_RADIUS_DETECT)});
}

TEST_CASE("a list that is too short is filled, nothing is written past it, and the count says what was needed") {
  std::mt19937 random(6);
  const OpenedAsset opened(random_asset(30, 6).parts);
  GroupInput in = group_of(opened.asset, SC_RADIUS_DETECT, 70);
  in.spheres = spheres_of(30, 70, 30, random);
  const Expected wanted = pairs_of_spheres(opened.asset, in, SC_RADIUS_DETECT);
  REQUIRE(wanted.pairs.size() > 300);
  in.pair_capacity = 200;
  const CrowdRun run = run_crowd({in});
  REQUIRE(run.status == SC_OK);
  check_pairs(in, run.groups[0], wanted);
}

TEST_CASE("what cannot be run is refused, with its field, and nothing is written") {
  std::mt19937 random(3);
  TinyAsset paper = random_asset(20, 7);
  paper.parts.refit = static_cast<std::uint8_t>(RefitRule::kPaper);
  add_bones(paper, 4, 7);
  const OpenedAsset opened(moment_asset(20, 4, 7).parts), boneless(random_asset(20, 7).parts), other(paper.parts);
  REQUIRE_MESSAGE(other.status == SC_OK, other.message);
  GroupInput good = group_of(opened.asset, SC_RADIUS_DETECT, 5);
  give_matrices(good, opened.asset, SC_ROWS_3X4, PoseKind::kRigid, 0, random);
  REQUIRE(run_crowd({good}).status == SC_OK);
  const auto refused = [&](sc_code code, sc_field field, auto change) {
    GroupInput in = good;
    change(in);
    const CrowdRun run = run_crowd({in});
    CHECK(run.status.code == code);
    CHECK(run.status.field == field);
    for (const std::uint32_t count : run.groups[0].counts) CHECK(count == 0xDDDDDDDDU);
  };
  refused(SC_NULL, SC_FIELD_TABLE, [](GroupInput& in) { in.table.clear(); });
  refused(SC_BAD_VALUE, SC_FIELD_TABLE, [](GroupInput& in) { in.table.assign(in.table.size(), 0); });
  refused(SC_NULL, SC_FIELD_SPHERES, [](GroupInput& in) { in.matrices.clear(); });
  refused(SC_BAD_VALUE, SC_FIELD_SPHERES, [&](GroupInput& in) { in.spheres.resize(100); });
  refused(SC_BAD_VALUE, SC_FIELD_VERTICES, [](GroupInput& in) { in.pose.vertices = in.matrices.data(); });
  refused(SC_BAD_VALUE, SC_FIELD_BONE_LAYOUT, [](GroupInput& in) { in.pose.bone_layout = SC_LAYOUT_UNSET; });
  refused(SC_TOO_SMALL, SC_FIELD_BONE_COUNT, [](GroupInput& in) { --in.pose.bone_count; });
  refused(SC_BAD_STRIDE, SC_FIELD_BONE_STRIDE, [](GroupInput& in) { in.pose.bone_stride = 44; });
  refused(SC_BAD_STRIDE, SC_FIELD_INSTANCE_STRIDE, [](GroupInput& in) { in.instance_stride -= 4; });
  refused(SC_BAD_STRIDE, SC_FIELD_INSTANCE_STRIDE, [](GroupInput& in) { in.instance_stride += 2; });
  refused(SC_BAD_STRIDE, SC_FIELD_INSTANCE_STRIDE, [](GroupInput& in) { in.instance_stride = ~std::size_t{3}; });
  for (const OpenedAsset* without : {&boneless, &other}) {
    refused(SC_NOT_IN_ASSET, SC_FIELD_BONES,
            [&](GroupInput& in) { in.table = table_of(without->asset, SC_RADIUS_DETECT); });
  }
  refused(SC_BAD_STRIDE, SC_FIELD_INSTANCE_STRIDE, [&](GroupInput& in) {
    in.matrices.clear();
    in.spheres.resize(100);
    in.instance_stride = 19;
  });
}

TEST_CASE("a table that cannot be prepared is refused, with its field, and nothing is written") {
  const OpenedAsset opened(moment_asset(20, 4, 7).parts);
  std::vector<std::uint64_t> words(cuda::crowd_table_words(opened.asset)), more(words.size() + 2);
  std::uint64_t* const askew = more.data() + (reinterpret_cast<std::uintptr_t>(more.data()) % 16 == 0 ? 1 : 0);
  const Asset closed;
  const auto refused = [&](sc_code code, sc_field field, const Asset& asset, Radius radius,
                           const std::uint64_t* ignored, std::uint64_t* data, std::size_t size) {
    const Status status = cuda::prepare_crowd(asset, radius, ignored, data, size);
    CHECK(status.code == code);
    CHECK(status.field == field);
    CHECK(words == std::vector<std::uint64_t>(words.size()));
  };
  const std::size_t size = words.size();
  const auto* const bad = reinterpret_cast<const std::uint64_t*>(reinterpret_cast<const char*>(words.data()) + 4);
  refused(SC_NOT_OPEN, SC_FIELD_ASSET, closed, SC_RADIUS_FIT, nullptr, words.data(), size);
  refused(SC_BAD_VALUE, SC_FIELD_RADIUS, opened.asset, static_cast<Radius>(7), nullptr, words.data(), size);
  refused(SC_NULL, SC_FIELD_TABLE, opened.asset, SC_RADIUS_FIT, nullptr, nullptr, size);
  refused(SC_MISALIGNED, SC_FIELD_TABLE, opened.asset, SC_RADIUS_FIT, nullptr, askew, size);
  refused(SC_TOO_SMALL, SC_FIELD_TABLE, opened.asset, SC_RADIUS_FIT, nullptr, words.data(), size - 1);
  refused(SC_MISALIGNED, SC_FIELD_IGNORED_PAIRS, opened.asset, SC_RADIUS_FIT, bad, words.data(), size);
  CHECK(cuda::crowd_table_words(closed) == 0);
  CHECK(cuda::crowd_block_bytes(nullptr, true, true, true) == 0);
  CHECK(cuda::crowd_block_bytes(words.data(), true, true, true) == 0);
}

TEST_CASE("an asset too large for a block's shared memory is refused without scratch, and with less than a block's") {
  const OpenedAsset opened(random_asset(700, 1).parts);
  std::mt19937 random(1);
  GroupInput in = group_of(opened.asset, SC_RADIUS_DETECT, 2);
  in.spheres = spheres_of(700, 2, 700, random);
  const std::size_t block = cuda::crowd_block_bytes(in.table.data(), false, true, false);
  CHECK(block > 227 * 1024);
  CHECK(block % 16 == 0);
  CHECK(run_crowd({in}).status == SC_DEVICE_TOO_SMALL);
  in.wants_spheres = true;
  in.scratch_bytes = block - 16;
  const CrowdRun run = run_crowd({in});
  CHECK(run.status == SC_TOO_SMALL);
  CHECK(run.groups[0].counts[0] == 0xDDDDDDDDU);
}

TEST_CASE("a crowd of hundreds of spheres runs from scratch, however many blocks of it there is room for") {
  for (const unsigned n : {216U, 1100U}) {
    const OpenedAsset opened(random_asset(n, n).parts);
    std::mt19937 random(n);
    const std::size_t instances = n > 1000 ? 2 : 100;
    GroupInput in = group_of(opened.asset, SC_RADIUS_DETECT, instances);
    in.spheres = spheres_of(n, instances, n, random);
    const Expected wanted = pairs_of_spheres(opened.asset, in, SC_RADIUS_DETECT);
    in.pair_capacity = wanted.pairs.size() + 1;
    const std::size_t block = cuda::crowd_block_bytes(in.table.data(), false, true, true);
    for (const std::size_t blocks : {1U, 3U, 9U}) {
      CAPTURE(n);
      CAPTURE(blocks);
      if (n > 1000 && blocks > 1) continue;
      in.scratch_bytes = blocks * block + 16;
      const CrowdRun run = run_crowd({in});
      REQUIRE(run.status == SC_OK);
      check_pairs(in, run.groups[0], wanted);
    }
  }
}

TEST_CASE("large assets run from bones too, beside small ones and spheres") {
  const OpenedAsset large(moment_asset(240, 7, 3).parts), small(moment_asset(20, 5, 2).parts);
  std::mt19937 random(6);
  std::vector<GroupInput> in = {group_of(large.asset, SC_RADIUS_DETECT, 65), group_of(small.asset, SC_RADIUS_FIT, 40),
                                group_of(large.asset, SC_RADIUS_DETECT, 33), group_of(small.asset, SC_RADIUS_FIT, 20),
                                group_of(large.asset, SC_RADIUS_DETECT, 9)};
  give_matrices(in[0], large.asset, SC_ROWS_3X4, PoseKind::kGentle, 0, random);
  give_matrices(in[1], small.asset, SC_ROWS_3X4, PoseKind::kGentle, 0, random);
  give_matrices(in[2], large.asset, SC_COLUMNS_3X4, PoseKind::kRigid, 0, random);
  in[3].spheres = spheres_of(20, 20, 20, random);
  in[4].spheres = spheres_of(240, 9, 240, random);
  const std::size_t block = cuda::crowd_block_bytes(in[0].table.data(), true, true, true);
  CHECK(block > 227 * 1024);
  for (std::size_t g = 0; g < in.size(); ++g) in[g].scratch_bytes = (g + 1) * block;
  run_and_check(
      in, {pairs_of_bones(large.asset, in[0], SC_RADIUS_DETECT), pairs_of_bones(small.asset, in[1], SC_RADIUS_FIT),
           pairs_of_bones(large.asset, in[2], SC_RADIUS_DETECT), pairs_of_spheres(small.asset, in[3], SC_RADIUS_FIT),
           pairs_of_spheres(large.asset, in[4], SC_RADIUS_DETECT)});
}

}  // namespace spherechain::test

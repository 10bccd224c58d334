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
      const RadiusKind radius = instances % 2 == 0 ? RadiusKind::kFit : RadiusKind::kDetect;
      const Tables tables(opened.asset, radius);
      GroupInput in = group_of(tables, instances);
      in.stride = n + instances % 2;
      in.spheres = spheres_of(n, instances, in.stride, random);
      const Expected wanted = pairs_of_spheres(opened.asset, in, radius);
      in.pair_capacity = wanted.pairs.size() + 1;
      CrowdRun run = run_crowd({in});
      REQUIRE(run.status == Status::kOk);
      check_pairs(in, run.groups[0], wanted);
      in.wants_bits = in.wants_spheres = false;
      run = run_crowd({in});
      REQUIRE(run.status == Status::kOk);
      check_pairs(in, run.groups[0], wanted);
      in.wants_bits = true;
      in.pair_capacity = 0;
      run = run_crowd({in});
      REQUIRE(run.status == Status::kOk);
      check_pairs(in, run.groups[0], wanted);
    }
  }
}

TEST_CASE("a crowd of spheres that nearly all touch, more than a warp has room for, loses none") {
  for (const unsigned n : {60U, 75U, 140U}) {
    CAPTURE(n);
    std::mt19937 random(n);
    const OpenedAsset opened(random_asset(n, n).parts);
    const Tables tables(opened.asset, RadiusKind::kDetect);
    GroupInput in = group_of(tables, 40);
    in.spheres = spheres_of(n, 40, n, random);
    for (std::size_t i = 0; i < in.spheres.size(); ++i) in.spheres[i].radius *= i / n % 2 == 0 ? 1000.0F : 1.0F;
    const Expected wanted = pairs_of_spheres(opened.asset, in, RadiusKind::kDetect);
    CHECK(wanted.pairs.size() > std::size_t{15} * n * (n - 1) / 4);
    run_and_check(in, wanted);
  }
}

TEST_CASE("a crowd of spheres takes a filter; what is padded to below 0 touches nothing") {
  for (const unsigned n : {20U, 60U, 75U}) {
    CAPTURE(n);
    std::mt19937 random(n);
    const OpenedAsset opened(random_asset(n, n).parts);
    OwnedFilter owned(opened.asset);
    edit_randomly(opened.asset, owned.filter, random);
    for (unsigned i = 0; i < n; i += 5) owned.padding[i] = -0.5F * static_cast<float>(1 + i % 3);
    const Tables tables(opened.asset, RadiusKind::kDetect, &owned.filter);
    GroupInput in = group_of(tables, 70);
    in.spheres = spheres_of(n, 70, n, random);
    const Expected wanted = pairs_of_spheres(opened.asset, in, RadiusKind::kDetect, &owned.filter);
    CHECK(!wanted.pairs.empty());
    run_and_check(in, wanted);
  }
}

namespace {

void check_touching(unsigned count) {
  TinyAsset tiny = random_asset(count, 3);
  tiny.parts.ignored.assign(tiny.parts.ignored.size(), 0);
  tiny.parts.near_detect.clear();
  const OpenedAsset opened(tiny.parts);
  REQUIRE_MESSAGE(opened.status == Status::kOk, opened.message);
  const Tables tables(opened.asset, RadiusKind::kDetect);
  std::mt19937 random(4);
  for (const float away : {0.0F, 1.0F, 3e3F, 1e7F}) {
    for (const float size : {1e-19F, 1e-3F, 1.0F, 1e16F, 1e18F}) {  // the last: squares from the origin overflow
      CAPTURE(away);
      CAPTURE(size);
      GroupInput in = group_of(tables, 64);
      for (std::size_t i = 0; i < in.instance_count; ++i) {
        const float x = away * size, step = uniform(random, 0.5F, 1.5F) * size;
        for (unsigned k = 0; k < count; ++k) {  // in a row, radii half of the steps but for a rounding or two
          const float nudge = 1.0F + static_cast<float>(static_cast<int>(random() % 5) - 2) * 0x1p-24F;
          in.spheres.push_back({x + step * static_cast<float>(k), x, -x, step * 0.5F * nudge});
        }
      }
      in.pair_capacity = 64 * count * count;
      const Expected wanted = pairs_of_spheres(opened.asset, in, RadiusKind::kDetect);
      const CrowdRun run = run_crowd({in});
      REQUIRE(run.status == Status::kOk);
      check_pairs(in, run.groups[0], wanted);
    }
  }
}

}  // namespace

TEST_CASE("spheres that just touch, or just do not, near the origin and far from it, are told apart as on the CPU") {
  for (const unsigned spheres : {41U, 60U, 77U}) {
    CAPTURE(spheres);
    check_touching(spheres);
  }
}

TEST_CASE("a crowd takes a filter as a single job does, and the refitted spheres stay without its padding") {
  const OpenedAsset opened(moment_asset(70, 6, 5).parts);
  REQUIRE_MESSAGE(opened.status == Status::kOk, opened.message);
  std::mt19937 random(5);
  OwnedFilter owned(opened.asset);
  edit_randomly(opened.asset, owned.filter, random);
  const Tables tables(opened.asset, RadiusKind::kDetect, &owned.filter);
  GroupInput in = group_of(tables, 50);
  give_matrices(in, opened.asset, MatrixLayout::kRowMajor3x4, PoseKind::kGentle, 0, random);
  const Expected wanted = pairs_of_bones(opened.asset, in, RadiusKind::kDetect, &owned.filter);
  CHECK(!wanted.pairs.empty());
  run_and_check(in, wanted);
}

TEST_CASE("several assets, as bones and as spheres, share a launch") {
  std::mt19937 random(9);
  const OpenedAsset first(moment_asset(33, 5, 1).parts), second(random_asset(50, 2).parts),
      third(moment_asset(9, 3, 4).parts);
  REQUIRE(first.status == Status::kOk);
  REQUIRE(third.status == Status::kOk);
  const Tables a(first.asset, RadiusKind::kDetect), b(second.asset, RadiusKind::kFit),
      c(third.asset, RadiusKind::kDetect);
  std::vector<GroupInput> in = {group_of(a, 45), group_of(b, 65), group_of(c, 0), group_of(c, 31)};
  give_matrices(in[0], first.asset, MatrixLayout::kRowMajor3x4, PoseKind::kRigid, 0, random);
  in[1].spheres = spheres_of(50, 65, 50, random);
  give_matrices(in[3], third.asset, MatrixLayout::kColumnMajor4x4, PoseKind::kScaled, 0, random);
  run_and_check(in, {pairs_of_bones(first.asset, in[0], RadiusKind::kDetect),
                     pairs_of_spheres(second.asset, in[1], RadiusKind::kFit),
                     {},
                     pairs_of_bones(third.asset, in[3], RadiusKind::kDetect)});
}

TEST_CASE("a list that is too short is filled, nothing is written past it, and the count says what was needed") {
  std::mt19937 random(6);
  const OpenedAsset opened(random_asset(30, 6).parts);
  const Tables tables(opened.asset, RadiusKind::kDetect);
  GroupInput in = group_of(tables, 70);
  in.spheres = spheres_of(30, 70, 30, random);
  const Expected wanted = pairs_of_spheres(opened.asset, in, RadiusKind::kDetect);
  REQUIRE(wanted.pairs.size() > 300);
  in.pair_capacity = 200;
  const CrowdRun run = run_crowd({in});
  REQUIRE(run.status == Status::kOk);
  check_pairs(in, run.groups[0], wanted);
}

TEST_CASE("what cannot be run is refused, and nothing is written") {
  std::mt19937 random(3);
  TinyAsset of_pivots = random_asset(20, 7);  // has bones, but another refit rule
  add_bones(of_pivots, 4, 7);
  const OpenedAsset opened(moment_asset(20, 4, 7).parts), boneless(random_asset(20, 7).parts), other(of_pivots.parts);
  REQUIRE_MESSAGE(other.status == Status::kOk, other.message);
  const Tables tables(opened.asset, RadiusKind::kDetect), without(boneless.asset, RadiusKind::kDetect),
      without_moments(other.asset, RadiusKind::kDetect);
  GroupInput good = group_of(tables, 5);
  give_matrices(good, opened.asset, MatrixLayout::kRowMajor3x4, PoseKind::kRigid, 0, random);
  REQUIRE(run_crowd({good}).status == Status::kOk);
  const auto refused = [&](Status status, auto change) {
    GroupInput in = good;
    change(in);
    const CrowdRun run = run_crowd({in});
    CHECK(run.status == status);
    for (const std::uint32_t count : run.groups[0].counts) CHECK(count == 0xDDDDDDDDU);
  };
  const cuda::CrowdTables empty;
  refused(Status::kNullArgument, [](GroupInput& in) { in.tables = nullptr; });
  refused(Status::kNotOpen, [&](GroupInput& in) { in.tables = &empty; });
  refused(Status::kNullArgument, [](GroupInput& in) { in.words.clear(); });
  refused(Status::kNullArgument, [](GroupInput& in) { in.matrices.clear(); });
  refused(Status::kBadArgument, [&](GroupInput& in) { in.spheres.resize(100); });
  refused(Status::kTooFewBones, [](GroupInput& in) { --in.bone_count; });
  refused(Status::kBadStride, [](GroupInput& in) { in.bone_stride = 44; });
  refused(Status::kBadStride, [](GroupInput& in) { in.instance_stride -= 4; });
  refused(Status::kBadStride, [](GroupInput& in) { in.instance_stride += 2; });
  refused(Status::kBadStride, [](GroupInput& in) { in.instance_stride = ~std::size_t{3}; });
  for (const Tables* others : {&without, &without_moments}) {
    refused(Status::kNotInAsset, [&](GroupInput& in) {
      in.tables = &others->tables;
      in.words = others->words;
    });
  }
  refused(Status::kTooFewSpheres, [&](GroupInput& in) {
    in.matrices.clear();
    in.spheres.resize(100);
    in.stride = 19;
  });

  cuda::CrowdTables again;
  std::vector<std::uint64_t> words(cuda::CrowdTables::words_needed(opened.asset)), more(words.size() + 2);
  std::uint64_t* const askew = more.data() + (reinterpret_cast<std::uintptr_t>(more.data()) % 16 == 0 ? 1 : 0);
  const Asset closed;
  const auto build = [&](const Asset& asset, RadiusKind radius, const Filter* filter, std::uint64_t* data,
                         std::size_t size) {
    const Status status = again.build(asset, radius, filter, {data, size});
    CHECK(again.words.size == 0);
    return status;
  };
  const Filter bad{};
  CHECK(build(closed, RadiusKind::kFit, nullptr, words.data(), words.size()) == Status::kNotOpen);
  CHECK(build(opened.asset, static_cast<RadiusKind>(7), nullptr, words.data(), words.size()) == Status::kBadArgument);
  CHECK(build(opened.asset, RadiusKind::kFit, nullptr, nullptr, words.size()) == Status::kNullArgument);
  CHECK(build(opened.asset, RadiusKind::kFit, nullptr, words.data(), words.size() - 1) == Status::kContextTooSmall);
  CHECK(build(opened.asset, RadiusKind::kFit, nullptr, askew, words.size()) == Status::kMisaligned);
  CHECK(build(opened.asset, RadiusKind::kFit, &bad, words.data(), words.size()) == Status::kBadFilter);
}

TEST_CASE("an asset too large for a block's shared memory is refused without scratch, and with less than a block's") {
  const OpenedAsset opened(random_asset(700, 1).parts);
  const Tables tables(opened.asset, RadiusKind::kDetect);
  std::mt19937 random(1);
  GroupInput in = group_of(tables, 2);
  in.spheres = spheres_of(700, 2, 700, random);
  const std::size_t block = tables.tables.block_bytes(false, true, false);
  CHECK(block > 227 * 1024);
  CHECK(block % 16 == 0);
  CHECK(run_crowd({in}).status == Status::kDeviceTooSmall);
  in.wants_spheres = true;
  in.scratch_bytes = block - 16;
  const CrowdRun run = run_crowd({in});
  CHECK(run.status == Status::kContextTooSmall);
  CHECK(run.groups[0].counts[0] == 0xDDDDDDDDU);
}

TEST_CASE("a crowd of hundreds of spheres runs from scratch, however many blocks of it there is room for") {
  for (const unsigned n : {216U, 1100U}) {
    const OpenedAsset opened(random_asset(n, n).parts);
    const Tables tables(opened.asset, RadiusKind::kDetect);
    std::mt19937 random(n);
    const std::size_t instances = n > 1000 ? 2 : 100;
    GroupInput in = group_of(tables, instances);
    in.spheres = spheres_of(n, instances, n, random);
    const Expected wanted = pairs_of_spheres(opened.asset, in, RadiusKind::kDetect);
    in.pair_capacity = wanted.pairs.size() + 1;
    const std::size_t block = tables.tables.block_bytes(false, true, true);
    for (const std::size_t blocks : {1U, 3U, 9U}) {
      CAPTURE(n);
      CAPTURE(blocks);
      if (n > 1000 && blocks > 1) continue;
      in.scratch_bytes = blocks * block + 16;
      const CrowdRun run = run_crowd({in});
      REQUIRE(run.status == Status::kOk);
      check_pairs(in, run.groups[0], wanted);
    }
  }
}

TEST_CASE("large assets run from bones too, beside small ones and spheres") {
  const OpenedAsset large(moment_asset(240, 7, 3).parts), small(moment_asset(20, 5, 2).parts);
  const Tables a(large.asset, RadiusKind::kDetect), b(small.asset, RadiusKind::kFit);
  std::mt19937 random(6);
  std::vector<GroupInput> in = {group_of(a, 65), group_of(b, 40), group_of(a, 33), group_of(b, 20), group_of(a, 9)};
  give_matrices(in[0], large.asset, MatrixLayout::kRowMajor3x4, PoseKind::kGentle, 0, random);
  give_matrices(in[1], small.asset, MatrixLayout::kRowMajor3x4, PoseKind::kGentle, 0, random);
  give_matrices(in[2], large.asset, MatrixLayout::kColumnMajor3x4, PoseKind::kRigid, 0, random);
  in[3].spheres = spheres_of(20, 20, 20, random);
  in[4].spheres = spheres_of(240, 9, 240, random);
  const std::size_t block = a.tables.block_bytes(true, true, true);
  CHECK(block > 227 * 1024);
  for (std::size_t g = 0; g < in.size(); ++g) in[g].scratch_bytes = (g + 1) * block;
  run_and_check(
      in,
      {pairs_of_bones(large.asset, in[0], RadiusKind::kDetect), pairs_of_bones(small.asset, in[1], RadiusKind::kFit),
       pairs_of_bones(large.asset, in[2], RadiusKind::kDetect), pairs_of_spheres(small.asset, in[3], RadiusKind::kFit),
       pairs_of_spheres(large.asset, in[4], RadiusKind::kDetect)});
}

}  // namespace spherechain::test

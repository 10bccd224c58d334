// SPDX-License-Identifier: MIT
// Covers of a crowd are the balls of CoverJob, bit for bit, and no two spheres whose skins touch are missing among its
// candidates.
#include <doctest/doctest.h>

#include <cmath>

#include "../../golden/clip.h"
#include "crowd_checks.h"
#include "jobs.h"
#include "spherechain/triangle_contacts.h"
#include "tiny_surface.h"

namespace spherechain::test {
namespace {

// Sphere 3 has 24 leaves of a triangle each, 4 to 8 have none.
TinyAsset covered_asset(unsigned spheres, std::size_t bones, unsigned seed) {
  TinyAsset tiny = random_asset(spheres, seed);
  for (std::size_t s = 4; s <= 8; ++s) {
    tiny.parts.spheres[3].triangle_count += tiny.parts.spheres[s].triangle_count;
    tiny.parts.spheres[s].triangle_count = 0;
  }
  const TinySkin skin = add_bones(tiny, bones, seed + 1);
  add_surface(tiny, &skin, 1);
  return tiny;
}

// A processor's NaN is not the device's.
std::vector<Sphere> with_one_nan(std::vector<Sphere> spheres) {
  for (Sphere& s : spheres) {
    for (float* value : {&s.x, &s.y, &s.z, &s.radius}) *value = std::isnan(*value) ? std::nanf("") : *value;
  }
  return spheres;
}

struct ExpectedCovers {
  std::vector<Sphere> leaves;
  Expected pairs;  // and the spheres' balls
};

// All pairs but those that are ignored, disabled, without leaves or apart: by doubles, where a shade of doubt is none.
ExpectedCovers covers_of(const Asset& asset, const GroupInput& in, const Filter* filter = nullptr) {
  ExpectedCovers out;
  const std::size_t n = asset.spheres().size, words = DetectJob::bit_words(asset);
  const Span<const std::uint64_t> ignored =
      filter == nullptr ? asset.ignored() : Span<const std::uint64_t>{filter->ignored.data, filter->ignored.size};
  const auto test = [](const auto& bits, std::size_t bit) { return (bits[bit / 64] >> (bit % 64) & 1U) != 0; };
  std::vector<bool> is_left_out(n, true);
  for (const Leaf& leaf : asset.surface().leaves) is_left_out[leaf.sphere] = false;
  for (std::size_t i = 0; i < n && filter != nullptr; ++i) {
    if (test(filter->disabled, i)) is_left_out[i] = true;
  }
  for (std::size_t i = 0; i < in.instance_count; ++i) {
    const Covered covered = cover(asset, bones_of(in, i), morph_weights_of(in, asset, i), Target::kScalar);
    REQUIRE(covered.status == Status::kOk);
    out.leaves.insert(out.leaves.end(), covered.leaves.begin(), covered.leaves.end());
    out.pairs.spheres.insert(out.pairs.spheres.end(), covered.spheres.begin(), covered.spheres.end());
    std::vector<Pair> pairs;
    out.pairs.bits.resize((i + 1) * words);
    for (std::uint32_t a = 0; a < n; ++a) {
      for (std::uint32_t b = a + 1; b < n; ++b) {
        const std::size_t bit = std::size_t{b} * (b - 1) / 2 + a;
        const Sphere &p = covered.spheres[a], &q = covered.spheres[b];
        const auto padding = [&](std::uint32_t s) { return filter == nullptr ? 0.0F : filter->padding[s]; };
        constexpr float kShare = 1.0F + 0x1p-20F;
        const float dx = p.x - q.x, dy = p.y - q.y, dz = p.z - q.z;
        const float ra = p.radius * kShare + padding(a), rb = q.radius * kShare + padding(b), s = ra + rb;
        const bool is_there = !is_left_out[a] && !is_left_out[b] && !(ra < 0) && !(rb < 0);
        if (is_there && !test(ignored, bit) && !((dx * dx + dy * dy) + dz * dz > s * s)) {
          pairs.push_back({a, b});
          out.pairs.bits[i * words + bit / 64] |= std::uint64_t{1} << (bit % 64);
        }
      }
    }
    out.pairs.counts.push_back(static_cast<std::uint32_t>(pairs.size()));
    out.pairs.pairs.insert(out.pairs.pairs.end(), pairs.begin(), pairs.end());
  }
  return out;
}

void check_covers(GroupInput in, const ExpectedCovers& wanted) {
  in.wants_leaves = true;
  in.pair_capacity = wanted.pairs.pairs.size() + 1;
  const CrowdRun run = run_crowd({in});
  REQUIRE(run.status == Status::kOk);
  CHECK(same_bits(with_one_nan(run.groups[0].leaves), with_one_nan(wanted.leaves)));
  CHECK(same_bits(with_one_nan(run.groups[0].refitted), with_one_nan(wanted.pairs.spheres)));
  check_pairs(in, run.groups[0], wanted.pairs);
}

}  // namespace

TEST_CASE("covers of a crowd are CoverJob's, for every pose, layout, alignment and morph") {
  const OpenedAsset opened(covered_asset(30, 7, 2).parts);
  REQUIRE_MESSAGE(opened.status == Status::kOk, opened.message);
  const Tables tables(opened.asset, Tables::Covers{});
  CHECK(tables.tables.leaf_count() == opened.asset.leaf_count());
  std::mt19937 random(3);
  std::size_t pairs = 0, most = 0;
  for (const MatrixLayout layout : {MatrixLayout::kRowMajor3x4, MatrixLayout::kRowMajor4x4,
                                    MatrixLayout::kColumnMajor4x4, MatrixLayout::kColumnMajor3x4}) {
    for (const PoseKind kind : kPoseKinds) {
      for (const bool morphs : {false, true}) {
        CAPTURE(static_cast<int>(layout));
        CAPTURE(static_cast<int>(kind));
        CAPTURE(morphs);
        GroupInput in = group_of(tables, 35);
        in.offset = static_cast<std::size_t>(kind) % 2;
        give_matrices(in, opened.asset, layout, kind, 4 + in.offset, random);
        if (morphs) in.morph_weights = random_morph_weights(35 * opened.asset.morph_count(), random);
        const ExpectedCovers wanted = covers_of(opened.asset, in);
        check_covers(in, wanted);
        pairs += wanted.pairs.pairs.size();
        most += 35 * 30 * 29 / 2;
      }
    }
  }
  CHECK(pairs > most / 50);
  CHECK(pairs < most / 3 * 2);
}

TEST_CASE("covers under matrices too large, too small and not finite are CoverJob's, and never surely apart") {
  const OpenedAsset opened(covered_asset(20, 60, 4).parts);  // so many bones that each moves a few leaves
  const Tables tables(opened.asset, Tables::Covers{});
  std::mt19937 random(5);
  GroupInput in = group_of(tables, 64);
  give_matrices(in, opened.asset, MatrixLayout::kRowMajor3x4, PoseKind::kRigid, 0, random);
  in.morph_weights = random_morph_weights(64 * opened.asset.morph_count(), random);
  const float values[] = {3e38F,  -1e30F,    1e19F, 1e-19F,     1e-38F, 1e-45F, -0.0F,
                          1e-22F, kInfinity, 1e25F, -kInfinity, -2e19F, 1e10F,  std::nanf("")};
  for (std::size_t i = 0; i < in.instance_count; ++i) {
    const float value = values[i % std::size(values)];
    float* first = &in.matrices[i * in.instance_stride / 4];
    if (i < 2 * std::size(values)) {
      first[random() % (in.instance_stride / 4)] = value;
    } else {
      for (std::size_t k = 0; k < in.instance_stride / 4; ++k) first[k] *= value;
    }
    if (i % 5 == 0) in.morph_weights[i * opened.asset.morph_count()] = value;
  }
  const ExpectedCovers wanted = covers_of(opened.asset, in);
  std::size_t lost = 0, full = 0;
  for (const Sphere& ball : wanted.pairs.spheres) lost += std::isfinite(ball.x) ? 0U : 1U;
  for (const std::uint32_t count : wanted.pairs.counts) full += count > 60 ? 1U : 0U;
  CHECK(lost > 100);
  CHECK(full > 5);
  check_covers(in, wanted);
}

TEST_CASE("skins that touch are among the candidates, whatever the pose") {
  const OpenedAsset opened(covered_asset(40, 6, 6).parts);
  const Tables tables(opened.asset, Tables::Covers{});
  std::mt19937 random(7);
  std::size_t touching = 0, missing = 0;
  for (const PoseKind kind : kPoseKinds) {
    GroupInput in = group_of(tables, 64);
    give_matrices(in, opened.asset, MatrixLayout::kRowMajor3x4, kind, 0, random);
    for (std::size_t i = 0; i < in.matrices.size(); ++i) {  // together, for a few to touch
      if (i % 4 == 3) in.matrices[i] *= 0.1F;
    }
    const CrowdRun run = run_crowd({in});
    REQUIRE(run.status == Status::kOk);
    std::vector<std::uint64_t> words(TriangleContactContext::words_needed(opened.asset));
    for (std::size_t i = 0; i < in.instance_count; ++i) {
      TriangleContactContext context{{words.data(), words.size()}};
      std::vector<SphereContact> contacts(780);
      TriangleContactJob job;
      job.asset = &opened.asset;
      job.bones = bones_of(in, i);
      job.context = &context;
      job.sphere_contacts = {contacts.data(), contacts.size()};
      REQUIRE(job.run() == Status::kOk);
      for (std::size_t k = 0; k < job.sphere_contact_count; ++k) {
        const Pair pair = contacts[k].spheres;
        const std::size_t bit = std::size_t{pair.b} * (pair.b - 1) / 2 + pair.a;
        const std::uint64_t* bits = &run.groups[0].bits[i * tables.tables.bit_words()];
        missing += (bits[bit / 64] >> (bit % 64) & 1U) != 0 ? 0U : 1U;
        ++touching;
      }
    }
  }
  CHECK(touching > 200);
  CHECK(missing == 0);
}

TEST_CASE("covers of a filter: ignored pairs and disabled spheres are no candidates, padding counts") {
  constexpr std::uint32_t kSpheres = 33;
  const OpenedAsset opened(covered_asset(kSpheres, 6, 8).parts);
  std::mt19937 random(9);
  std::vector<std::uint64_t> ignored(Filter::ignored_words(opened.asset)), disabled(1);
  std::vector<float> padding(kSpheres);
  Filter filter{{ignored.data(), ignored.size()}, {disabled.data(), 1}, {padding.data(), kSpheres}};
  REQUIRE(reset_filter(opened.asset, filter) == Status::kOk);
  for (std::uint32_t i = 1; i < kSpheres; ++i) {
    if (i % 5 == 0) REQUIRE(disable_sphere(opened.asset, filter, i) == Status::kOk);
    REQUIRE(pad_sphere(opened.asset, filter, i, uniform(random, i % 3 == 0 ? -9 : 0, 0.3F)) == Status::kOk);
    REQUIRE(ignore_pair(opened.asset, filter, i, i - 1, i % 2 == 0) == Status::kOk);
  }
  const Tables tables(opened.asset, Tables::Covers{}, &filter);
  GroupInput in = group_of(tables, 40);
  give_matrices(in, opened.asset, MatrixLayout::kRowMajor3x4, PoseKind::kGentle, 0, random);
  check_covers(in, covers_of(opened.asset, in, &filter));
}

TEST_CASE("a bound around covers holds their balls, wherever spheres without skin rest") {
  const OpenedAsset opened(covered_asset(20, 4, 3).parts);
  const Tables tables(opened.asset, Tables::Covers{});
  std::mt19937 random(2);
  GroupInput in = group_of(tables, 33);
  give_matrices(in, opened.asset, MatrixLayout::kRowMajor3x4, PoseKind::kGentle, 0, random);
  for (std::size_t i = 3; i < in.matrices.size(); i += 12) in.matrices[i] += 1000.0F;
  const CrowdRun run = run_crowd({in});
  REQUIRE(run.status == Status::kOk);
  for (std::size_t i = 0; i < in.instance_count; ++i) {
    const Sphere& bound = run.groups[0].bounds[i];
    CHECK(bound.radius < 20);
    for (std::size_t k = 0; k < 20; ++k) {
      const Sphere& s = run.groups[0].refitted[i * 20 + k];
      const double away = std::hypot(double{s.x} - bound.x, double{s.y} - bound.y, double{s.z} - bound.z);
      CHECK((away + s.radius <= bound.radius || (k >= 4 && k <= 8)));
    }
  }
}

TEST_CASE("covers and spheres of one asset share a launch") {
  const OpenedAsset opened(covered_asset(25, 5, 5).parts);
  const Tables covers(opened.asset, Tables::Covers{}), spheres(opened.asset, RadiusKind::kDetect);
  std::mt19937 random(4);
  std::vector<GroupInput> in = {group_of(spheres, 40), group_of(covers, 40)};
  give_matrices(in[0], opened.asset, MatrixLayout::kColumnMajor4x4, PoseKind::kGentle, 0, random);
  give_matrices(in[1], opened.asset, MatrixLayout::kColumnMajor4x4, PoseKind::kGentle, 0, random);
  in[1].wants_leaves = true;
  const ExpectedCovers wanted = covers_of(opened.asset, in[1]);
  const CrowdRun run = run_crowd(in);
  REQUIRE(run.status == Status::kOk);
  for (std::size_t i = 0; i < 40; ++i) {
    const auto first = run.groups[0].refitted.begin() + static_cast<std::ptrdiff_t>(25 * i);
    CHECK(same_bits({first, first + 25},
                    refit_bones(opened.asset, bones_of(in[0], i), {}, RadiusKind::kDetect, Target::kScalar).spheres));
  }
  CHECK(same_bits(run.groups[1].leaves, wanted.leaves));
  CHECK(same_bits(run.groups[1].refitted, wanted.pairs.spheres));
  check_pairs(in[1], run.groups[1], wanted.pairs);
}

TEST_CASE("covers of the doll's clip are CoverJob's") {
  const Doll doll(SPHERECHAIN_GOLDEN, "doll_surface.sphc");
  REQUIRE_MESSAGE(doll.error.empty(), doll.error);
  const Tables tables(doll.asset, Tables::Covers{});
  GroupInput in = group_of(tables, kFrames);
  in.bone_count = doll.asset.bone_count();
  in.instance_stride = in.bone_count * 48;
  for (std::size_t frame = 0; frame < kFrames; ++frame) {
    for (const Matrix& matrix : matrices_at(doll.asset, frame)) {
      in.matrices.insert(in.matrices.end(), matrix.begin(), matrix.end());
    }
  }
  const ExpectedCovers wanted = covers_of(doll.asset, in);
  CHECK(!wanted.pairs.pairs.empty());
  check_covers(in, wanted);
}

TEST_CASE("covers of many spheres, or of many bones, come from scratch of as many bytes as shared_bytes says") {
  for (const bool has_many_bones : {false, true}) {
    const OpenedAsset opened((has_many_bones ? covered_asset(40, 200, 9) : covered_asset(250, 6, 9)).parts);
    const Tables tables(opened.asset, Tables::Covers{});
    std::mt19937 random(8);
    GroupInput in = group_of(tables, 65);
    give_matrices(in, opened.asset, MatrixLayout::kRowMajor3x4, PoseKind::kGentle, 0, random);
    const std::size_t block = tables.tables.shared_bytes(true, false, true, true);
    CHECK(block > 227 * 1024);
    in.scratch_bytes = 2 * block;
    check_covers(in, covers_of(opened.asset, in));
    in.scratch_bytes = block - 16;
    in.pair_capacity = 1;
    CHECK(run_crowd({in}).status == Status::kContextTooSmall);
  }
}

TEST_CASE("covers are refused where there are none, and as spheres") {
  std::mt19937 random(1);
  const OpenedAsset opened(covered_asset(20, 4, 7).parts), boneless(random_asset(20, 7).parts),
      without(boned_asset(20, 4, 7).parts);
  TinyAsset still = random_asset(20, 1);
  add_surface(still, nullptr, 4);
  const OpenedAsset unmoved(still.parts);
  cuda::CrowdTables tables;
  const std::size_t needed = cuda::CrowdTables::cover_words_needed(opened.asset);
  std::vector<std::uint64_t> words(needed);
  const Filter bad{};
  const Asset closed;
  const auto build = [&](const Asset& asset, const Filter* filter, std::uint64_t* data, std::size_t size) {
    const Status status = tables.build_covers(asset, filter, {data, size});
    CHECK(!tables.is_built());
    return status;
  };
  CHECK(build(closed, nullptr, words.data(), needed) == Status::kNotOpen);
  CHECK(build(boneless.asset, nullptr, words.data(), needed) == Status::kNotInAsset);
  CHECK(build(without.asset, nullptr, words.data(), needed) == Status::kNotInAsset);
  CHECK(build(unmoved.asset, nullptr, words.data(), needed) == Status::kNotInAsset);
  CHECK(build(opened.asset, nullptr, nullptr, needed) == Status::kNullArgument);
  CHECK(build(opened.asset, nullptr, words.data(), needed - 1) == Status::kContextTooSmall);
  CHECK(build(opened.asset, &bad, words.data(), needed) == Status::kBadFilter);
  CHECK(cuda::CrowdTables::cover_words_needed(unmoved.asset) == 0);

  const Tables covers(opened.asset, Tables::Covers{}), spheres(opened.asset, RadiusKind::kDetect);
  GroupInput in = group_of(covers, 3);
  in.spheres.resize(60);
  CHECK(run_crowd({in}).status == Status::kBadArgument);
  in.spheres.clear();
  CHECK(run_crowd({in}).status == Status::kNullArgument);
}

}  // namespace spherechain::test

// SPDX-License-Identifier: MIT
#include "spherechain/cover.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "jobs.h"
#include "random_poses.h"
#include "tiny_surface.h"

#ifdef __SSE__
#include <xmmintrin.h>
#endif

namespace spherechain::test {
namespace {

constexpr std::size_t kBones = 6;

struct Posable {
  explicit Posable(unsigned seed) : tiny(random_asset(11, seed)) {
    skin = add_bones(tiny, kBones, seed + 1);
    add_surface(tiny, &skin, 3);
  }
  TinyAsset tiny;
  TinySkin skin;
};

BoneMatrices view(const std::vector<Matrix>& matrices) { return {matrices[0].data(), matrices.size()}; }

double distance(const Sphere& ball, const std::array<double, 3>& p) {
  return std::hypot(p[0] - ball.x, p[1] - ball.y, p[2] - ball.z);
}

// The source vertices of a leaf.
std::vector<std::uint32_t> vertices_of(const Asset& asset, const Leaf& leaf) {
  std::vector<std::uint32_t> out;
  for (std::size_t i = 0; i < leaf.vertex_count; ++i) {
    out.push_back(asset.surface().source_vertices[asset.surface().leaf_vertices[leaf.first_vertex + i]]);
  }
  return out;
}

// What games set on their threads: the processor takes subnormal floats as zero.
struct NoSubnormals {
#ifdef __SSE__
  const unsigned before = _mm_getcsr();
  NoSubnormals() { _mm_setcsr(before | 0x8040U); }
  ~NoSubnormals() { _mm_setcsr(before); }
#else
  NoSubnormals() {}
#endif
  NoSubnormals(const NoSubnormals&) = delete;
  NoSubnormals& operator=(const NoSubnormals&) = delete;
};

std::vector<Matrix> shrunk_pose(int number, float scale, std::mt19937& random) {
  const PoseKind kind = kPoseKinds[static_cast<std::size_t>(number) % std::size(kPoseKinds)];
  std::vector<Matrix> matrices = random_pose(kBones, kind, 2, random);
  for (Matrix& matrix : matrices) {
    for (std::size_t i = 0; i < matrix.size(); ++i) {
      const bool is_translation = i % 4 == 3;  // kept by bones that are shrunk where they are
      matrix[i] *= is_translation && number % 3 == 0 ? 1.0F : scale;
    }
  }
  return matrices;
}

// Each sphere's cover contains its leaves' balls.
void check_contains_leaves(const Asset& asset, const Covered& covered) {
  for (std::size_t l = 0; l < asset.leaf_count(); ++l) {
    const Sphere& leaf = covered.leaves[l];
    const Sphere& sphere = covered.spheres[asset.surface().leaves[l].sphere];
    CHECK(distance(sphere, {double{leaf.x}, double{leaf.y}, double{leaf.z}}) + double{leaf.radius} <=
          double{sphere.radius});
  }
}

// Each vertex is in its leaf's ball, and that in its sphere's cover.
void check_covered(const Posable& p, const Asset& asset, const std::vector<Matrix>& matrices,
                   const std::vector<float>& weights) {
  const SkinnedSurface skinned = skin(asset, view(matrices), weights);
  const Covered covered = cover(asset, view(matrices), weights, Target::kScalar);
  for (const Target target : supported_targets()) {
    CHECK(same_bits(cover(asset, view(matrices), weights, target).leaves, covered.leaves));
  }
  check_contains_leaves(asset, covered);
  for (std::size_t l = 0; l < asset.leaf_count(); ++l) {
    CAPTURE(l);
    const Leaf& leaf = asset.surface().leaves[l];
    const Sphere& ball = covered.leaves[l];
    for (const std::uint32_t v : vertices_of(asset, leaf)) {
      const float* s = &skinned.positions[std::size_t{3} * v];
      CHECK(distance(ball, moved(p.tiny, p.skin, v, matrices, weights)) <= double{ball.radius});
      CHECK(distance(ball, {double{s[0]}, double{s[1]}, double{s[2]}}) <= double{ball.radius});
    }
  }
}

// Balls that are alike, and as far from each other as a figure that has no square.
void check_close_leaves() {
  Posable p(7);
  SurfaceParts& surface = p.tiny.parts.surface;
  for (BallLanes& balls : surface.leaf_balls) {
    for (std::size_t lane = 0; lane < kLeafLanes; ++lane) {
      if (balls.radius[lane] == 0) {
        continue;  // no leaf
      }
      balls.x[lane] = lane % 2 == 0 ? 1.0F : -1.0F;
      balls.y[lane] = balls.z[lane] = 0;
      balls.radius[lane] = 0.5F;
    }
  }
  for (CoverTerm& term : surface.cover_terms) {
    std::fill_n(term.deviations, kLeafLanes, 0.0F);
  }
  const OpenedAsset opened(p.tiny.parts);
  REQUIRE_MESSAGE(opened.status == Status::kOk, opened.message);
  for (int exponent = -60; exponent >= -80; --exponent) {
    CAPTURE(exponent);
    Matrix matrix{};
    matrix[0] = matrix[5] = matrix[10] = std::ldexp(1.3F, exponent);
    check_contains_leaves(opened.asset, cover(opened.asset, view(std::vector<Matrix>(kBones, matrix)), {}));
  }
}

void check_shrunk_poses() {
  for (unsigned seed = 1; seed <= 2; ++seed) {
    const Posable p(seed);
    const OpenedAsset opened(p.tiny.parts);
    std::mt19937 random(seed);
    for (int exponent = -10; exponent >= -44; --exponent) {
      for (int pose = 0; pose < 10; ++pose) {
        CAPTURE(exponent);
        CAPTURE(pose);
        const std::vector<Matrix> matrices = shrunk_pose(pose, static_cast<float>(std::pow(10.0, exponent)), random);
        check_covered(p, opened.asset, matrices,
                      pose % 2 == 0 ? std::vector<float>() : random_morph_weights(3, random));
      }
    }
  }
}

}  // namespace

TEST_CASE("in every pose every vertex, and where SkinJob puts it, is in its leaf's ball") {
  double ratio = 0;
  std::size_t balls = 0;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const Posable p(seed);
    const OpenedAsset opened(p.tiny.parts);
    REQUIRE(opened.status == Status::kOk);
    std::mt19937 random(seed);
    for (int pose = 0; pose < 300; ++pose) {
      const PoseKind kind = kPoseKinds[static_cast<std::size_t>(pose) % std::size(kPoseKinds)];
      const std::vector<Matrix> matrices = random_pose(kBones, kind, pose % 7 == 0 ? 1000.0F : 2.0F, random);
      const std::vector<float> weights = pose % 4 == 0 ? std::vector<float>() : random_morph_weights(3, random);
      const Covered covered = cover(opened.asset, view(matrices), weights);
      const SkinnedSurface skinned = skin(opened.asset, view(matrices), weights);
      REQUIRE(covered.status == Status::kOk);
      REQUIRE(skinned.status == Status::kOk);
      for (std::size_t l = 0; l < opened.asset.leaf_count(); ++l) {
        double tight = 0;
        for (const std::uint32_t v : vertices_of(opened.asset, opened.asset.surface().leaves[l])) {
          tight = std::max(tight, distance(covered.leaves[l], moved(p.tiny, p.skin, v, matrices, weights)));
          const float* s = &skinned.positions[std::size_t{3} * v];
          tight = std::max(tight, distance(covered.leaves[l], {double{s[0]}, double{s[1]}, double{s[2]}}));
        }
        CAPTURE(seed);
        CAPTURE(pose);
        CAPTURE(l);
        REQUIRE(tight <= double{covered.leaves[l].radius});
        ratio += covered.leaves[l].radius / tight;
        ++balls;
      }
    }
  }
  MESSAGE(balls, " balls: radius over the farthest vertex, mean ", ratio / static_cast<double>(balls));
}

TEST_CASE("poses shrunk to any size are covered too, on every target, and each sphere's leaves") {
  SUBCASE("with subnormal floats") {
    check_shrunk_poses();
    check_close_leaves();
  }
  SUBCASE("where those are zero") {
    const NoSubnormals set;
    check_shrunk_poses();
    check_close_leaves();
  }
}

TEST_CASE("where all bones move alike and rigidly the balls are those at rest, moved") {
  const Posable p(3);
  const OpenedAsset opened(p.tiny.parts);
  std::mt19937 random(4);
  const std::vector<Matrix> matrices(kBones, random_pose(1, PoseKind::kRigid, 1, random)[0]);
  const Covered covered = cover(opened.asset, view(matrices), {});
  for (std::size_t l = 0; l < opened.asset.leaf_count(); ++l) {
    const BallLanes& rest = opened.asset.surface().leaf_balls[l / kLeafLanes];
    // The margin for roundings is up to 600 units in the last place of a coordinate of about 4.
    CHECK(std::abs(covered.leaves[l].radius - rest.radius[l % kLeafLanes]) < 2e-4);
  }
}

TEST_CASE("the balls are the same bits on every target, whatever the layout of the matrices") {
  const Posable p(5);
  const OpenedAsset opened(p.tiny.parts);
  std::mt19937 random(6);
  for (const PoseKind kind : kPoseKinds) {
    const std::vector<Matrix> matrices = random_pose(kBones, kind, 2, random);
    const std::vector<float> weights = random_morph_weights(3, random);
    std::vector<float> columns;
    for (const Matrix& m : matrices) {
      for (std::size_t column = 0; column < 4; ++column) {
        columns.insert(columns.end(), {m[column], m[4 + column], m[8 + column]});
      }
    }
    const Covered expected = cover(opened.asset, view(matrices), weights, Target::kScalar);
    REQUIRE(expected.status == Status::kOk);
    for (const Target target : supported_targets()) {
      CHECK(same_bits(cover(opened.asset, view(matrices), weights, target).leaves, expected.leaves));
      const BoneMatrices by_columns{columns.data(), kBones, MatrixLayout::kColumnMajor3x4, 48};
      CHECK(same_bits(cover(opened.asset, by_columns, weights, target).leaves, expected.leaves));
    }
  }
}

TEST_CASE("a sphere's cover contains its leaves' balls") {
  const Posable p(7);
  const OpenedAsset opened(p.tiny.parts);
  std::mt19937 random(8);
  for (const PoseKind kind : kPoseKinds) {
    check_contains_leaves(opened.asset, cover(opened.asset, view(random_pose(kBones, kind, 2, random)), {}));
  }
}

TEST_CASE("CoverJob refuses what it cannot run on, and writes nothing then") {
  const Posable p(1);
  const OpenedAsset opened(p.tiny.parts), without(random_asset(3, 1).parts);
  TinyAsset still = random_asset(3, 1);
  add_surface(still, nullptr, 4);
  const OpenedAsset unmoved(still.parts);
  const std::vector<Matrix> matrices = random_matrices(kBones, 1);
  std::vector<Sphere> leaves(opened.asset.leaf_count(), Sphere{7, 7, 7, 7}), spheres(11, Sphere{7, 7, 7, 7});
  const auto run = [&](auto change) {
    CoverJob job;
    job.asset = &opened.asset;
    job.bones = view(matrices);
    job.leaves = {leaves.data(), leaves.size()};
    job.spheres = {spheres.data(), spheres.size()};
    change(job);
    return job.run();
  };
  CHECK(run([](CoverJob& job) { job.asset = nullptr; }) == Status::kNullArgument);
  CHECK(run([](CoverJob& job) { job.leaves.data = nullptr; }) == Status::kNullArgument);
  CHECK(run([](CoverJob& job) { job.spheres.data = nullptr; }) == Status::kNullArgument);
  CHECK(run([&](CoverJob& job) { job.asset = &without.asset; }) == Status::kNotInAsset);
  CHECK(run([&](CoverJob& job) { job.asset = &unmoved.asset; }) == Status::kNotInAsset);
  CHECK(run([](CoverJob& job) { job.bones.count -= 1; }) == Status::kTooFewBones);
  CHECK(run([](CoverJob& job) { job.leaves.size -= 1; }) == Status::kTooFewSpheres);
  CHECK(run([](CoverJob& job) { job.spheres.size -= 1; }) == Status::kTooFewSpheres);
  CHECK(run([](CoverJob& job) { job.spheres = job.leaves; }) == Status::kSharedMemory);
  CHECK(run([](CoverJob& job) { job.target = static_cast<Target>(99); }) == Status::kUnsupportedTarget);
  CHECK(std::all_of(leaves.begin(), leaves.end(), [](const Sphere& leaf) { return leaf.radius == 7; }));
  CHECK(run([](CoverJob& job) { job.spheres = {}; }) == Status::kOk);
  CHECK(leaves[0].radius != 7);
  CHECK(spheres[0].radius == 7);
}

}  // namespace spherechain::test

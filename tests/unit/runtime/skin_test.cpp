// SPDX-License-Identifier: MIT
#include "spherechain/skin.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "jobs.h"
#include "random_poses.h"
#include "tiny_surface.h"

namespace spherechain::test {
namespace {

constexpr std::size_t kBones = 6;

BoneMatrices view(const std::vector<Matrix>& matrices) { return {matrices[0].data(), matrices.size()}; }

// Four triangles a leaf: 12 vertices, in 16 slots.
TinyAsset posable(TinySkin& skin) {
  TinyAsset tiny = random_asset(6, 1);
  skin = add_bones(tiny, kBones, 2);
  add_surface(tiny, &skin, 4);
  return tiny;
}

}  // namespace

TEST_CASE("the surface's vertices are where double precision skinning puts them, to rounding") {
  TinySkin tiny_skin;
  const TinyAsset tiny = posable(tiny_skin);
  const OpenedAsset opened(tiny.parts);
  REQUIRE(opened.status == Status::kOk);
  std::mt19937 random(3);
  for (const PoseKind kind : kPoseKinds) {
    const std::vector<Matrix> matrices = random_pose(kBones, kind, 1, random);
    for (const auto& weights : {std::vector<float>(), random_morph_weights(3, random)}) {
      const std::vector<float> expected = skinned(tiny, tiny_skin, matrices, weights);
      const SkinnedSurface result = skin(opened.asset, view(matrices), weights);
      REQUIRE(result.status == Status::kOk);
      REQUIRE(result.positions.size() == expected.size());
      for (std::size_t i = 0; i < expected.size(); ++i) {
        CHECK(std::abs(result.positions[i] - expected[i]) < 1e-5);  // of coordinates of some units
      }
    }
  }
}

TEST_CASE("skinned positions are the same bits on every target, layout of matrices and stride") {
  TinySkin tiny_skin;
  const TinyAsset tiny = posable(tiny_skin);
  const OpenedAsset opened(tiny.parts);
  std::mt19937 random(4);
  const std::vector<Matrix> matrices = random_pose(kBones, PoseKind::kSheared, 1, random);
  const std::vector<float> weights = random_morph_weights(3, random);
  std::vector<float> columns;
  for (const Matrix& m : matrices) {
    for (std::size_t column = 0; column < 4; ++column) {
      columns.insert(columns.end(), {m[column], m[4 + column], m[8 + column], column == 3 ? 1.0F : 0.0F});
    }
  }
  const std::vector<float> expected = skin(opened.asset, view(matrices), weights, Target::kScalar).positions;
  for (const Target target : supported_targets()) {
    CHECK(same_bits(skin(opened.asset, view(matrices), weights, target).positions, expected));
    const BoneMatrices by_columns{columns.data(), kBones, MatrixLayout::kColumnMajor4x4, 64};
    CHECK(same_bits(skin(opened.asset, by_columns, weights, target).positions, expected));
  }
  const std::vector<float> apart = skin(opened.asset, view(matrices), weights, Target::kBest, 20).positions;
  for (std::size_t v = 0; v < tiny.parts.vertex_count; ++v) {
    CHECK(apart[5 * v + 2] == expected[3 * v + 2]);
  }
}

TEST_CASE("SkinJob refuses what it cannot run on, and writes nothing then") {
  TinySkin tiny_skin;
  const TinyAsset tiny = posable(tiny_skin);
  const OpenedAsset opened(tiny.parts), without(random_asset(3, 1).parts);
  const std::vector<Matrix> matrices = random_matrices(kBones, 1);
  std::vector<float> positions(3 * tiny.parts.vertex_count, 7);
  const auto run = [&](auto change) {
    SkinJob job;
    job.asset = &opened.asset;
    job.bones = view(matrices);
    job.positions = positions.data();
    job.vertex_count = tiny.parts.vertex_count;
    change(job);
    return job.run();
  };
  CHECK(run([](SkinJob& job) { job.asset = nullptr; }) == Status::kNullArgument);
  CHECK(run([](SkinJob& job) { job.positions = nullptr; }) == Status::kNullArgument);
  CHECK(run([&](SkinJob& job) { job.asset = &without.asset; }) == Status::kNotInAsset);
  CHECK(run([](SkinJob& job) { job.bones.count -= 1; }) == Status::kTooFewBones);
  CHECK(run([](SkinJob& job) { job.vertex_count -= 1; }) == Status::kTooFewVertices);
  CHECK(run([](SkinJob& job) { job.stride = 8; }) == Status::kBadStride);
  CHECK(run([](SkinJob& job) { job.target = static_cast<Target>(99); }) == Status::kUnsupportedTarget);
  CHECK(run([&](SkinJob& job) { job.bones.data = positions.data(); }) == Status::kSharedMemory);
  CHECK(std::all_of(positions.begin(), positions.end(), [](float p) { return p == 7; }));
  CHECK(run([](SkinJob&) {}) == Status::kOk);
}

}  // namespace spherechain::test

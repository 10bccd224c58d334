// SPDX-License-Identifier: MIT
// What the narrow phase takes leaves to be in, from bones alone, against where their vertices are.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact_pose.h"
#include "jobs.h"
#include "random_poses.h"
#include "tiny_surface.h"

namespace spherechain::test {
namespace {

constexpr std::size_t kBones = 6, kMorphs = 3;

struct Posable {
  // Without outlines all leaves are bounded, else those of spheres that are not kept apart.
  Posable(unsigned seed, bool has_boxes, bool has_outlines) : tiny(random_asset(11, seed)) {
    skin = add_bones(tiny, kBones, seed + 1);
    add_surface(tiny, &skin, 3);
    if (!has_boxes) {
      tiny.parts.surface.leaf_boxes.clear();
    }
    if (!has_outlines) {
      tiny.parts.surface.outlines.clear();
    }
  }
  TinyAsset tiny;
  TinySkin skin;
};

BoneMatrices view(const std::vector<Matrix>& matrices) { return {matrices[0].data(), matrices.size()}; }

using Position = std::array<double, 3>;

// The same in single precision by matrices blended first, which SkinJob does not do, without a fused operation.
Position blended(const Posable& p, std::uint32_t v, const std::vector<Matrix>& matrices,
                 const std::vector<float>& morph_weights) {
  float rest[4] = {0, 0, 0, 1};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    rest[axis] = p.tiny.rest[3 * v + axis];
    for (const auto& [target, delta] : p.skin.morphs[v]) {
      rest[axis] += morph_weights.empty() ? 0 : morph_weights[target] * delta[axis];
    }
  }
  Position out{};
  for (std::size_t row = 0; row < 3; ++row) {
    float sum = 0;
    for (std::size_t column = 0; column < 4; ++column) {
      float figure = 0;
      for (const auto& [bone, weight] : p.skin.weights[v]) {
        figure += static_cast<float>(weight) * matrices[bone][4 * row + column];
      }
      sum += figure * rest[column];
    }
    out[row] = sum;
  }
  return out;
}

// Some move all bones alike, and some of those stretch along the axes alone: then vertices are on a box's very sides.
std::vector<Matrix> pose_of(int number, std::mt19937& random) {
  const PoseKind kind = kPoseKinds[static_cast<std::size_t>(number) % std::size(kPoseKinds)];
  const float size = number % 7 == 0 ? 1000.0F : 2.0F;
  if (number % 5 < 3) {
    return random_pose(kBones, kind, size, random);
  }
  Matrix one = random_pose(1, kind, size, random)[0];
  if (number % 5 == 4) {
    one[1] = one[2] = one[4] = one[6] = one[8] = one[9] = 0;
  }
  return std::vector<Matrix>(kBones, one);
}

struct Bounds {
  std::vector<std::uint64_t> words;
  ContactScene scene;

  Bounds(const Asset& asset, const BoneMatrices& bones, const std::vector<float>& morph_weights, Target target)
      : words(TriangleContactContext::words_needed(asset)),
        scene(scene_of({&asset, nullptr, 0, 12, bones, {morph_weights.data(), morph_weights.size()}},
                       {words.data(), words.size()})) {
    bound_leaves(target, scene);
  }
  bool contain(std::size_t leaf, const Position& p) const {
    double squared = 0;
    bool inside = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      inside =
          inside && p[axis] >= double{scene.leaves.low[axis][leaf]} && p[axis] <= double{scene.leaves.high[axis][leaf]};
      squared += std::pow(p[axis] - double{scene.ball_columns[axis][leaf]}, 2);
    }
    return inside && std::sqrt(squared) <= double{scene.ball_columns[3][leaf]};
  }
};

// How far along a direction the points of a sphere's outline reach, and what is beyond them at most.
double reach(const ContactScene& scene, std::size_t sphere, const Position& direction) {
  const Outline& outline = scene.surface->outlines[sphere];
  const float* points = scene.outlines + std::size_t{3} * outline.first_point;
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < outline.point_count; ++i) {
    double along = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      along += direction[axis] * double{points[axis * outline.point_count + i]};
    }
    most = std::max(most, along);
  }
  return most + std::hypot(direction[0], direction[1], direction[2]) * double{scene.outline_margins[sphere]};
}

// Is the vertex in the sphere's box, and along each direction within reach?
bool outline_holds(const ContactScene& scene, std::size_t sphere, const Position& p,
                   const std::vector<Position>& directions) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(p[axis] >= double{scene.spheres.low[axis][sphere]} && p[axis] <= double{scene.spheres.high[axis][sphere]})) {
      return false;
    }
  }
  return std::all_of(directions.begin(), directions.end(), [&](const Position& d) {
    return d[0] * p[0] + d[1] * p[1] + d[2] * p[2] <= reach(scene, sphere, d);
  });
}

std::vector<TrianglePair> contacts(TriangleContactJob job) {
  std::vector<std::uint64_t> words(TriangleContactContext::words_needed(*job.asset));
  TriangleContactContext context{{words.data(), words.size()}};
  job.context = &context;
  std::vector<TrianglePair> pairs(10000);
  job.pairs = {pairs.data(), pairs.size()};
  REQUIRE(job.run() == Status::kOk);
  pairs.resize(job.pair_count);
  return pairs;
}

}  // namespace

TEST_CASE("in every pose every vertex, however it is skinned, is in its leaf's box and ball, on every target") {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const Posable p(seed, seed % 4 != 0, false);
    const OpenedAsset opened(p.tiny.parts);
    REQUIRE(opened.status == Status::kOk);
    const Surface& surface = opened.asset.surface();
    std::mt19937 random(seed);
    for (int pose = 0; pose < 200; ++pose) {
      const std::vector<Matrix> matrices = pose_of(pose, random);
      const std::vector<float> weights = pose % 4 == 0 ? std::vector<float>() : random_morph_weights(kMorphs, random);
      const SkinnedSurface skinned = skin(opened.asset, view(matrices), weights);
      REQUIRE(skinned.status == Status::kOk);
      for (const Target target : supported_targets()) {
        const Bounds bounds(opened.asset, view(matrices), weights, target);
        for (std::size_t l = 0; l < opened.asset.leaf_count(); ++l) {
          const Leaf& leaf = surface.leaves[l];
          for (std::size_t i = 0; i < leaf.vertex_count; ++i) {
            const std::uint32_t v = surface.source_vertices[surface.leaf_vertices[leaf.first_vertex + i]];
            const float* s = &skinned.positions[std::size_t{3} * v];
            CAPTURE(seed);
            CAPTURE(pose);
            CAPTURE(l);
            CAPTURE(to_string(target));
            REQUIRE(bounds.contain(l, moved(p.tiny, p.skin, v, matrices, weights)));
            REQUIRE(bounds.contain(l, blended(p, v, matrices, weights)));
            REQUIRE(bounds.contain(l, {double{s[0]}, double{s[1]}, double{s[2]}}));
          }
        }
      }
    }
  }
}

TEST_CASE("in every pose every vertex is near the hull of its sphere's outline, on every target") {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const Posable p(seed, true, true);
    const OpenedAsset opened(p.tiny.parts);
    REQUIRE(opened.status == Status::kOk);
    const Surface& surface = opened.asset.surface();
    std::mt19937 random(seed);
    std::normal_distribution<double> any;
    for (int pose = 0; pose < 200; ++pose) {
      const std::vector<Matrix> matrices = pose_of(pose, random);
      const SkinnedSurface skinned = skin(opened.asset, view(matrices), {});
      REQUIRE(skinned.status == Status::kOk);
      std::vector<Position> directions;
      for (int i = 0; i < 6; ++i) {
        directions.push_back({any(random), any(random), any(random)});
      }
      for (const Target target : supported_targets()) {
        const Bounds bounds(opened.asset, view(matrices), {}, target);
        REQUIRE(bounds.scene.has_outlines);
        for (const Leaf& leaf : surface.leaves) {
          for (std::size_t i = 0; i < leaf.vertex_count; ++i) {
            const std::uint32_t v = surface.source_vertices[surface.leaf_vertices[leaf.first_vertex + i]];
            const float* s = &skinned.positions[std::size_t{3} * v];
            CAPTURE(seed);
            CAPTURE(pose);
            CAPTURE(leaf.sphere);
            CAPTURE(to_string(target));
            const Position exact = moved(p.tiny, p.skin, v, matrices, {});
            REQUIRE(outline_holds(bounds.scene, leaf.sphere, exact, directions));
            REQUIRE(outline_holds(bounds.scene, leaf.sphere, blended(p, v, matrices, {}), directions));
            REQUIRE(outline_holds(bounds.scene, leaf.sphere, {double{s[0]}, double{s[1]}, double{s[2]}}, directions));
          }
        }
      }
    }
  }
}

TEST_CASE("where all bones move alike an outline of all vertices is as near as rounding is") {
  const Posable p(3, true, true);
  const OpenedAsset opened(p.tiny.parts);
  std::mt19937 random(4);
  const std::vector<Matrix> matrices(kBones, random_pose(1, PoseKind::kRigid, 1, random)[0]);
  for (const Target target : supported_targets()) {
    const Bounds bounds(opened.asset, view(matrices), {}, target);
    for (std::size_t s = 0; s < opened.asset.spheres().size; s += 2) {
      // The margin for roundings is up to 2,000 units in the last place of coordinates of about 8.
      CHECK(bounds.scene.outline_margins[s] < 2e-3F);
    }
  }
}

TEST_CASE(
    "where all bones move alike and rigidly a leaf's box is within its turned box at rest, its ball that at rest") {
  const Posable p(3, true, false);
  const OpenedAsset opened(p.tiny.parts);
  std::mt19937 random(4);
  const std::vector<Matrix> matrices(kBones, random_pose(1, PoseKind::kRigid, 1, random)[0]);
  const Bounds bounds(opened.asset, view(matrices), {}, Target::kScalar);
  for (std::size_t l = 0; l < opened.asset.leaf_count(); ++l) {
    const BoxLanes& rest = opened.asset.surface().leaf_boxes[l / kLeafLanes];
    const std::size_t lane = l % kLeafLanes;
    const Matrix& m = matrices[0];
    // The margin for roundings is up to 1,200 units in the last place of a coordinate of about 4.
    CHECK(std::abs(bounds.scene.ball_columns[3][l] - rest.radius[lane]) < 4e-4);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float half = std::abs(m[4 * axis]) * rest.half_x[lane] + std::abs(m[4 * axis + 1]) * rest.half_y[lane] +
                         std::abs(m[4 * axis + 2]) * rest.half_z[lane];
      const float extent = bounds.scene.leaves.high[axis][l] - bounds.scene.leaves.low[axis][l];
      CHECK(std::abs(extent / 2 - std::min(half, rest.radius[lane])) < 4e-4);
    }
  }
}

TEST_CASE("contacts are the same from vertices, from bones and from both, in poses of every kind, on every target") {
  std::size_t total = 0;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const Posable p(seed, seed % 2 == 0, seed > 2);
    const OpenedAsset opened(p.tiny.parts);
    std::mt19937 random(seed);
    for (int pose = 0; pose < 60; ++pose) {
      const std::vector<Matrix> matrices = pose_of(pose, random);
      // Outlines are for poses without morphs.
      const std::vector<float> weights = pose % 2 == 0 ? std::vector<float>() : random_morph_weights(kMorphs, random);
      const SkinnedSurface skinned = skin(opened.asset, view(matrices), weights);
      for (const ContactScope scope : {ContactScope::kApart, ContactScope::kNeighbours, ContactScope::kAll}) {
        TriangleContactJob job;
        job.asset = &opened.asset;
        job.scope = scope;
        job.positions = skinned.positions.data();
        job.vertex_count = skinned.positions.size() / 3;
        const std::vector<TrianglePair> expected = contacts(job);
        total += expected.size();
        job.bones = view(matrices);
        job.morph_weights = {weights.data(), weights.size()};
        for (const Target target : supported_targets()) {
          job.target = target;
          CHECK(contacts(job) == expected);
          TriangleContactJob from_bones = job;
          from_bones.positions = nullptr;
          CHECK(contacts(from_bones) == expected);
        }
      }
    }
  }
  CHECK(total > 1000);
}

TEST_CASE("contacts are the same from vertices and from bones at any size that floats have, on every target") {
  std::size_t total = 0;
  for (unsigned seed = 1; seed <= 2; ++seed) {
    const Posable p(seed, true, true);
    const OpenedAsset opened(p.tiny.parts);
    std::mt19937 random(seed);
    for (const float size : {1e-35F, 1e-25F, 1e-18F, 1e-9F, 1e9F, 1e17F, 1e19F, 1e25F, 1e33F}) {
      for (int pose = 0; pose < 6; ++pose) {
        std::vector<Matrix> matrices = pose_of(pose, random);
        for (Matrix& matrix : matrices) {
          for (float& element : matrix) {
            element *= size;
          }
        }
        const SkinnedSurface skinned = skin(opened.asset, view(matrices), {});
        TriangleContactJob job;
        job.asset = &opened.asset;
        job.positions = skinned.positions.data();
        job.vertex_count = skinned.positions.size() / 3;
        job.target = Target::kScalar;
        const std::vector<TrianglePair> expected = contacts(job);
        total += expected.size();
        job.positions = nullptr;
        job.bones = view(matrices);
        for (const Target target : supported_targets()) {
          CAPTURE(size);
          CAPTURE(pose);
          CAPTURE(to_string(target));
          job.target = target;
          CHECK(contacts(job) == expected);
        }
      }
    }
  }
  CHECK(total > 1000);
}

}  // namespace spherechain::test

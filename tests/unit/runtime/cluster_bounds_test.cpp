// SPDX-License-Identifier: MIT
// The boxes, balls and hulls that bound clusters in a pose, from bones alone, against where their vertices are.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "jobs.h"
#include "palette.h"
#include "random_poses.h"
#include "runtime/src/clusters/set_up.h"
#include "runtime/src/contacts/collector.h"
#include "tiny_skin.h"

namespace spherechain::test {
namespace {

constexpr std::size_t kBoundBones = 6, kBoundMorphs = 3;

struct BoundSource {
  explicit BoundSource(unsigned seed) : tiny(seed % 2 == 0 ? random_band(11, seed) : random_asset(11, seed)) {
    skin = add_bones(tiny, kBoundBones, seed + 1);
    add_skin(tiny, &skin, 3);
  }
  TinyAsset tiny;
  TinySkin skin;
};

using Position = std::array<double, 3>;

// In single precision by matrices blended first, which the runtime does not do, without a fused operation.
Position blended(const BoundSource& p, std::uint32_t v, const std::vector<Matrix>& matrices,
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
    out[row] = double{sum};
  }
  return out;
}

// Some move all bones alike, and some of those stretch along the axes alone: then vertices are on a box's very sides.
std::vector<Matrix> bounds_pose(int number, std::mt19937& random) {
  const PoseKind kind = kPoseKinds[static_cast<std::size_t>(number) % std::size(kPoseKinds)];
  const float size = number % 7 == 0 ? 1000.0F : 2.0F;
  if (number % 5 < 3) return random_pose(kBoundBones, kind, size, random);
  Matrix one = random_pose(1, kind, size, random)[0];
  if (number % 5 == 4) one[1] = one[2] = one[4] = one[6] = one[8] = one[9] = 0;
  return std::vector<Matrix>(kBoundBones, one);
}

struct Bounds {
  std::vector<std::uint64_t> words;
  WordMemory memory;
  PosedClusters clusters;
  std::vector<float> bones;  // a box each
  Bounds3 body;

  Bounds(const OpenedAsset& opened, const PreparedSkin& table, const Pose& pose, Target target, bool has_hulls)
      : words(skin_scratch_words(&opened.asset)),
        memory(words.data()),
        clusters(posed_clusters_of(opened.view(), table.surface, pose, nullptr, memory)) {
    REQUIRE((clusters.has_hulls || !has_hulls));
    clusters.has_hulls =
        has_hulls;  // without them all clusters are bounded, else those of spheres that are near others
    ContactCollector collector(table.surface, PartTable(), {{}, {}, {}, true});  // spheres only
    find_candidates(target, {clusters, clusters, true}, collector);  // leaves what it bounded in their memory
    bones.resize(6 * opened.view().bone_count());
    body = bound_bones(opened.view(), table.surface, pose, bones.data());
  }
  // Is the vertex in the body's box, and in the one around those of its cluster's bones?
  bool bones_hold(std::size_t cluster, const Position& p) const {
    const Cluster& of = clusters.surface->clusters[cluster];
    bool inside = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      float low = HUGE_VALF, high = -HUGE_VALF;
      for (std::size_t k = 0; k < of.bone_count; ++k) {
        const float* const box = &bones[6 * std::size_t{clusters.surface->cluster_bones[of.first_bone + k]}];
        low = std::min(low, box[axis]);
        high = std::max(high, box[3 + axis]);
      }
      inside = inside && p[axis] >= double{low} && p[axis] <= double{high} && p[axis] >= double{body.low[axis]} &&
               p[axis] <= double{body.high[axis]};
    }
    return inside;
  }
  bool contain(std::size_t cluster, const Position& p) const {
    double squared = 0;
    bool inside = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      inside = inside && p[axis] >= double{clusters.clusters.low[axis][cluster]} &&
               p[axis] <= double{clusters.clusters.high[axis][cluster]};
      squared += std::pow(p[axis] - double{clusters.ball_columns[axis][cluster]}, 2);
    }
    return inside && std::sqrt(squared) <= double{clusters.ball_columns[3][cluster]};
  }
  // Is the vertex in the sphere's box, and along each direction within reach of the hull's points and margin?
  bool hull_holds(std::size_t sphere, const Position& p, const std::vector<Position>& directions) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto &low = clusters.spheres.low[axis], &high = clusters.spheres.high[axis];
      if (!(p[axis] >= double{low[sphere]} && p[axis] <= double{high[sphere]})) return false;
    }
    return std::all_of(directions.begin(), directions.end(),
                       [&](const Position& d) { return d[0] * p[0] + d[1] * p[1] + d[2] * p[2] <= reach(sphere, d); });
  }

 private:
  double reach(std::size_t sphere, const Position& direction) const {
    const Hull& hull = clusters.surface->hulls[sphere];
    const float* points = clusters.hulls + std::size_t{3} * hull.first_point;
    double most = -HUGE_VAL;
    for (std::size_t i = 0; i < hull.point_count; ++i) {
      double along = 0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        along += direction[axis] * double{points[axis * hull.point_count + i]};
      }
      most = std::max(most, along);
    }
    return most + std::hypot(direction[0], direction[1], direction[2]) * double{clusters.hull_margins[sphere]};
  }
};

// Calls `check(bounds, cluster number, position)` for each vertex, however it is skinned, in many poses, on every
// target.
template <typename Check>
void check_poses(bool has_hulls, const Check& check) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const BoundSource p(seed);
    const OpenedAsset opened(p.tiny.parts);
    REQUIRE_MESSAGE(opened.status == SC_OK, opened.message);
    const PreparedSkin table(opened.asset);
    const Surface& surface = table.surface;
    std::mt19937 random(seed);
    for (int number = 0; number < 100; ++number) {
      const std::vector<Matrix> matrices = bounds_pose(number, random);
      // Hulls are for poses without morphs.
      const std::vector<float> weights =
          has_hulls || number % 4 == 0 ? std::vector<float>() : random_morph_weights(kBoundMorphs, random);
      const Pose pose = pose_of(matrices, weights);
      const std::vector<float> vertices = skin(opened.asset, pose);
      for (const Target target : supported_targets()) {
        const Bounds bounds(opened, table, pose, target, has_hulls);
        for (std::size_t c = 0; c < surface.clusters.size; ++c) {
          const Cluster& cluster = surface.clusters[c];
          for (std::size_t i = 0; i < cluster.vertex_count; ++i) {
            const std::uint32_t v = surface.source_vertices[surface.cluster_vertices[cluster.first_vertex + i]];
            const float* s = &vertices[std::size_t{3} * v];
            CAPTURE(seed);
            CAPTURE(number);
            CAPTURE(c);
            INFO(std::string(sc_target_name(target)));
            check(bounds, c, moved(p.tiny, p.skin, v, matrices, weights));
            check(bounds, c, blended(p, v, matrices, weights));
            check(bounds, c, Position{double{s[0]}, double{s[1]}, double{s[2]}});
          }
        }
      }
    }
  }
}

}  // namespace

TEST_CASE(
    "in every pose every vertex, however it is skinned, is in its cluster's box and ball, and in its bones' boxes") {
  check_poses(false, [](const Bounds& bounds, std::size_t c, const Position& p) {
    REQUIRE(bounds.contain(c, p));
    REQUIRE(bounds.bones_hold(c, p));
  });
}

TEST_CASE("in every pose every vertex is near the hull of its sphere") {
  std::vector<Position> directions;
  std::mt19937 random(1);
  for (int i = 0; i < 6; ++i) {
    const auto any = [&] { return double{uniform(random, -1, 1)}; };
    directions.push_back({any(), any(), any()});
  }
  check_poses(true, [&](const Bounds& bounds, std::size_t c, const Position& p) {
    REQUIRE(bounds.hull_holds(bounds.clusters.surface->clusters[c].sphere, p, directions));
  });
}

TEST_CASE("where all bones move alike and rigidly, bounds are as near as rounding is") {
  const BoundSource p(3);
  const OpenedAsset opened(p.tiny.parts);
  const PreparedSkin table(opened.asset);
  std::mt19937 random(4);
  const std::vector<Matrix> matrices(kBoundBones, random_pose(1, PoseKind::kRigid, 1, random)[0]);
  const Pose pose = pose_of(matrices);
  for (const Target target : supported_targets()) {
    const Bounds with_hulls(opened, table, pose, target, true);
    for (std::size_t s = 0; s < opened.view().spheres().size; s += 2) {
      // The margin for roundings is up to 2,000 units in the last place of coordinates of about 8.
      CHECK(with_hulls.clusters.hull_margins[s] < 2e-3F);
    }
    const Bounds bounds(opened, table, pose, target, false);
    const Matrix& m = matrices[0];
    for (std::size_t c = 0; c < table.surface.clusters.size; ++c) {
      const BoxLanes& rest = table.surface.boxes[c / kClusterLanes];
      const std::size_t lane = c % kClusterLanes;
      // The margin for roundings is up to 1,200 units in the last place of a coordinate of about 4.
      CHECK(std::abs(bounds.clusters.ball_columns[3][c] - rest.radius[lane]) < 4e-4F);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const float half = std::abs(m[4 * axis]) * rest.half_x[lane] + std::abs(m[4 * axis + 1]) * rest.half_y[lane] +
                           std::abs(m[4 * axis + 2]) * rest.half_z[lane];
        const float extent = bounds.clusters.clusters.high[axis][c] - bounds.clusters.clusters.low[axis][c];
        CHECK(std::abs(extent / 2 - std::min(half, rest.radius[lane])) < 4e-4F);
      }
    }
  }
}

}  // namespace spherechain::test

// SPDX-License-Identifier: GPL-3.0-or-later
// Leaves of baked characters: what they are made of, and that their balls hold in any pose.
#include "baker/clusters/clusters.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <random>
#include <ranges>
#include <set>

#include "baked_human.h"
#include "baked_person.h"
#include "baker/mesh/error.h"
#include "baker/motion/clip.h"
#include "baker/motion/poses.h"
#include "baker/truth/intersections.h"
#include "jobs.h"
#include "random_poses.h"
#include "test_characters.h"

using namespace spherechain::baker;
using spherechain::test::PoseKind;
using Matrices = std::vector<spherechain::test::Matrix>;

namespace {

// Linear blend skinning in double precision from the character's own weights: nothing of the clusters.
std::vector<Vec3> skinned(const Bake& bake, const Matrices& matrices, const std::vector<float>& morph_weights) {
  const Character& character = bake.character;
  std::vector<Vec3> rest = character.source_positions;
  for (std::size_t m = 0; m < character.rig.morphs.size() && !morph_weights.empty(); ++m) {
    const Morph& morph = character.rig.morphs[m];
    for (std::size_t i = 0; i < morph.vertices.size(); ++i) {
      rest[morph.vertices[i]] += double{morph_weights[m]} * morph.deltas[i];
    }
  }
  std::vector<Eigen::Matrix<double, 3, 4>> bones;
  for (const auto& m : matrices) {
    bones.emplace_back(Eigen::Map<const Eigen::Matrix<float, 3, 4, Eigen::RowMajor>>(m.data()).cast<double>());
  }
  const std::vector<VertexWeights>& weights = character.rig.bones.empty() ? bake.rig_weights : character.rig.weights;
  std::vector<Vec3> out;
  for (std::size_t v = 0; v < rest.size(); ++v) {
    Vec3 sum = Vec3::Zero();
    if (weights[v].weight[0] <= 0) sum = bones.back() * rest[v].homogeneous();
    for (std::size_t k = 0; k < kMaxInfluences && weights[v].weight[k] > 0; ++k) {
      sum += weights[v].weight[k] * (bones[weights[v].joint[k]] * rest[v].homogeneous());
    }
    out.push_back(sum);
  }
  return out;
}

struct Checked {
  std::size_t poses = 0;
  double skinning = 0;  // the largest distance of the runtime's vertex from the double precision one, of the height
};

void check_pose(const Bake& bake, const OpenAsset& asset, const Matrices& matrices,
                const std::vector<float>& morph_weights, Checked& out) {
  spherechain::Pose pose;
  pose.bones = matrices[0].data();
  pose.bone_count = matrices.size();
  pose.bone_layout = SC_ROWS_3X4;
  pose.morph_weights = morph_weights.empty() ? nullptr : morph_weights.data();
  pose.morph_weight_count = morph_weights.size();
  const std::vector<float> positions = spherechain::test::skin(asset, pose);
  const std::vector<Vec3> mesh = skinned(bake, matrices, morph_weights);
  ++out.poses;
  for (const SurfaceVertex& vertex : bake.clusters.vertices) {
    const float* p = &positions[std::size_t{3} * vertex.source];
    out.skinning = std::max(out.skinning, (mesh[vertex.source] - Vec3(p[0], p[1], p[2])).norm());
  }
}

// In the poses of a motion, as a game would pass them.
Checked check_frames(const Bake& bake, const std::vector<Deformation>& frames) {
  const spherechain::baker::OpenAsset asset = open_asset_of(bake);
  Checked out;
  for (const Deformation& frame : frames) {
    Matrices matrices;
    for (std::size_t b = 0; b < asset->bone_count(); ++b) {
      const Affine bone = b < frame.bones.size() ? frame.bones[b] : Affine::Identity();
      spherechain::test::Matrix& matrix = matrices.emplace_back();
      Eigen::Map<Eigen::Matrix<float, 3, 4, Eigen::RowMajor>>(matrix.data()) = bone.matrix().cast<float>();
    }
    check_pose(bake, asset, matrices, {frame.morphs.begin(), frame.morphs.end()}, out);
  }
  return out;
}

void report(const std::string& what, const Checked& checked, double height) {
  MESSAGE(fmt::format("{}: {} poses; skinning off by {:.1e} of the height", what, checked.poses,
                      checked.skinning / height));
  CHECK(checked.skinning < 1e-5 * height);
}

// The sizes of the clusters of each piece of the skin in each sphere; of none that hold triangles of two pieces.
std::map<std::pair<std::uint32_t, Index>, std::vector<std::size_t>> sizes_by_piece(const Bake& bake) {
  const std::vector<Index> piece_of = connected_components(bake.character.skin).of_triangle;
  std::map<std::pair<std::uint32_t, Index>, std::vector<std::size_t>> out;
  for (const Cluster& cluster : bake.clusters.clusters) {
    const Index piece = piece_of[cluster.triangles.front()];
    CHECK(std::ranges::all_of(cluster.triangles, [&](Index t) { return piece_of[t] == piece; }));
    out[{cluster.sphere, piece}].push_back(cluster.triangles.size());
  }
  return out;
}

}  // namespace

TEST_CASE("every triangle of the skin is in one cluster of its own sphere and piece, of even size and at most 64") {
  for (const Bake* bake : {&baked_human(), &baked_person()}) {
    std::vector<int> clusters_of_triangle(bake->character.skin.triangles.size(), 0);
    for (const Cluster& cluster : bake->clusters.clusters) {
      for (const Index t : cluster.triangles) {
        ++clusters_of_triangle[t];
        CHECK(bake->binding.sphere_of_triangle[t] == cluster.sphere);
      }
    }
    CHECK(std::ranges::all_of(clusters_of_triangle, [](int count) { return count == 1; }));
    for (const auto& [sphere, of_sphere] : sizes_by_piece(*bake)) {
      const std::size_t all = std::accumulate(of_sphere.begin(), of_sphere.end(), std::size_t{0});
      CHECK(of_sphere.size() == (all + 63) / 64);
      CHECK(std::ranges::max(of_sphere) - std::ranges::min(of_sphere) <= 1);
    }
  }
}

TEST_CASE("a surface vertex stands for the source vertices at its place that move as it does") {
  const Bake& bake = morphing_person();
  const Character& character = bake.character;
  const auto moves = [&](Index v) {
    std::map<Index, float> weights;
    for (std::size_t k = 0; k < kMaxInfluences; ++k) {
      const double weight = character.rig.weights[v].weight[k];
      if (weight > 0) weights[character.rig.weights[v].joint[k]] += static_cast<float>(weight);
    }
    std::vector<float> deltas;
    for (const Morph& morph : character.rig.morphs) {
      const auto found = std::ranges::lower_bound(morph.vertices, v);
      const bool is_there = found != morph.vertices.end() && *found == v;
      for (Eigen::Index i = 0; i < 3; ++i) {
        deltas.push_back(
            is_there ? static_cast<float>(morph.deltas[static_cast<std::size_t>(found - morph.vertices.begin())][i])
                     : 0.0F);
      }
    }
    return std::pair(weights, deltas);
  };
  std::size_t split = 0;
  std::set<Index> used;
  for (const Index t : character.skin_source_triangle) {
    for (const Index v : character.source_triangles[t]) used.insert(v);
  }
  std::map<Index, std::vector<Index>> of_place;
  for (const Index v : used) of_place[character.skin_of_source[v]].push_back(v);
  for (const auto& [place, vertices] : of_place) {
    const auto first_moves = moves(vertices[0]);
    for (const Index v : vertices) {
      const SurfaceVertex& surface = bake.clusters.vertices[bake.clusters.vertex_of_source[v]];
      const auto own_moves = v == vertices[0] ? first_moves : moves(v);
      CHECK(surface.source <= v);
      CHECK((surface.source == v || moves(surface.source) == own_moves));
      const Index first = bake.clusters.vertex_of_source[vertices[0]];
      CHECK(bake.clusters.vertices[first].weld == surface.weld);
      CHECK((first == bake.clusters.vertex_of_source[v]) == (first_moves == own_moves));
      split += first != bake.clusters.vertex_of_source[v] ? 1 : 0;
    }
  }
  CHECK(split > 0);  // the morphs pull seams apart
}

TEST_CASE("weights and mid weights add up to 1 within two roundings: the balls' margin for them rests on it") {
  constexpr double kTwoRoundings = 2.0 / (1 << 24);
  for (const Bake* bake : {&baked_human(), &morphing_person()}) {
    const auto is_off = [&](const auto& parts) {
      double sum = -1;
      for (const auto& part : parts) sum += part.weight;
      return std::abs(sum) > kTwoRoundings;
    };
    CHECK(std::ranges::none_of(bake->clusters.vertices, is_off, &SurfaceVertex::influences));
    CHECK(std::ranges::none_of(bake->clusters.clusters, is_off, &Cluster::bones));
  }
}

TEST_CASE("at rest a cluster's box contains its vertices to the last bit, and they reach the box's sides") {
  for (const Bake* bake : {&baked_human(), &morphing_person()}) {
    const spherechain::baker::OpenAsset asset = open_asset_of(*bake);
    const spherechain::Surface& surface = asset.surface();
    for (std::size_t l = 0; l < surface.clusters.size; ++l) {
      const spherechain::Cluster& cluster = surface.clusters[l];
      const spherechain::BoxLanes& boxes = surface.boxes[l / spherechain::kClusterLanes];
      const std::size_t lane = l % spherechain::kClusterLanes;
      const Vec3 center(boxes.x[lane], boxes.y[lane], boxes.z[lane]);
      const Vec3 half(boxes.half_x[lane], boxes.half_y[lane], boxes.half_z[lane]);
      Vec3 reach = Vec3::Zero();
      double farthest = 0;
      for (std::size_t slot = 0; slot < cluster.vertex_count; ++slot) {
        const float* p = surface.slot_positions.data + 3 * cluster.first_slot + slot;
        const std::size_t slots = slot_count(cluster);
        const Vec3 vertex(p[0], p[slots], p[2 * slots]), from_center = vertex - center;
        reach = reach.cwiseMax(from_center.cwiseAbs());
        farthest = std::max(farthest, from_center.norm());
      }
      REQUIRE((reach.array() <= half.array()).all());
      REQUIRE((half.array() <= reach.array() * (1 + 1e-6)).all());
      REQUIRE(farthest <= boxes.radius[lane]);
      REQUIRE(boxes.radius[lane] <= farthest * (1 + 1e-6));
    }
  }
}

TEST_CASE("a morph target's ball contains the deltas of a cluster's vertices to the last bit, and is no larger") {
  const Bake& bake = morphing_person();
  std::size_t balls = 0;
  for (const Cluster& cluster : bake.clusters.clusters) {
    for (const ClusterMorph& morph : cluster.morphs) {
      double farthest = 0;
      for (const Index v : cluster.vertices) {
        const std::vector<MorphDelta>& deltas = bake.clusters.vertices[v].morphs;
        const auto own = std::ranges::find(deltas, morph.target, &MorphDelta::target);
        const Vec3 delta = own == deltas.end() ? Vec3::Zero() : Vec3(own->delta);
        farthest = std::max(farthest, (delta - morph.ball.center).norm());
      }
      REQUIRE(farthest <= morph.ball.radius);
      REQUIRE(morph.ball.radius <= farthest * (1 + 1e-6));
      ++balls;
    }
  }
  CHECK(balls > 10);
}

TEST_CASE("without morphs a sphere's vertices are near its hull, as near as the asset says" *
          doctest::test_suite("many bakes")) {
  std::mt19937 random(5);
  std::normal_distribution<double> any;
  for (const Bake* bake : {&baked_human(), &morphing_person()}) {
    const spherechain::baker::OpenAsset asset = open_asset_of(*bake);
    const spherechain::Surface& surface = asset.surface();
    REQUIRE(surface.hulls.size == asset->spheres().size);
    for (int pose = 0; pose < 6; ++pose) {
      const Matrices matrices = spherechain::test::random_pose(
          asset->bone_count(), spherechain::test::kPoseKinds[static_cast<std::size_t>(pose)], 1, random);
      const std::vector<Vec3> vertices = skinned(*bake, matrices, {});
      std::vector<Eigen::Matrix<double, 3, 4>> bones;
      for (const auto& m : matrices) {
        bones.emplace_back(Eigen::Map<const Eigen::Matrix<float, 3, 4, Eigen::RowMajor>>(m.data()).cast<double>());
      }
      std::vector<std::vector<Vec3>> of_sphere(surface.hulls.size);
      for (const spherechain::Cluster& cluster : surface.clusters) {
        for (std::uint32_t i = 0; i < cluster.vertex_count; ++i) {
          of_sphere[cluster.sphere].push_back(
              vertices[surface.source_vertices[surface.cluster_vertices[cluster.first_vertex + i]]]);
        }
      }
      for (std::size_t s = 0; s < surface.hulls.size; ++s) {
        const spherechain::Hull& hull = surface.hulls[s];
        const Eigen::Vector4d center(hull.center.x, hull.center.y, hull.center.z, 1);
        std::vector<Vec3> points(hull.point_count, Vec3::Zero());
        Vec3 strays = Vec3::Zero();
        const Eigen::Matrix<double, 3, 4>& first = bones[surface.hull_bones[hull.first_bone].bone];
        for (std::size_t b = 0; b < hull.bone_count; ++b) {
          const spherechain::HullBone& bone = surface.hull_bones[hull.first_bone + b];
          for (std::size_t k = 0; k < hull.point_count; ++k) {
            const float* rest = surface.hull_points.data + std::size_t{3} * hull.first_point + k;
            const Eigen::Vector4d point(rest[0], rest[hull.point_count], rest[2 * hull.point_count], 1);
            points[k] +=
                surface.hull_weights[hull.first_weight + b * hull.point_count + k] * (bones[bone.bone] * point);
          }
          const Eigen::Matrix<double, 3, 4> apart = bones[bone.bone] - first;
          strays += apart.leftCols<3>().cwiseAbs() * Vec3(bone.x, bone.y, bone.z) +
                    (apart * center).cwiseAbs() * static_cast<double>(bone.w);
        }
        const double stretch = first.leftCols<3>().jacobiSvd().singularValues()[0];
        // Weights are off 1 by 2^-24 at most, twice, and coordinates are below 16.
        const double margin = strays.norm() + stretch * static_cast<double>(hull.slack) + 4e-6;
        for (int i = 0; i < 8; ++i) {
          const Vec3 direction = Vec3(any(random), any(random), any(random)).normalized();
          const auto along = [&](const Vec3& p) { return direction.dot(p); };
          const double farthest = std::ranges::max(of_sphere[s] | std::views::transform(along));
          const double reach = std::ranges::max(points | std::views::transform(along));
          CAPTURE(s);
          REQUIRE(farthest <= reach + margin);
        }
      }
    }
  }
}

TEST_CASE("a hull is as near as it is meant to be, or has as many points as there may be") {
  const spherechain::baker::OpenAsset asset = open_asset_of(baked_human());
  const auto& hulls = asset.surface().hulls;
  double radii = 0;
  for (const spherechain::Hull& hull : hulls) radii += hull.radius;
  for (const spherechain::Hull& hull : hulls) {
    CHECK(hull.point_count <= 96);
    if (hull.point_count < 96) CHECK(hull.slack <= 0.0301 * radii / static_cast<double>(hulls.size));
  }
}

TEST_CASE("the corners of the asset's triangles are the source's") {
  for (const Bake* bake : {&baked_human(), &morphing_person()}) {
    const spherechain::baker::OpenAsset asset = open_asset_of(*bake);
    const spherechain::Surface& surface = asset.surface();
    for (const spherechain::Cluster& cluster : surface.clusters) {
      for (std::uint32_t t = cluster.first_triangle; t < cluster.first_triangle + cluster.triangle_count; ++t) {
        const Triangle& corners = bake->character.source_triangles[surface.triangles[t]];
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t vertex = surface.cluster_vertices[cluster.first_vertex + surface.corners[3 * t + k]];
          REQUIRE(bake->clusters.vertex_of_source[corners[k]] == vertex);
          REQUIRE(bake->character.source_positions[surface.source_vertices[vertex]] ==
                  bake->character.source_positions[corners[k]]);
        }
      }
    }
  }
}

TEST_CASE("contacts at rest are CGAL's intersections of the rest pose between triangles without a common corner") {
  std::size_t all = 0;
  for (const Bake* bake : {&baked_human(), &baked_person()}) {
    const spherechain::baker::OpenAsset asset = open_asset_of(*bake);
    const TruthSurface surface = surface_of(asset, bake->character);
    std::vector<spherechain::Pair> expected;
    for (const auto& pair : find_intersections(surface, pack(bake->character.source_positions)).pairs) {
      bool share_corner = false;
      for (const std::uint32_t a : bake->character.source_triangles[pair.a]) {
        for (const std::uint32_t b : bake->character.source_triangles[pair.b]) {
          share_corner |= bake->character.source_positions[a] == bake->character.source_positions[b];
        }
      }
      if (!share_corner) expected.push_back(pair);
    }
    const auto& found = asset.surface().rest_contacts;
    CHECK(std::vector<spherechain::Pair>(found.begin(), found.end()) == expected);
    all += expected.size();
  }
  CHECK(all > 0);
}

TEST_CASE("clusters.triangles is how many triangles a cluster has at most" * doctest::test_suite("many bakes")) {
  const Bake small = rebake(baked_person(), make_settings("balanced", R"({"clusters": {"triangles": 16}})", "test"));
  CHECK(small.clusters.clusters.size() > 2 * baked_person().clusters.clusters.size());
  for (const Cluster& cluster : small.clusters.clusters) CHECK(cluster.triangles.size() <= 16);
  CHECK(to_json(small.settings).find(R"("triangles":16)") != std::string::npos);
  CHECK(open_asset_of(small).surface().clusters.size == small.clusters.clusters.size());
}

TEST_CASE("clusters.branching is how many children a node of too many triangles is divided into" *
          doctest::test_suite("many bakes")) {
  for (const std::size_t branching : {2, 8}) {
    CAPTURE(branching);
    const Bake bake =
        rebake(baked_person(),
               make_settings("balanced", fmt::format(R"({{"clusters": {{"branching": {}}}}})", branching), "test"));
    std::set<std::size_t> counts;
    for (const auto& [piece, of_sphere] : sizes_by_piece(bake)) {
      const auto [least, most] = std::minmax_element(of_sphere.begin(), of_sphere.end());
      CHECK(*most <= 64);
      CHECK(*most - *least <= 1);
      std::size_t children = of_sphere.size();
      if (children > 1) CHECK(*most * branching > 64);  // one level less would not do
      while (children % branching == 0) children /= branching;
      CHECK(children == 1);
      counts.insert(of_sphere.size());
    }
    CHECK(counts.size() > 1);
    CHECK(open_asset_of(bake).surface().clusters.size == bake.clusters.clusters.size());
  }
  CHECK_THROWS_WITH_AS(make_settings("balanced", R"({"clusters": {"branching": 3}})", "test"),
                       "test: clusters: setting 'branching' is not 0, 2, 4 or 8", Error);
}

TEST_CASE("over poses and clips the runtime puts every vertex where skinning does" *
          doctest::test_suite("many bakes")) {
  std::vector<Deformation> frames;
  for (const char* name : {"animation_arms.json", "animation_legs.json", "deep_squat.json"}) {
    const PoseMotion poses =
        read_pose_motion(std::string(SPHERECHAIN_SAMPLES) + "/poses/" + name, baked_human().joints);
    const BezierMotion motion(baked_human().joints, baked_human().regions.frame, poses);
    for (int i = 0; i < 2; ++i) frames.push_back(motion.at(0.5 + i / 2.0));
  }
  const Checked human = check_frames(baked_human(), frames);
  report("human, poses", human, baked_human().regions.frame.height);

  frames.clear();
  for (const Clip& clip : baked_person().character.rig.clips) {
    const ClipMotion motion(baked_person().character.rig, {&clip});
    for (int i = 0; i < 3; ++i) frames.push_back(motion.at(i / 2.0));
  }
  const Checked person = check_frames(baked_person(), frames);
  report("person, clips", person, baked_person().regions.frame.height);
}

TEST_CASE("characters of SPHERECHAIN_TEST_DATA: over clips the runtime puts every vertex where skinning does") {
  for_each_test_character([](const Bake& bake) {
    std::vector<Deformation> frames;
    for (const Clip& clip : bake.character.rig.clips) {
      const ClipMotion motion(bake.character.rig, {&clip});
      for (int i = 0; i < 25; ++i) frames.push_back(motion.at(i / 24.0));
    }
    if (frames.empty()) return;
    const Checked checked = check_frames(bake, frames);
    report(bake.character.file + ", clips", checked, bake.regions.frame.height);
  });
}

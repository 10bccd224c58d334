// SPDX-License-Identifier: GPL-3.0-or-later
// The tables of refit by moments, against the skinned mesh; all in double precision.
#include "baker/bind/bind_moments.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <set>

#include "baked_human.h"
#include "baked_person.h"
#include "random_poses.h"

using namespace spherechain::baker;
using spherechain::test::PoseKind;
using Matrix34 = Eigen::Matrix<double, 3, 4>;
using BoneMatrices = std::vector<Matrix34>;

namespace {

// A sphere's centre, and its root mean square distance as a multiple of that at rest.
struct Moved {
  Vec3 center;
  double spread;
};

std::vector<Moved> moved_by_tables(const spherechain::MomentTables& tables, const BoneMatrices& pose) {
  const Eigen::Vector4d origin(double{tables.origin.x}, double{tables.origin.y}, double{tables.origin.z}, 1);
  const Vec3 reference = pose[tables.reference] * origin;
  BoneMatrices relative = pose;
  for (std::size_t b = 0; b < pose.size(); ++b) relative[b].col(3) = pose[b] * origin - reference;
  std::vector<Moved> out(tables.spheres.size);
  std::size_t first_pair = 0, sphere = 0, first_bone = 0, pair = 0;
  for (const spherechain::MomentBatch& batch : tables.batches) {
    for (std::uint32_t left = batch.sphere_count; left > 0; --left, ++sphere) {
      Moved& moved = out[tables.spheres[sphere]];
      moved.center = reference;
      for (std::size_t k = 0; k < tables.bone_counts[sphere]; ++k) {
        const spherechain::CenterTerm& u = tables.centers[first_bone + k];
        moved.center += relative[tables.bones[first_bone + k]] *
                        Eigen::Vector4d(double{u.x}, double{u.y}, double{u.z}, double{u.w});
      }
      double sum = 0;
      for (std::size_t k = 0; k < tables.bone_counts[sphere]; ++k) {
        for (std::size_t l = k; l < tables.bone_counts[sphere]; ++l, ++pair) {
          const spherechain::BonePair& of = tables.pairs[first_pair + tables.pair_places[pair]];
          REQUIRE(of.a == tables.bones[first_bone + k]);
          REQUIRE(of.b == tables.bones[first_bone + l]);
          const Eigen::Matrix4d gram = relative[of.a].transpose() * relative[of.b];
          for (Eigen::Index i = 0; i < 16; ++i) sum += double{tables.moments[pair].values[i]} * gram(i / 4, i % 4);
        }
      }
      moved.spread = std::sqrt(sum);
      first_bone += tables.bone_counts[sphere];
    }
    first_pair += batch.pair_count;
  }
  return out;
}

// The same from the pivots of the skinned mesh. Vertices that no bone moves hang on the last.
std::vector<Moved> moved_by_skin(const Bake& bake, const BoneMatrices& pose) {
  const Character& character = bake.character;
  const std::vector<VertexWeights>& weights = character.rig.bones.empty() ? bake.rig_weights : character.rig.weights;
  std::vector<Vec3> vertices;
  for (std::size_t v = 0; v < weights.size(); ++v) {
    const Eigen::Vector4d rest = character.source_positions[v].homogeneous();
    Vec3 sum = Vec3::Zero();
    if (weights[v].weight[0] <= 0) sum = pose.back() * rest;
    for (std::size_t k = 0; k < kMaxInfluences && weights[v].weight[k] > 0; ++k) {
      sum += weights[v].weight[k] * (pose[weights[v].joint[k]] * rest);
    }
    vertices.push_back(sum);
  }
  std::vector<Moved> out;
  for (const BoundSphere& sphere : bake.binding.spheres) {
    std::vector<Vec3> centroids;
    Moved moved{Vec3::Zero(), 0};
    for (const BoundPivot& pivot : sphere.pivots) {
      const Triangle& corners = character.source_triangles[character.skin_source_triangle[pivot.triangle]];
      centroids.emplace_back((vertices[corners[0]] + vertices[corners[1]] + vertices[corners[2]]) / 3);
      moved.center += pivot.weight * centroids.back();
    }
    for (const Vec3& centroid : centroids) moved.spread += (centroid - moved.center).squaredNorm();
    moved.spread = std::sqrt(moved.spread / static_cast<double>(centroids.size())) / sphere.spread;
    out.push_back(moved);
  }
  return out;
}

BoneMatrices random_pose(std::size_t bones, PoseKind kind, double size, std::mt19937& random) {
  BoneMatrices out;
  for (const auto& m : spherechain::test::random_pose(bones, kind, static_cast<float>(size), random)) {
    out.emplace_back(Eigen::Map<const Eigen::Matrix<float, 3, 4, Eigen::RowMajor>>(m.data()).cast<double>());
  }
  return out;
}

BoneMatrices rest_pose(std::size_t bones) { return BoneMatrices(bones, Matrix34::Identity()); }

// Error from rounding the tables to single precision, as a share of the height; of a spread, of the radius.
struct Difference {
  double center = 0, radius = 0;
};

Difference difference(const Bake& bake, const std::vector<Moved>& a, const std::vector<Moved>& b) {
  REQUIRE(a.size() == bake.binding.spheres.size());
  REQUIRE(b.size() == a.size());
  Difference out;
  for (std::size_t i = 0; i < a.size(); ++i) {
    REQUIRE(std::isfinite(a[i].spread));
    out.center = std::max(out.center, (a[i].center - b[i].center).norm() / bake.regions.frame.height);
    out.radius = std::max(out.radius, bake.binding.spheres[i].rest.radius * std::abs(a[i].spread - b[i].spread) /
                                          bake.regions.frame.height);
  }
  return out;
}

Binding bound(const Bake& bake) {
  return *bind_spheres(bake.character, bake.regions, bake.spheres, bake.settings.bind);
}

// Equal to the last bit.
void check_same(const MomentBinding& a, const MomentBinding& b) {
  CHECK(a.origin == b.origin);
  CHECK(a.reference == b.reference);
  REQUIRE(a.batches.size() == b.batches.size());
  for (std::size_t i = 0; i < a.batches.size(); ++i) {
    CHECK(a.batches[i].pairs == b.batches[i].pairs);
    REQUIRE(a.batches[i].spheres.size() == b.batches[i].spheres.size());
    for (std::size_t k = 0; k < a.batches[i].spheres.size(); ++k) {
      const SphereMoments &x = a.batches[i].spheres[k], &y = b.batches[i].spheres[k];
      CHECK(x.sphere == y.sphere);
      CHECK(x.bones == y.bones);
      CHECK(x.centers == y.centers);
      CHECK(x.moments == y.moments);
      CHECK(x.places == y.places);
    }
  }
}

}  // namespace

TEST_CASE("in any pose of the bones the moments give the skinned pivots' centre and root mean square distance" *
          doctest::test_suite("many bakes")) {
  for (const Bake* bake : {&baked_human(), &baked_person()}) {
    const spherechain::baker::OpenAsset asset = open_asset_of(*bake);
    REQUIRE(asset->refit_rule() == spherechain::RefitRule::kMoments);
    std::mt19937 random(7);
    for (const PoseKind kind : spherechain::test::kPoseKinds) {
      Difference worst;
      for (int i = 0; i < 2; ++i) {
        const BoneMatrices pose = random_pose(asset->bone_count(), kind, bake->regions.frame.height, random);
        const Difference now =
            difference(*bake, moved_by_tables(asset->moment_tables(), pose), moved_by_skin(*bake, pose));
        worst = {std::max(worst.center, now.center), std::max(worst.radius, now.radius)};
      }
      MESSAGE(fmt::format("{}, poses of kind {}: centres off by {:.1e} of the height, radii by {:.1e}",
                          bake->character.file, static_cast<int>(kind), worst.center, worst.radius));
      CHECK(worst.center < 1e-6);
      CHECK(worst.radius < 1e-6);
    }
  }
}

TEST_CASE("where vertices hang on no bone, moments have them on the rest bone" * doctest::test_suite("many bakes")) {
  Bake bake = morphing_person();
  bake.character.rig.morphs.clear();
  bake = rebake(bake, bake.settings);
  const spherechain::baker::OpenAsset asset = open_asset_of(bake);
  REQUIRE(asset->refit_rule() == spherechain::RefitRule::kMoments);
  REQUIRE(asset->bone(asset->bone_count() - 1).is_rest);
  const spherechain::MomentTables& tables = asset->moment_tables();
  CHECK(std::ranges::count(tables.bones, asset->bone_count() - 1) > 0);
  std::mt19937 random(8);
  const BoneMatrices pose = random_pose(asset->bone_count(), PoseKind::kSheared, bake.regions.frame.height, random);
  const Difference off = difference(bake, moved_by_tables(tables, pose), moved_by_skin(bake, pose));
  CHECK(off.center < 1e-6);
  CHECK(off.radius < 1e-6);
}

TEST_CASE("at rest the moments give the baked spheres, whose spread is the root mean square") {
  for (const Bake* bake : {&baked_human(), &baked_person()}) {
    const spherechain::baker::OpenAsset asset = open_asset_of(*bake);
    const std::vector<Moved> moved = moved_by_tables(asset->moment_tables(), rest_pose(asset->bone_count()));
    for (std::size_t i = 0; i < moved.size(); ++i) {
      const BoundSphere& sphere = bake->binding.spheres[i];
      CHECK((moved[i].center - sphere.rest.center).norm() < 1e-6 * bake->regions.frame.height);
      CHECK(std::abs(moved[i].spread - 1) < 1e-5);
      double sum = 0;
      for (const BoundPivot& pivot : sphere.pivots) {
        sum += (triangle_centroid(bake->character.skin, pivot.triangle) - sphere.rest.center).squaredNorm();
      }
      CHECK(sphere.spread == doctest::Approx(std::sqrt(sum / static_cast<double>(sphere.pivots.size()))).epsilon(1e-9));
    }
  }
}

TEST_CASE("batches have every sphere once, few pairs, none twice, and spheres of equal bones side by side") {
  for (const Bake* bake : {&baked_human(), &baked_person()}) {
    std::vector<int> times(bake->binding.spheres.size(), 0);
    std::set<std::vector<Index>> finished;
    std::set<BonePair> distinct;
    std::size_t in_batches = 0, of_spheres = 0;
    for (const MomentBatch& batch : bake->moments.batches) {
      CHECK(batch.pairs.size() <= 96);
      CHECK(std::ranges::is_sorted(batch.pairs));
      CHECK(std::ranges::adjacent_find(batch.pairs) == batch.pairs.end());
      in_batches += batch.pairs.size();
      distinct.insert(batch.pairs.begin(), batch.pairs.end());
      std::set<BonePair> used;
      for (std::size_t i = 0; i < batch.spheres.size(); ++i) {
        const SphereMoments& sphere = batch.spheres[i];
        ++times[sphere.sphere];
        of_spheres += sphere.places.size();
        for (const std::uint8_t place : sphere.places) used.insert(batch.pairs[place]);
        const bool goes_on = i > 0 && batch.spheres[i - 1].bones == sphere.bones;
        CHECK((goes_on || finished.insert(sphere.bones).second));
      }
      CHECK(used.size() == batch.pairs.size());
    }
    CHECK(std::ranges::all_of(times, [](int count) { return count == 1; }));
    MESSAGE(fmt::format("{}: {} spheres, {} pairs of theirs; {} batches of {} pairs, {} distinct", bake->character.file,
                        times.size(), of_spheres, bake->moments.batches.size(), in_batches, distinct.size()));
    CHECK(in_batches < 1.5 * static_cast<double>(distinct.size()));
  }
}

TEST_CASE("the order of vertices and triangles changes no bit of the moments") {
  const Bake& bake = baked_human();
  Character character = bake.character;
  std::vector<VertexWeights> weights = bake.rig_weights;
  std::vector<Index> vertex(character.source_positions.size()), triangle(character.source_triangles.size());
  std::iota(vertex.begin(), vertex.end(), Index{0});
  std::iota(triangle.begin(), triangle.end(), Index{0});
  std::mt19937 random(3);
  std::shuffle(vertex.begin(), vertex.end(), random);
  std::shuffle(triangle.begin(), triangle.end(), random);
  for (std::size_t v = 0; v < vertex.size(); ++v) {
    character.source_positions[vertex[v]] = bake.character.source_positions[v];
    weights[vertex[v]] = bake.rig_weights[v];
  }
  for (std::size_t t = 0; t < triangle.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      character.source_triangles[triangle[t]][k] = vertex[bake.character.source_triangles[t][k]];
    }
  }
  for (Index& source : character.skin_source_triangle) source = triangle[source];
  Binding binding = bound(bake);
  check_same(bind_moments(character, bake.bones, weights, binding), bake.moments);
}

TEST_CASE("moments of a character turned, moved and in other units refit it likewise") {
  const Bake& bake = baked_human();
  const double height = bake.regions.frame.height;
  for (const double scale : {0.01, 1.0, 39.37}) {
    const Eigen::Affine3d change = Eigen::Translation3d(scale * height * Vec3(3, -2, 1)) *
                                   Eigen::AngleAxisd(2.1, Vec3(1, 2, 3).normalized()) * Eigen::Scaling(scale);
    Bake other = bake;
    for (Vec3& p : other.character.source_positions) p = change * p;
    for (Vec3& p : other.character.skin.positions) p = change * p;
    for (BoundSphere& sphere : other.binding.spheres) sphere.spread *= scale;
    other.moments = bind_moments(other.character, other.bones, other.rig_weights, other.binding);
    CHECK(other.moments.reference == bake.moments.reference);
    REQUIRE(other.moments.batches.size() == bake.moments.batches.size());
    for (std::size_t b = 0; b < bake.moments.batches.size(); ++b) {
      const MomentBatch &before = bake.moments.batches[b], &after = other.moments.batches[b];
      CHECK(after.pairs == before.pairs);
      REQUIRE(after.spheres.size() == before.spheres.size());
      for (std::size_t i = 0; i < before.spheres.size(); ++i) {
        const SphereMoments &x = before.spheres[i], &y = after.spheres[i];
        REQUIRE(y.sphere == x.sphere);
        REQUIRE(y.bones == x.bones);
        CHECK(y.places == x.places);
        // Parts of pivots relative to the origin, which moves along: only turned and scaled.
        Eigen::Matrix4d turned = Eigen::Matrix4d::Identity();
        turned.topLeftCorner<3, 3>() = change.linear();
        const double unit = scale * scale, reach = 1 / (bake.binding.spheres[x.sphere].spread / height);
        for (std::size_t k = 0; k < x.centers.size(); ++k) {
          // The box about the pivots is another one when turned, so the origin is: a shift of x, y, z by w.
          const Vec3 shift = change * bake.moments.origin - other.moments.origin;
          const Eigen::Vector4d u = turned * x.centers[k];
          CHECK((y.centers[k].head<3>() - u.head<3>() - u.w() * shift).norm() < 1e-9 * scale * height);
          CHECK(y.centers[k].w() == doctest::Approx(u.w()).epsilon(1e-9));
        }
        for (std::size_t k = 0; k < x.moments.size(); ++k) {
          Eigen::Matrix4d shifted = Eigen::Matrix4d::Identity();
          shifted.topRightCorner<3, 1>() = change * bake.moments.origin - other.moments.origin;
          const Eigen::Matrix4d expected =
              shifted * turned * x.moments[k] * turned.transpose() * shifted.transpose() / unit;
          CHECK((y.moments[k] - expected).norm() < 1e-9 * reach * reach);
        }
      }
    }
  }
}

TEST_CASE("every source that bones move has moments, but with the paper's rule" * doctest::test_suite("many bakes")) {
  const spherechain::baker::OpenAsset paper = open_asset_of(paper_baked_human()),
                                      morphing = open_asset_of(morphing_person());
  CHECK(paper->refit_rule() == spherechain::RefitRule::kPaper);
  CHECK(paper->moment_tables().spheres.size == 0);
  CHECK(morphing->refit_rule() == spherechain::RefitRule::kMoments);
  CHECK(morphing->moment_tables().spheres.size == morphing->spheres().size);
  // Nothing moves it.
  CHECK(bind_moments(baked_human().character, {}, {}, baked_human().binding).batches.empty());
}

TEST_CASE("a sphere hangs on at most 22 bones: with more, on those that move it most, and at rest it is the same") {
  const Bake& bake = baked_human();
  BoneBinding bones = bake.bones;
  bones.bones.resize(40, {"spare", Affine::Identity()});
  for (const std::size_t count : {22U, 30U}) {
    std::vector<VertexWeights> weights(bake.rig_weights.size());
    std::size_t next = 0;
    // Every vertex of a sphere's pivots on eight bones, one after another, so that a sphere is on all.
    for (const BoundPivot& pivot : bake.binding.spheres[5].pivots) {
      for (const Index v : bake.character.source_triangles[bake.character.skin_source_triangle[pivot.triangle]]) {
        for (std::size_t k = 0; k < kMaxInfluences; ++k, ++next) {
          weights[v].joint[k] = static_cast<Index>(next % count);
          weights[v].weight[k] = 1.0 / kMaxInfluences;
        }
      }
    }
    for (VertexWeights& weight : weights) {
      if (weight.weight[0] <= 0) weight.weight[0] = 1;  // the first bone alone
    }
    const MomentBinding moments = bind_moments(bake.character, bones, weights, bake.binding);
    // More pairs than a batch: one of its own, and all other spheres' where they add none.
    CHECK(std::ranges::any_of(moments.batches, [](const MomentBatch& batch) { return batch.pairs.size() == 253; }));
    std::size_t spheres = 0;
    for (const MomentBatch& batch : moments.batches) {
      spheres += batch.spheres.size();
      for (const SphereMoments& sphere : batch.spheres) {
        Eigen::Vector4d center = Eigen::Vector4d::Zero();
        for (const Eigen::Vector4d& share : sphere.centers) center += share;
        const BoundSphere& wanted = bake.binding.spheres[sphere.sphere];
        CHECK(sphere.bones.size() <= kMaxMomentBones);
        CHECK((center.head<3>() + moments.origin - wanted.rest.center).norm() < 1e-6 * bake.regions.frame.height);
      }
    }
    CHECK(spheres == bake.binding.spheres.size());
  }
}

TEST_CASE("the same input gives the same bytes, and moments that start at a multiple of 64") {
  const Bake& bake = baked_human();
  CHECK(rebake(bake, bake.settings).asset == bake.asset);
  sc_asset asset;
  REQUIRE(sc_asset_open(&asset, SC_ABI_VERSION, bake.asset.data(), bake.asset.size(), nullptr, 0) == SC_OK);
  const spherechain::MomentTables& tables = spherechain::view_of(asset).moment_tables();
  const auto place = [&](const auto& span) {
    return reinterpret_cast<const std::uint8_t*>(span.data) - bake.asset.data();
  };
  CHECK(place(tables.moments) % 64 == 0);
  CHECK(place(tables.centers) % 16 == 0);
}

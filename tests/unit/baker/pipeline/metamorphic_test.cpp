// SPDX-License-Identifier: GPL-3.0-or-later
// Units, up axis, place, orientation and the order of vertices and triangles change nothing but what they must.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>
#include <numeric>
#include <random>

#include "baked_human.h"
#include "human.h"

using namespace spherechain::baker;

namespace {

struct Change {
  std::string name;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Vec3 translation = Vec3::Zero();
  double scale = 1;
  unsigned shuffle_seed = 0;  // 0: order as it was
};

struct Variant {
  Character character;
  Regions regions;
  Spheres spheres;
  std::vector<Index> triangle_place;  // source triangle before -> after
};

Variant make_variant(const SourceMesh& original, const Change& change) {
  SourceMesh mesh = original;
  std::vector<Index> vertex_place(mesh.positions.size());
  Variant variant;
  variant.triangle_place.resize(mesh.triangles.size());
  std::iota(vertex_place.begin(), vertex_place.end(), Index{0});
  std::iota(variant.triangle_place.begin(), variant.triangle_place.end(), Index{0});
  if (change.shuffle_seed != 0) {
    std::mt19937 random(change.shuffle_seed);
    std::shuffle(vertex_place.begin(), vertex_place.end(), random);
    std::shuffle(variant.triangle_place.begin(), variant.triangle_place.end(), random);
  }
  for (std::size_t v = 0; v < vertex_place.size(); ++v) {
    mesh.positions[vertex_place[v]] = change.scale * (change.rotation * original.positions[v]) + change.translation;
  }
  for (std::size_t t = 0; t < original.triangles.size(); ++t) {
    const Triangle& v = original.triangles[t];
    mesh.triangles[variant.triangle_place[t]] = {vertex_place[v[1]], vertex_place[v[2]], vertex_place[v[0]]};
  }
  variant.character = build_character(mesh, change.name);
  variant.regions = *segment_by_shape(variant.character, variant.character.largest_piece, {});
  variant.spheres = *fit_spheres(variant.regions, {});
  return variant;
}

// Share of the body's area with the same label before and after.
double equal_area(const Bake& before, const Variant& after) {
  std::vector<int> label(before.character.source_triangles.size(), -1);
  for (std::size_t t = 0; t < after.regions.body.mesh.triangles.size(); ++t) {
    label[after.regions.body.source_triangle[t]] = after.regions.of_triangle[t];
  }
  double equal = 0, all = 0;
  for (std::size_t t = 0; t < before.regions.body.mesh.triangles.size(); ++t) {
    const double area = triangle_area(before.regions.body.mesh, t);
    all += area;
    if (label[after.triangle_place[before.regions.body.source_triangle[t]]] == before.regions.of_triangle[t])
      equal += area;
  }
  return equal / all;
}

}  // namespace

TEST_CASE("units, up axis, rigid motion and order change neither labels nor spheres") {
  const Bake& bake = baked_human();
  const SourceMesh original = read_with_assimp(kHumanFile);
  const auto turn = [](double x, double y, double z, double angle) {
    return Eigen::AngleAxisd(angle, Vec3(x, y, z).normalized()).toRotationMatrix();
  };
  const std::vector<Change> changes{
      {.name = "centimetres", .scale = 100},
      {.name = "inches", .scale = 39.37},
      {.name = "z up", .rotation = turn(1, 0, 0, std::numbers::pi / 2)},
      {.name = "upside down", .rotation = turn(0, 0, 1, std::numbers::pi)},
      {.name = "turned and moved", .rotation = turn(1, 2, 3, 2.1), .translation = Vec3(3, -2, 5)},
      {.name = "turned otherwise, decimetres",
       .rotation = turn(-2, 0.3, 1, 0.7),
       .translation = Vec3(-40, 7, 1),
       .scale = 10},
      {.name = "shuffled", .shuffle_seed = 1},
      {.name = "shuffled, z up, centimetres",
       .rotation = turn(1, 0, 0, std::numbers::pi / 2),
       .scale = 100,
       .shuffle_seed = 2},
  };
  for (const Change& change : changes) {
    CAPTURE(change.name);
    const Variant variant = make_variant(original, change);
    const double equal = equal_area(bake, variant);
    CHECK(equal >= 0.995);
    REQUIRE(variant.spheres.spheres.size() == bake.spheres.spheres.size());
    double worst = 0;
    for (std::size_t i = 0; i < variant.spheres.spheres.size(); ++i) {
      const Vec3 back =
          change.rotation.transpose() * (variant.spheres.spheres[i].ball.center - change.translation) / change.scale;
      worst = std::max(worst, (back - bake.spheres.spheres[i].ball.center).norm());
      CHECK(variant.spheres.spheres[i].region == bake.spheres.spheres[i].region);
    }
    CHECK(worst <= 0.005 * bake.regions.frame.height);
    MESSAGE(fmt::format("{}: {:.3f} % of the area has the same label, centres within {:.3f} % of the height",
                        change.name, 100 * equal, 100 * worst / bake.regions.frame.height));
  }
}

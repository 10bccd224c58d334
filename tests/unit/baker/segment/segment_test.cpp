// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/segment/by_shape.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "baked_human.h"
#include "baker/mesh/error.h"
#include "broken_body.h"
#include "closed_shapes.h"

using namespace spherechain::baker;

namespace {

double area_of(const Bake& bake, std::uint8_t region) {
  double area = 0;
  for (std::size_t t = 0; t < bake.regions.body.mesh.triangles.size(); ++t) {
    if (bake.regions.of_triangle[t] == region) area += triangle_area(bake.regions.body.mesh, t);
  }
  return area;
}

std::string segmentation_error(const SourceMesh& source, const SegmentSettings& settings = {}) {
  const Character character = build_character(source, "test.obj");
  const Attempt<Regions> regions = segment_by_shape(character, character.largest_piece, settings);
  return regions ? "no error" : regions.reason().what;
}

}  // namespace

TEST_CASE("every triangle has one of the five regions, and so has every triangle of the eyes") {
  const Bake& bake = baked_human();
  REQUIRE(bake.regions.of_triangle.size() == bake.regions.body.mesh.triangles.size());
  CHECK(*std::max_element(bake.regions.of_triangle.begin(), bake.regions.of_triangle.end()) == kTorso);
  REQUIRE(bake.regions.of_skin.size() == bake.character.skin.triangles.size());
  // The eyes are in the head, and the head is the torso's.
  for (std::size_t t = 0; t < bake.regions.of_skin.size(); ++t) {
    const Index corner = bake.character.source_triangles[bake.character.skin_source_triangle[t]][0];
    if (bake.regions.body.of_source[corner] == kNoIndex) REQUIRE(bake.regions.of_skin[t] == kTorso);
  }
}

TEST_CASE("a body of four times as many triangles has the same regions" * doctest::test_suite("many bakes")) {
  BrokenBody fine = intact_body();  // its skeleton is that of a simplified copy
  subdivide(fine, 1);
  const Character character = build_character(fine.source, "test.obj");
  const Attempt<Regions> regions = segment_by_shape(character, character.largest_piece, {});
  REQUIRE(regions);
  double same = 0;
  for (std::size_t t = 0; t < character.largest_piece.mesh.triangles.size(); ++t) {
    const Index intact = fine.of_intact[character.largest_piece.source_triangle[t]];
    if (regions->of_triangle[t] == human().regions.of_triangle[intact])
      same += triangle_area(character.largest_piece.mesh, t);
  }
  CHECK(same > 0.99 * surface_area(character.largest_piece.mesh));
}

TEST_CASE("neighbours are the two triangles of an edge; open are the edges that not two use, one each way") {
  // Few vertices, so that edges have one to many triangles, and triangles may have an edge of one vertex.
  std::mt19937 random(3);
  for (int round = 0; round < 50; ++round) {
    Mesh mesh;
    mesh.positions.resize(7);
    for (int t = 0; t < 9; ++t) {
      const auto corner = [&] { return static_cast<Index>(random() % mesh.positions.size()); };
      mesh.triangles.push_back({corner(), corner(), corner()});
    }
    std::map<std::pair<Index, Index>, std::vector<std::pair<Index, std::size_t>>> uses;
    std::map<std::pair<Index, Index>, int> directed;
    for (Index t = 0; t < mesh.triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const Index a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3];
        if (a == b) continue;
        uses[std::minmax(a, b)].emplace_back(t, k);
        ++directed[{a, b}];
      }
    }
    std::vector<std::array<Index, 3>> neighbours(mesh.triangles.size(), {kNoIndex, kNoIndex, kNoIndex});
    for (const auto& [edge, of] : uses) {
      if (of.size() != 2) continue;
      neighbours[of[0].first][of[0].second] = of[1].first;
      neighbours[of[1].first][of[1].second] = of[0].first;
    }
    CHECK(triangle_neighbours(mesh) == neighbours);
    const auto is_open = [&](const auto& edge) {
      const auto back = directed.find({edge.first.second, edge.first.first});
      return edge.second != 1 || back == directed.end() || back->second != 1;
    };
    CHECK(count_open_edges(mesh) == static_cast<std::size_t>(std::ranges::count_if(directed, is_open)));
  }
}

TEST_CASE("each region is one piece, joined over shared edges") {
  const Bake& bake = baked_human();
  const Mesh& mesh = bake.regions.body.mesh;
  std::map<std::pair<Index, Index>, std::vector<Index>> edges;
  for (Index t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k)
      edges[std::minmax(mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3])].push_back(t);
  }
  std::vector<std::set<Index>> next(mesh.triangles.size());
  for (const auto& [edge, triangles] : edges) {
    for (const Index a : triangles) {
      for (const Index b : triangles) {
        if (a != b && bake.regions.of_triangle[a] == bake.regions.of_triangle[b]) next[a].insert(b);
      }
    }
  }
  for (std::uint8_t region = 0; region < kRegionNames.size(); ++region) {
    std::vector<Index> all;
    for (Index t = 0; t < mesh.triangles.size(); ++t) {
      if (bake.regions.of_triangle[t] == region) all.push_back(t);
    }
    REQUIRE(!all.empty());
    std::set<Index> reached{all[0]};
    std::vector<Index> stack{all[0]};
    while (!stack.empty()) {
      const Index t = stack.back();
      stack.pop_back();
      for (const Index n : next[t]) {
        if (reached.insert(n).second) stack.push_back(n);
      }
    }
    CHECK_MESSAGE(reached.size() == all.size(), kRegionNames[region]);
  }
}

TEST_CASE("left and right arm, and left and right leg, have the same area to 3 %") {
  const Bake& bake = baked_human();
  for (const auto& [left, right] :
       {std::pair<std::uint8_t, std::uint8_t>(0, 1), std::pair<std::uint8_t, std::uint8_t>(2, 3)}) {
    CHECK(std::abs(area_of(bake, left) / area_of(bake, right) - 1) <= 0.03);
    MESSAGE(fmt::format("{}: {:.4f}, {}: {:.4f}", kRegionNames[left], area_of(bake, left), kRegionNames[right],
                        area_of(bake, right)));
  }
}

TEST_CASE("the body's axes are found: this one stands along y, faces z, and its left is x") {
  const BodyFrame& frame = baked_human().regions.frame;
  CHECK(frame.up.dot(Vec3::UnitY()) > 0.999);
  CHECK(frame.forward.dot(Vec3::UnitZ()) > 0.999);
  CHECK(frame.left.dot(Vec3::UnitX()) > 0.999);
  CHECK((frame.left.cross(frame.up) - frame.forward).norm() < 1e-9);
  CHECK(std::abs(frame.height - 1.66) < 0.01);
}

TEST_CASE("a facing direction in the settings overrides the feet and swaps left and right" *
          doctest::test_suite("many bakes")) {
  SegmentSettings settings;
  settings.facing = -Vec3::UnitZ();
  const Regions turned = *segment_by_shape(baked_human().character, baked_human().regions.body, settings);
  CHECK(turned.frame.forward.dot(Vec3::UnitZ()) < -0.999);
  const auto& usual = baked_human().regions.of_triangle;
  std::size_t swapped = 0;
  constexpr std::array<std::uint8_t, 5> kSwap{1, 0, 3, 2, 4};
  for (std::size_t t = 0; t < usual.size(); ++t) swapped += turned.of_triangle[t] == kSwap[usual[t]] ? 1u : 0u;
  CHECK(static_cast<double>(swapped) > 0.99 * static_cast<double>(usual.size()));
  settings.facing = Vec3::UnitX();
  const Attempt<Regions> sideways = segment_by_shape(baked_human().character, baked_human().regions.body, settings);
  REQUIRE_FALSE(sideways);
  CHECK(sideways.reason().what.find("facing direction") != std::string::npos);
}

TEST_CASE("a body without a limb is refused by the missing limb's name") {
  for (std::uint8_t limb = 0; limb < 4; ++limb) {
    std::string name = kRegionNames[limb];
    std::replace(name.begin(), name.end(), '_', ' ');
    const std::string error = segmentation_error(without_region(baked_human(), limb));
    CHECK_MESSAGE(error.find("the " + name + " is missing") != std::string::npos, error);
  }
}

TEST_CASE("a body without arms, a ball, a short tube and an open surface are refused with the reason") {
  CHECK(segmentation_error(without_region(baked_human(), 0, 1)).find("missing") != std::string::npos);
  CHECK(segmentation_error(ball_mesh(24)).find("missing") != std::string::npos);
  CHECK(segmentation_error(tube_mesh(2, 24)).find("missing") != std::string::npos);
  SourceMesh open = ball_mesh(24);
  open.triangles.pop_back();
  CHECK(segmentation_error(open).find("not one closed surface") != std::string::npos);
}

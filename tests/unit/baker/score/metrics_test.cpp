// SPDX-License-Identifier: GPL-3.0-or-later
// Each metric on a case that can be worked out by hand.
#include <doctest/doctest.h>

#include <algorithm>

#include "baker/score/far_pairs.h"
#include "baker/score/limmt.h"
#include "baker/score/movement.h"
#include "baker/score/star_rate.h"
#include "baker/score/swallowed_skin.h"
#include "baker/score/voxel_volume.h"

using namespace spherechain::baker;
using spherechain::TriangleContact;

namespace {

void add_box(Mesh& mesh, const Vec3& low, const Vec3& high) {
  const auto first = static_cast<Index>(mesh.positions.size());
  for (int k = 0; k < 8; ++k)
    mesh.positions.emplace_back((k & 1) != 0 ? high.x() : low.x(), (k & 2) != 0 ? high.y() : low.y(),
                                (k & 4) != 0 ? high.z() : low.z());
  for (const auto& [a, b, c, d] :
       {std::array<Index, 4>{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}) {
    mesh.triangles.push_back({first + a, first + b, first + c});
    mesh.triangles.push_back({first + a, first + c, first + d});
  }
}

// Where the edges of one triangle go through the other.
void add_crossings(const Mesh& mesh, Index one, Index other, std::vector<Vec3>& to) {
  const auto corner = [&](Index t, std::size_t k) -> const Vec3& { return mesh.positions[mesh.triangles[t][k % 3]]; };
  const Vec3 n = triangle_cross(mesh, other);
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 &p = corner(one, k), &q = corner(one, k + 1);
    const double from = n.dot(p - corner(other, 0)), till = n.dot(q - corner(other, 0));
    if (from * till > 0 || from == till) continue;
    const Vec3 at = p + from / (from - till) * (q - p);
    bool is_in = true;
    for (std::size_t e = 0; e < 3; ++e)
      is_in &= (corner(other, e + 1) - corner(other, e)).cross(at - corner(other, e)).dot(n) >= 0;
    if (is_in) to.push_back(at);
  }
}

std::vector<TriangleContact> contacts_of(const Mesh& mesh, Index first_of_second) {
  std::vector<TriangleContact> out;
  const auto single = [](const Vec3& v) {
    return sc_vec3{static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
  };
  for (Index a = 0; a < first_of_second; ++a) {
    for (Index b = first_of_second; b < mesh.triangles.size(); ++b) {
      std::vector<Vec3> points;
      add_crossings(mesh, a, b, points);
      add_crossings(mesh, b, a, points);
      if (points.size() < 2) continue;
      TriangleContact contact{};
      contact.triangle_a = a;
      contact.triangle_b = b;
      contact.from = single(points[0]);
      contact.to = single(*std::max_element(points.begin(), points.end(), [&](const Vec3& p, const Vec3& q) {
        return (p - points[0]).norm() < (q - points[0]).norm();
      }));
      out.push_back(contact);
    }
  }
  return out;
}

TEST_CASE("score: skin inside another box has the area and the volume of the boxes' intersection") {
  Mesh mesh;
  add_box(mesh, {0, 0, 0}, {1, 1, 1});
  add_box(mesh, {0.7, 0.21, 0.23}, {1.3, 0.81, 0.83});
  const ScoredSkin skin = scored_skin(mesh.positions, mesh.triangles);
  const SwallowedSkin swallowed(skin);
  const Swallowed found = swallowed.measure(mesh.positions, contacts_of(mesh, 12), {});
  CHECK(found.volume == doctest::Approx(0.3 * 0.6 * 0.6).epsilon(0.01));
  CHECK(found.area == doctest::Approx(2 * 0.36 + 4 * 0.3 * 0.6).epsilon(0.01));
  // Where a box is open its volume still exists, and is near that.
  std::vector<TriangleContact> some = contacts_of(mesh, 12);
  some.erase(some.begin());
  CHECK(swallowed.measure(mesh.positions, some, {}).volume == doctest::Approx(0.108).epsilon(0.5));
  CHECK(swallowed.measure(mesh.positions, {}, contacts_of(mesh, 12)).area == 0);
}

TEST_CASE("score: STaR's rate counts vertices behind the nearest vertex of the rest of the body") {
  ScoredSkin skin = scored_skin({{0, 0, 0}, {2, 0, 0}, {0, 0, 0.4}, {2, 0, 0.4}, {2, 0, -0.3}, {0, 0, -0.1}}, {});
  for (Index v = 2; v < 5; ++v) skin.places[v] = {true, false, false, ScoredLimb::kLeftArm};
  skin.places[5] = {false, true, false, ScoredLimb::kLeftArm};  // the shoulder is neither
  const std::vector<Vec3> normals(6, Vec3(0, 0, 1));
  const StarCount found = count_star(skin, skin.rest, normals);
  CHECK(found.vertices == 3);
  CHECK(found.inside == 1);
}

TEST_CASE("score: far pairs are many steps apart over edges, or on pieces that do not hang together") {
  Mesh strip;
  for (int k = 0; k < 64; ++k) strip.positions.emplace_back(k, k % 2, 0);
  for (Index k = 0; k < 60; ++k) strip.triangles.push_back({k, k + 1, k + 2});
  strip.positions.insert(strip.positions.end(), {{0, 9, 0}, {1, 9, 0}, {0, 8, 0}});
  strip.triangles.push_back({64, 65, 66});
  FarPairs far(scored_skin(strip.positions, strip.triangles));
  const auto pair = [](Index a, Index b) {
    TriangleContact contact{};
    contact.triangle_a = a;
    contact.triangle_b = b;
    return contact;
  };
  using Counts = std::array<std::size_t, 2>;
  CHECK(far.count({pair(0, 39)}) == Counts{0, 0});
  CHECK(far.count({pair(0, 40), pair(0, 49)}) == Counts{0, 2});
  CHECK(far.count({pair(0, 50), pair(3, 60), pair(3, 4)}) == Counts{2, 2});
}

TEST_CASE("score: voxels that the skin winds around twice, as a share of all inside") {
  Mesh mesh;
  add_box(mesh, {0, 0, 0}, {1, 1, 1});
  add_box(mesh, {0.5, 0, 0}, {1.5, 1, 1});
  const VoxelVolume voxels(mesh.positions, mesh.triangles);
  CHECK(voxels.share(mesh.positions, VoxelVolume::kFine) == doctest::Approx(0.5).epsilon(0.03));
  std::vector<Vec3> apart = mesh.positions;
  for (std::size_t v = 8; v < 16; ++v) apart[v].x() += 1;
  CHECK(voxels.share(apart, VoxelVolume::kCoarse) == 0);
}

LimmtFrame standing() {
  LimmtFrame out{{{{0, 0, 0}, {0, 0, 0, 1}, {1, 1, 1}}}, {0, 0}, {{{0, 0}}, {{1, 0}}}, {0, 1, 0}, 0, 0};
  return out;
}

TEST_CASE("score: LIMMT takes from 100 what its weights say") {
  std::vector<LimmtFrame> frames(40, standing());
  CHECK(limmt_score(frames, 30) == 100);
  for (LimmtFrame& frame : frames) frame.self_collisions = 3;
  CHECK(limmt_score(frames, 30) == doctest::Approx(100 - 0.17 * 3));
  for (LimmtFrame& frame : frames) frame.self_collisions = 1000;
  CHECK(limmt_score(frames, 30) == doctest::Approx(100 - 0.17 * 10));
  frames.assign(40, standing());
  for (std::size_t f = 0; f < 40; ++f) frames[f].feet[0][0] = static_cast<double>(f) / 30;  // 1 m/s
  CHECK(limmt_score(frames, 30) == doctest::Approx(100 - 1.7 * 5 * 0.9 * 39 / 40));
  frames.assign(40, standing());
  for (LimmtFrame& frame : frames) frame.lowest = -0.03;
  CHECK(limmt_score(frames, 30) == doctest::Approx(100 - 216.62 * 0.02));
  for (LimmtFrame& frame : frames) frame.lowest = 0.2;
  CHECK(limmt_score(frames, 30) == doctest::Approx(100 - 24.19 * 11.0 / 40));  // 11 frames have a second around them
  frames.assign(40, standing());
  for (std::size_t f = 20; f < 40; ++f) frames[f].root[0] = static_cast<double>(f - 19) / 30;  // sets off at 1 m/s
  CHECK(limmt_score(frames, 30) == doctest::Approx(100 - 0.28 * 0.01 * 30 / 40));
}

TEST_CASE("score: acceleration and jerk are differences over time") {
  Track track;
  for (int f = 0; f < 9; ++f) track.push_back({Vec3(0.5 * f * f, 0, 0), Vec3(0, f * f * f, 0)});
  CHECK(mean_difference({{track[0][0]}, {track[1][0]}, {track[2][0]}}, 2, 10) == doctest::Approx(100));
  CHECK(mean_difference(track, 3, 1) == doctest::Approx((0 + 6) / 2.0));
  CHECK(mean_distance(track, Track(5, {Vec3(0, 0, 0), Vec3(0, 0, 0)})) ==
        doctest::Approx((0.5 * (0 + 1 + 4 + 9 + 16) + (0 + 1 + 8 + 27 + 64)) / 10));
}

}  // namespace

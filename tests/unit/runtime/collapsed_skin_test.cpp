// SPDX-License-Identifier: MIT
// Contacts of a skin that a pose shrinks or takes so far off that its floats run out: against every two triangles
// tested.
#include <doctest/doctest.h>

#include <algorithm>
#include <random>

#include "jobs.h"
#include "spherechain/triangle_contacts.h"
#include "tiny_surface.h"

namespace spherechain::test {
namespace {

// A triangle as the asset has it: its source number, its sphere, its corners' source vertices and places at rest.
struct SkinTriangle {
  std::uint32_t number, sphere;
  std::uint32_t vertices[3], welds[3];
};

std::vector<SkinTriangle> triangles_of(const Asset& asset) {
  const Surface& surface = asset.surface();
  std::vector<SkinTriangle> out;
  for (const Leaf& leaf : surface.leaves) {
    for (std::uint32_t t = leaf.first_triangle; t < leaf.first_triangle + leaf.triangle_count; ++t) {
      SkinTriangle triangle{asset.triangles()[t], leaf.sphere, {}, {}};
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t vertex = surface.leaf_vertices[leaf.first_vertex + surface.corners[3 * t + k]];
        triangle.vertices[k] = surface.source_vertices[vertex];
        triangle.welds[k] = surface.welds[vertex];
      }
      out.push_back(triangle);
    }
  }
  return out;
}

bool is_ignored(const Asset& asset, std::uint32_t a, std::uint32_t b) {
  const std::size_t bit = std::size_t{std::max(a, b)} * (std::max(a, b) - 1) / 2 + std::min(a, b);
  return a == b || (asset.ignored()[bit / 64] >> (bit % 64) & 1U) != 0;
}

// By a plain loop: the scope kApart, or with `neighbours` kAll.
std::vector<TrianglePair> all_contacts(const Asset& asset, const std::vector<float>& positions, bool neighbours) {
  const std::vector<SkinTriangle> triangles = triangles_of(asset);
  const Span<const TrianglePair> rest = asset.surface().rest_contacts;
  std::vector<TrianglePair> out;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const SkinTriangle &a = triangles[i], &b = triangles[j];
      const TrianglePair pair{std::min(a.number, b.number), std::max(a.number, b.number)};
      const bool is_left_out = (!neighbours && is_ignored(asset, a.sphere, b.sphere)) ||
                               std::binary_search(rest.begin(), rest.end(), pair) ||
                               std::find_first_of(a.welds, a.welds + 3, b.welds, b.welds + 3) != a.welds + 3;
      Vec3 corners[2][3];
      for (std::size_t k = 0; k < 3; ++k) {
        const float *p = &positions[3 * a.vertices[k]], *q = &positions[3 * b.vertices[k]];
        corners[0][k] = {p[0], p[1], p[2]};
        corners[1][k] = {q[0], q[1], q[2]};
      }
      if (!is_left_out && triangles_intersect(corners[0], corners[1])) {
        out.push_back(pair);
      }
    }
  }
  std::sort(out.begin(), out.end());
  return out;
}

std::vector<TrianglePair> found_contacts(const Asset& asset, const std::vector<float>& positions, bool neighbours,
                                         Target target) {
  std::vector<std::uint64_t> words(TriangleContactContext::words_needed(asset));
  TriangleContactContext context{{words.data(), words.size()}};
  std::vector<TrianglePair> pairs(5000);
  TriangleContactJob job;
  job.asset = &asset;
  job.positions = positions.data();
  job.vertex_count = positions.size() / 3;
  job.target = target;
  job.scope = neighbours ? ContactScope::kAll : ContactScope::kApart;
  job.context = &context;
  job.pairs = {pairs.data(), pairs.size()};
  REQUIRE(job.run() == Status::kOk);
  pairs.resize(job.pair_count);
  return pairs;
}

}  // namespace

TEST_CASE("where corners fall together, contacts are those of the triangles that are left") {
  std::size_t total = 0;
  for (unsigned seed = 1; seed <= 3; ++seed) {
    std::mt19937 random(seed);
    TinyAsset tiny = random_asset(11, seed);
    const TinySkin skin = add_bones(tiny, 4, seed + 1);
    add_surface(tiny, &skin, 3);
    const OpenedAsset opened(tiny.parts);
    for (const int steps : {0, 1, 2, 4, 100}) {  // places along an axis, but for the first
      for (const float origin : {0.0F, 1e9F}) {
        std::uniform_int_distribution<int> place(0, steps);
        std::vector<float> positions(3 * opened.asset.info().source_vertex_count);
        for (float& figure : positions) {
          figure = origin + 64 * static_cast<float>(place(random));
        }
        for (const bool neighbours : {false, true}) {
          CAPTURE(steps);
          CAPTURE(origin);
          CAPTURE(neighbours);
          const std::vector<TrianglePair> expected = all_contacts(opened.asset, positions, neighbours);
          CHECK((steps == 0) <= expected.empty());
          total += expected.size();
          for (const Target target : supported_targets()) {
            CHECK(found_contacts(opened.asset, positions, neighbours, target) == expected);
          }
        }
      }
    }
  }
  CHECK(total > 1000);
}

}  // namespace spherechain::test

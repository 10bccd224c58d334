// SPDX-License-Identifier: MIT
// The skin table, from the packed skin, and skinning by it.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "jobs.h"
#include "palette.h"
#include "random_poses.h"
#include "tiny_skin.h"

namespace spherechain::test {
namespace {

constexpr std::size_t kSkinBones = 6;

struct SkinSource {
  explicit SkinSource(bool is_band, std::size_t triangles_of_cluster)
      : tiny(is_band ? random_band(9, 1) : random_asset(9, 1)), skin(add_bones(tiny, kSkinBones, 2)) {
    add_skin(tiny, &skin, triangles_of_cluster);
  }
  TinyAsset tiny;
  TinySkin skin;
};

float weight_of(const TinySkin& skin, std::uint32_t vertex, std::uint32_t bone) {
  for (const auto& [own, weight] : skin.weights[vertex]) {
    if (own == bone) return static_cast<float>(weight);
  }
  return 0;
}

// The vertices of a cluster, each by its source vertex, have what the source says.
void check_cluster(const SkinSource& p, const Surface& surface, const Cluster& cluster) {
  const std::size_t slots = slot_count(cluster);
  std::map<std::pair<std::uint32_t, std::uint32_t>, Vec3> morphs;  // by target and slot
  for (std::size_t slot = 0; slot < slots; ++slot) {
    const std::size_t at = cluster.first_vertex + std::min<std::size_t>(slot, cluster.vertex_count - 1U);
    const std::uint32_t source = surface.source_vertices[surface.cluster_vertices[at]];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t place = 3 * std::size_t{cluster.first_slot} + axis * slots + slot;
      CHECK(surface.slot_positions[place] == p.tiny.rest[3 * source + axis]);
    }
    float sum = 0;
    for (std::size_t k = 0; k < cluster.bone_count; ++k) {
      const std::uint32_t bone = surface.cluster_bones[cluster.first_bone + k];
      const float weight = surface.slot_weights[cluster.first_weight + k * slots + slot];
      CHECK(weight == weight_of(p.skin, source, bone));
      sum += weight;
    }
    CHECK(std::abs(sum - 1) < 1e-6F);  // no bone of the vertex is missing
    for (const auto& [target, delta] : p.skin.morphs[source]) {
      morphs[{target, static_cast<std::uint32_t>(slot)}] = {delta[0], delta[1], delta[2]};
    }
  }
  REQUIRE(cluster.morph_count == morphs.size());
  std::size_t i = cluster.first_morph;
  for (const auto& [key, delta] : morphs) {
    const SlotMorph& morph = surface.slot_morphs[i++];
    CHECK(morph.target == key.first);
    CHECK(morph.slot == key.second);
    CHECK(std::array{morph.delta.x, morph.delta.y, morph.delta.z} == std::array{delta.x, delta.y, delta.z});
  }
}

}  // namespace

TEST_CASE("the expanded skin is what was packed: positions, weights, morphs, welds, parts, corners") {
  for (const bool is_band : {true, false}) {
    for (const std::size_t triangles : {1U, 3U, 5U, 64U}) {
      CAPTURE(is_band);
      CAPTURE(triangles);
      const SkinSource p(is_band, triangles);
      const OpenedAsset opened(p.tiny.parts);
      REQUIRE_MESSAGE(opened.status == SC_OK, opened.message);
      const PreparedSkin table(opened.asset);
      REQUIRE(table.status == SC_OK);
      const Surface& surface = table.surface;
      // Some weights are left out of the file, some are not.
      const auto& counts = p.tiny.parts.skin.influence_counts;
      const auto left_out = std::count_if(counts.begin(), counts.end(), [](int c) { return c >= kOneWeightLeftOut; });
      CHECK(left_out > 0);
      CHECK(left_out < static_cast<std::ptrdiff_t>(counts.size()));
      if (is_band) {
        CHECK(surface.source_vertices.size < p.tiny.parts.vertex_count);  // some stand for two
        CHECK(!p.tiny.parts.skin.welds.empty());
      }
      std::uint32_t triangle = 0;
      for (const Cluster& cluster : surface.clusters) {
        check_cluster(p, surface, cluster);
        CHECK(cluster.first_triangle == triangle);
        for (std::size_t k = 0; k < cluster.triangle_count; ++k, ++triangle) {
          const std::uint32_t number = surface.triangles[triangle];
          const Numbers& own = p.tiny.triangles[cluster.sphere];
          CHECK(std::count(own.begin(), own.end(), number) == 1);
          CHECK(surface.parts[triangle] == p.tiny.part_of_triangle[number]);
          for (std::size_t corner = 0; corner < 3; ++corner) {
            const std::size_t slot = surface.corners[3 * triangle + corner];
            const std::uint32_t vertex = surface.cluster_vertices[cluster.first_vertex + slot];
            const std::uint32_t source = p.tiny.corners[number][corner], lowest = surface.source_vertices[vertex];
            CHECK(lowest <= source);
            CHECK(p.skin.weights[lowest] == p.skin.weights[source]);
            CHECK(std::equal(&p.tiny.rest[3 * source], &p.tiny.rest[3 * source] + 3, &p.tiny.rest[3 * lowest]));
          }
        }
      }
      CHECK(triangle == p.tiny.parts.triangle_count);
      for (std::uint32_t v = 0; v < surface.welds.size; ++v) {
        const auto place = [&](std::uint32_t w) { return &p.tiny.rest[3 * surface.source_vertices[w]]; };
        std::uint32_t lowest = 0;
        while (!std::equal(place(lowest), place(lowest) + 3, place(v))) ++lowest;
        CHECK(surface.welds[v] == lowest);
      }
      const Numbers& rest = p.tiny.parts.skin.rest_contacts;
      REQUIRE(surface.rest_contacts.size == rest.size() / 2);
      for (std::size_t i = 0; i < rest.size() / 2; ++i) {
        CHECK(surface.rest_contacts[i] == Pair{rest[2 * i], rest[2 * i + 1]});
      }
    }
  }
}

TEST_CASE("the expanded hulls have their vertices' positions and weights") {
  const SkinSource p(true, 3);
  const OpenedAsset opened(p.tiny.parts);
  const PreparedSkin table(opened.asset);
  const Surface& surface = table.surface;
  REQUIRE(surface.hulls.size == 9);
  std::size_t point = 0;
  for (const Hull& hull : surface.hulls) {
    for (std::size_t i = 0; i < hull.point_count; ++i, ++point) {
      const std::uint32_t source = p.tiny.parts.skin.sources[p.tiny.parts.skin.hull_points[point]];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        CHECK(surface.hull_points[3 * std::size_t{hull.first_point} + axis * hull.point_count + i] ==
              p.tiny.rest[3 * source + axis]);
      }
      for (std::size_t k = 0; k < hull.bone_count; ++k) {
        CHECK(surface.hull_weights[hull.first_weight + k * hull.point_count + i] ==
              weight_of(p.skin, source, surface.hull_bones[hull.first_bone + k].bone));
      }
    }
  }
  CHECK(point == p.tiny.parts.skin.hull_points.size());
}

TEST_CASE("the table fits its words at any alignment, and is none of another asset") {
  const SkinSource p(true, 3), q(false, 3);
  const OpenedAsset opened(p.tiny.parts), other(q.tiny.parts);
  const std::size_t count = skin_table_words(&opened.asset);
  for (std::size_t offset = 0; offset < 9; ++offset) {
    std::vector<std::uint64_t> words(count + offset + 1, 7);
    CHECK(prepare_skin(&opened.asset, words.data() + offset, count) == SC_OK);
    CHECK(words.back() == 7);
    Surface surface;
    CHECK(read_skin_table(opened.view(), words.data() + offset, surface) == SC_OK);
    CHECK(surface.triangles.size == p.tiny.parts.triangle_count);
    CHECK(std::equal(surface.triangles.begin(), surface.triangles.end(), p.tiny.parts.skin.triangles.begin()));
    CHECK(read_skin_table(other.view(), words.data() + offset, surface) ==
          sc_status{SC_BAD_VALUE, SC_FIELD_SKIN_TABLE});
  }
}

TEST_CASE("a table that was copied to another place in its cache line is refused") {
  const SkinSource p(true, 3);
  const OpenedAsset opened(p.tiny.parts);
  const std::size_t count = skin_table_words(&opened.asset);
  std::vector<std::uint64_t> words(count + 8);
  REQUIRE(prepare_skin(&opened.asset, words.data(), count) == SC_OK);
  std::copy_backward(words.begin(), words.begin() + static_cast<std::ptrdiff_t>(count), words.end() - 7);
  Surface surface;
  CHECK(read_skin_table(opened.view(), words.data() + 1, surface) == sc_status{SC_BAD_VALUE, SC_FIELD_SKIN_TABLE});
}

TEST_CASE("the skin's vertices are where double precision skinning puts them, to rounding") {
  const SkinSource p(false, 4);  // 12 vertices a cluster, in 16 slots
  const OpenedAsset opened(p.tiny.parts);
  REQUIRE_MESSAGE(opened.status == SC_OK, opened.message);
  std::mt19937 random(3);
  for (const PoseKind kind : kPoseKinds) {
    const std::vector<Matrix> matrices = random_pose(kSkinBones, kind, 1, random);
    for (const auto& weights : {std::vector<float>(), random_morph_weights(3, random)}) {
      const std::vector<float> expected = skinned(p.tiny, p.skin, matrices, weights);
      const std::vector<float> vertices = skin(opened.asset, pose_of(matrices, weights));
      REQUIRE(vertices.size() == expected.size());
      for (std::size_t i = 0; i < expected.size(); ++i) {
        CHECK(std::abs(vertices[i] - expected[i]) < 1e-5F);  // of coordinates of some units
      }
    }
  }
}

TEST_CASE("skinned vertices are the same bits on every target and from every layout of matrices") {
  const SkinSource p(false, 4);
  const OpenedAsset opened(p.tiny.parts);
  std::mt19937 random(4);
  const std::vector<Matrix> matrices = random_pose(kSkinBones, PoseKind::kSheared, 1, random);
  const std::vector<float> weights = random_morph_weights(3, random);
  const std::vector<float> expected = skin(opened.asset, pose_of(matrices, weights), SC_TARGET_SCALAR);
  for (const MatrixLayout layout : kLayouts) {
    const Palette palette(matrices, layout, 1);
    Pose pose = palette.pose();
    pose.morph_weights = weights.data();
    pose.morph_weight_count = weights.size();
    for (const Target target : supported_targets()) {
      CHECK(same_bits(skin(opened.asset, pose, target), expected));
    }
  }
}

}  // namespace spherechain::test

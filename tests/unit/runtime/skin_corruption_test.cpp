// SPDX-License-Identifier: MIT
// Each way in which a packed skin can be wrong has a message that names the table.
#include <doctest/doctest.h>

#include <algorithm>
#include <functional>
#include <string>

#include "jobs.h"
#include "tiny_skin.h"

namespace spherechain::test {
namespace {

// 12 spheres of four triangles, a cluster of three and one of one each; 5 bones, 3 morph targets.
TinyAsset tiny_with_skin() {
  TinyAsset tiny = random_asset(12, 1);
  const TinySkin skin = add_bones(tiny, 5, 2);
  add_skin(tiny, &skin, 3);
  return tiny;
}

struct SkinCorruption {
  const char* message;
  std::function<void(SkinParts&)> apply;
};

void check_refused(const TinyAsset& tiny, const std::vector<SkinCorruption>& corruptions) {
  REQUIRE(OpenedAsset(tiny.parts).status == SC_OK);
  for (const SkinCorruption& corruption : corruptions) {
    AssetParts parts = tiny.parts;
    corruption.apply(parts.skin);
    const OpenedAsset opened(parts);
    INFO("expected: ", std::string(corruption.message));
    INFO("message:  ", opened.message);
    CHECK(opened.status == sc_status{SC_CORRUPT, SC_FIELD_DATA});
    CHECK(opened.message.find(corruption.message) == 0);
  }
}

}  // namespace

TEST_CASE("a skin without bones has clusters, and no terms or hulls; one without triangles is empty") {
  TinyAsset tiny = random_asset(3, 1);
  const OpenedAsset without(tiny.parts);
  REQUIRE_MESSAGE(without.status == SC_OK, without.message);
  CHECK(without.view().skin().sizes.clusters == 0);
  CHECK(skin_table_words(&without.asset) == 0);
  add_skin(tiny, nullptr, 4);
  const OpenedAsset opened(tiny.parts);
  REQUIRE_MESSAGE(opened.status == SC_OK, opened.message);
  CHECK(opened.view().skin().sizes.clusters == 3);
  CHECK(opened.view().skin().bounds_terms.size == 0);
  CHECK(opened.view().skin().hulls.size == 0);
}

TEST_CASE("vertices, influences and morphs that are not sound are refused") {
  using S = SkinParts;
  check_refused(
      tiny_with_skin(),
      {
          {"skin.positions: 432 of them, but 435", [](S& s) { s.vertex_count += 1; }},
          {"skin.positions: 431 of them", [](S& s) { s.positions.pop_back(); }},
          {"skin.positions: one is not finite", [](S& s) { s.positions[47] = kNan; }},
          {"skin.sources[3]: missing, or past", [](S& s) { s.sources[3] = 144; }},
          {"skin.sources[143]: missing, or past", [](S& s) { s.sources.pop_back(); }},
          {"skin.sources: more of them", [](S& s) { s.sources.push_back(0); }},
          {"skin.welds[0]: missing, or past", [](S& s) { s.welds.assign(2, 144); }},
          {"skin.welds[0]: missing, or past", [](S& s) { s.welds = {5}; }},
          {"skin.welds[0]: not the lowest", [](S& s) { s.welds.assign(2, 5); }},
          {"skin.welds[1]: not the lowest",
           [](S& s) {
             s.welds = {5, 2, 5, 3};
           }},
          {"skin.influence_counts: 143 of them, but 144", [](S& s) { s.influence_counts.pop_back(); }},
          {"skin.influence_counts[7]: no bone moves it", [](S& s) { s.influence_counts[7] = 0; }},
          {"skin.influence_counts[7]: no bone moves it", [](S& s) { s.influence_counts[7] = 128; }},
          {"skin.influence_bones[4]: missing, or past", [](S& s) { s.influence_bones[4] = 5; }},
          {"skin.influence_bones: more of them", [](S& s) { s.influence_bones.push_back(0); }},
          {"skin.influence_weights: ", [](S& s) { s.influence_weights.pop_back(); }},
          {"skin.influence_weights: one is not from 0 to 1", [](S& s) { s.influence_weights[7] = kNan; }},
          {"skin.influence_weights: one is not from 0 to 1", [](S& s) { s.influence_weights[7] = -0.1F; }},
          {"skin.influence_weights: one is not from 0 to 1", [](S& s) { s.influence_weights[7] = 1.1F; }},
          {"skin.morph_counts: 143 of them, but 144", [](S& s) { s.morph_counts.pop_back(); }},
          {"skin.morphs[1]: missing", [](S& s) { s.morphs[1].target = 3; }},
          {"skin.morphs[1]: missing", [](S& s) { s.morphs[1].delta.z = kInfinity; }},
          {"skin.morphs: ", [](S& s) { s.morphs.push_back({}); }},
          {"skin.morphs[", [](S& s) { s.morphs.pop_back(); }},
          {"skin.morphs[", [](S& s) { *std::max_element(s.morph_counts.begin(), s.morph_counts.end()) = 65535; }},
          {"skin.morphs: ", [](S& s) { s.morph_counts.clear(); }},
      });
}

TEST_CASE("clusters, triangles and parts that are not sound are refused") {
  using S = SkinParts;
  check_refused(
      tiny_with_skin(),
      {
          {"skin.corners[3]: a corner", [](S& s) { s.corners[10] = 3; }},
          {"skin.corners[3]: a corner", [](S& s) { s.corners[10] = s.corners[9]; }},
          {"skin.clusters[23]: its corners", [](S& s) { s.corners.pop_back(); }},
          {"skin.corners: 145 of them, but 144", [](S& s) { s.corners.push_back(0); }},
          {"skin.clusters[23]: the clusters do not tile the triangles of sphere 11",
           [](S& s) { s.clusters.pop_back(); }},
          {"skin.clusters: 25 of them, but 24", [](S& s) { s.clusters.push_back(s.clusters.back()); }},
          {"skin.clusters[2]: the clusters do not tile", [](S& s) { s.clusters[2].triangle_count = 0; }},
          {"skin.clusters[2]: the clusters do not tile", [](S& s) { s.clusters[2].triangle_count = 5; }},
          {"skin.clusters[2]: its vertex_count", [](S& s) { s.clusters[2].vertex_count = 0; }},
          {"skin.clusters[2]: its vertex_count", [](S& s) { s.clusters[2].vertex_count = 193; }},
          {"skin.clusters[2]: its vertex_count", [](S& s) { s.clusters[2].bone_count = 0; }},
          {"skin.cluster_vertices[4]: missing, or past", [](S& s) { s.cluster_vertices[4] = 144; }},
          {"skin.cluster_vertices[4]: not above", [](S& s) { s.cluster_vertices[4] = s.cluster_vertices[3]; }},
          {"skin.cluster_vertices: more of them", [](S& s) { s.cluster_vertices.push_back(0); }},
          {"skin.cluster_bones[1]: missing, or past", [](S& s) { s.cluster_bones[1] = 5; }},
          {"skin.cluster_bones[1]: not above", [](S& s) { s.cluster_bones[1] = s.cluster_bones[0]; }},
          {"skin.cluster_bones: more of them", [](S& s) { s.cluster_bones.push_back(0); }},
          {"skin.triangles[3]: missing, or past", [](S& s) { s.triangles[3] = 48; }},
          {"skin.triangles[47]: missing, or past", [](S& s) { s.triangles.pop_back(); }},
          {"skin.triangles: more of them", [](S& s) { s.triangles.push_back(0); }},
          {"skin.part_runs[0]: no such value", [](S& s) { s.part_runs[0] = 5; }},
          {"skin.part_runs[1]: no such value", [](S& s) { s.part_run_ends[1] = s.part_run_ends[0]; }},
          {"skin.part_runs: 49 of them, but 48", [](S& s) { s.part_run_ends.back() = 49; }},
          {"skin.part_runs: ", [](S& s) { s.part_runs.pop_back(), s.part_run_ends.pop_back(); }},
          {"skin.part_runs: more of them", [](S& s) { s.part_run_ends.push_back(48); }},
          {"skin.clusters[2]: its vertex_count", [](S& s) { s.clusters[2].is_buried = 2; }},
      });
}

TEST_CASE("bounds, hulls and rest contacts that are not sound are refused") {
  using S = SkinParts;
  check_refused(
      tiny_with_skin(),
      {
          {"skin.boxes: 2 of them, but 3", [](S& s) { s.boxes.pop_back(); }},
          {"skin.boxes[1]: not finite", [](S& s) { s.boxes[1].z[7] = kNan; }},
          {"skin.boxes[1]: not finite", [](S& s) { s.boxes[1].half_x[0] = -1; }},
          {"skin.boxes[0]: not finite", [](S& s) { s.boxes[0].half_y[3] = kInfinity; }},
          {"skin.boxes[2]: not finite", [](S& s) { s.boxes[2].radius[1] = -1; }},
          {"skin.bounds_term_counts: 2 of them", [](S& s) { s.bounds_term_counts.pop_back(); }},
          {"skin.bounds_term_counts[1]: its entries are past", [](S& s) { s.bounds_term_counts[1] = 0xFFFFFFFFU; }},
          {"skin.bounds_term_bones: ", [](S& s) { s.bounds_term_counts[2] -= 1; }},
          {"skin.bounds_terms: ", [](S& s) { s.bounds_terms.pop_back(); }},
          {"skin.bounds_term_bones[1]: past the end", [](S& s) { s.bounds_term_bones[1] = 5; }},
          {"skin.bounds_term_bones[1]: past the end, not sorted", [](S& s) { s.bounds_term_bones[1] = 0; }},
          {"skin.bounds_term_bones[1]: ", [](S& s) { s.bounds_terms[1].weights[2] = kInfinity; }},
          {"skin.bounds_term_bones[1]: ", [](S& s) { s.bounds_terms[1].deviations[2] = -0.5F; }},
          {"skin.bounds_morph_counts: 2 of them", [](S& s) { s.bounds_morph_counts.pop_back(); }},
          {"skin.bounds_morph_counts[0]: its entries are past", [](S& s) { s.bounds_morph_counts[0] = 77; }},
          {"skin.bounds_morph_targets[1]: past the end", [](S& s) { s.bounds_morph_targets[1] = 3; }},
          {"skin.bounds_morph_targets[1]: ", [](S& s) { s.bounds_morphs[1].radius[3] = -1; }},
          {"skin.bounds_morphs: ", [](S& s) { s.bounds_morphs.pop_back(); }},
          {"skin.hulls: 11 of them, but 12", [](S& s) { s.hulls.pop_back(); }},
          {"skin.hulls[11]: its counts", [](S& s) { s.hulls[11].bone_count = 0; }},
          {"skin.hulls[11]: its counts", [](S& s) { s.hulls[11].point_count = 0; }},
          {"skin.hulls[2]: its counts", [](S& s) { s.hulls[2].point_count = 15; }},
          {"skin.hulls[3]: its center", [](S& s) { s.hulls[3].center.y = kNan; }},
          {"skin.hulls[3]: its center", [](S& s) { s.hulls[3].radius = -1; }},
          {"skin.hulls[3]: its center", [](S& s) { s.hulls[3].slack = kInfinity; }},
          {"skin.hull_bones[", [](S& s) { s.hulls[11].bone_count = 0xFFFF; }},
          {"skin.hull_bones[4]: past the bones", [](S& s) { s.hull_bones[4].bone = 5; }},
          {"skin.hull_bones[4]: past the bones", [](S& s) { s.hull_bones[4].x = kNan; }},
          {"skin.hull_bones[4]: past the bones", [](S& s) { s.hull_bones[4].w = -1; }},
          {"skin.hull_bones: ", [](S& s) { s.hull_bones.push_back({}); }},
          {"skin.hull_points[7]: missing, or past", [](S& s) { s.hull_points[7] = 144; }},
          {"skin.hull_points[", [](S& s) { s.hulls[11].point_count = 0xFFF0; }},
          {"skin.hull_points: more of them", [](S& s) { s.hull_points.push_back(0); }},
          {"skin.rest_contacts[1]: a is not below b", [](S& s) { s.rest_contacts[2] = s.rest_contacts[3]; }},
          {"skin.rest_contacts[0]: missing, or past", [](S& s) { s.rest_contacts[1] = 48; }},
          {"skin.rest_contacts[1]: a is not below b, or not sorted",
           [](S& s) { std::copy_n(s.rest_contacts.begin(), 2, s.rest_contacts.begin() + 2); }},
          {"skin.rest_contacts[1]: missing", [](S& s) { s.rest_contacts.pop_back(); }},
          {"skin.pieces[1]: its border", [](S& s) { s.pieces[1].second = -1; }},
          {"skin.covers[2]: missing, or past", [](S& s) { s.pieces.pop_back(); }},
          {"skin.covers: more of them", [](S& s) { s.covers.push_back(0); }},
          {"skin.cover_distances[2]: not finite", [](S& s) { s.cover_distances[2] = kNan; }},
          {"skin.cover_distances: 23 of them, but 24", [](S& s) { s.cover_distances.pop_back(); }},
          {"skin.layer_pairs[0]: missing, or past", [](S& s) { s.layer_pairs[1] = 24; }},
          {"skin.layer_pairs[0]: a is not below b", [](S& s) { s.layer_pairs[1] = s.layer_pairs[0]; }},
          {"skin.layer_runs[0]: no such value", [](S& s) { s.layer_runs[0] = 8; }},
          {"skin.layer_runs: 47 of them, but 48", [](S& s) { s.layer_run_ends[0] = 47; }},
          {"skin.windings: 35 of them, but 36", [](S& s) { s.windings.pop_back(); }},
          {"skin.core_triangles[3]: missing, or past", [](S& s) { s.core_triangles[3] = 49; }},
          {"skin.core_windings: 1919 of them, but 1920", [](S& s) { s.core_windings.pop_back(); }},
      });
}

TEST_CASE("a spare lane of a group of clusters that is not 0 is refused") {
  TinyAsset tiny = random_asset(3, 1);  // three clusters: five spare lanes
  const TinySkin skin = add_bones(tiny, 3, 2);
  add_skin(tiny, &skin, 4);
  check_refused(tiny, {{"skin.boxes[0]: ", [](SkinParts& s) { s.boxes[0].half_x[5] = 1; }},
                       {"skin.bounds_term_bones[0]: ", [](SkinParts& s) { s.bounds_terms[0].weights[7] = 1; }},
                       {"skin.bounds_morph_targets[0]: ", [](SkinParts& s) { s.bounds_morphs[0].radius[4] = 1; }}});
}

TEST_CASE("a stream whose numbers leave 32 bits, or end in the middle, is refused") {
  const TinyAsset tiny = tiny_with_skin();
  const std::vector<std::uint8_t> bytes = build(tiny.parts), own = encode(tiny.parts.skin.sources);
  const auto at = std::search(bytes.begin(), bytes.end(), own.begin(), own.end()) - bytes.begin();
  REQUIRE(at < static_cast<std::ptrdiff_t>(bytes.size()));
  const auto open = [&](std::initializer_list<std::uint8_t> first) {
    std::vector<std::uint8_t> changed = bytes;
    std::copy(first.begin(), first.end(), changed.begin() + at);
    Asset asset;
    char message[160];
    const sc_status status =
        sc_asset_open(&asset, SC_ABI_VERSION, changed.data(), changed.size(), message, sizeof message);
    CHECK(std::string(message).find("skin.sources[") == 0);
    return status;
  };
  CHECK(open({0x01}) == SC_CORRUPT);                                // -1
  CHECK(open({0xFF, 0xFF, 0xFF, 0xFF, 0x7F}) == SC_CORRUPT);        // past 32 bits
  CHECK(open({0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x01}) == SC_CORRUPT);  // longer than any number
  std::vector<std::uint8_t> open_end = bytes;
  open_end[static_cast<std::size_t>(at) + own.size() - 1] |= 0x80U;  // the last one goes on
  Asset asset;
  CHECK(sc_asset_open(&asset, SC_ABI_VERSION, open_end.data(), open_end.size(), nullptr, 0) == SC_CORRUPT);
}

}  // namespace spherechain::test

// SPDX-License-Identifier: MIT
// The surface of an asset: what is written is read, and each way it can be wrong has a message that names the field.
#include <doctest/doctest.h>

#include <functional>
#include <string>

#include "jobs.h"
#include "tiny_surface.h"

namespace spherechain::test {
namespace {

template <typename T>
std::vector<T> to_vector(Span<const T> span) {
  return {span.begin(), span.end()};
}

// 12 spheres of four triangles, a leaf of three and one of one each; 5 bones, 3 morph targets.
TinyAsset tiny_with_surface() {
  TinyAsset tiny = random_asset(12, 1);
  const TinySkin skin = add_bones(tiny, 5, 2);
  add_surface(tiny, &skin, 3);
  return tiny;
}

void check_same(const Surface& surface, const SurfaceParts& parts) {
  CHECK(same_bits(to_vector(surface.leaves), parts.leaves));
  CHECK(same_bits(to_vector(surface.leaf_balls), parts.leaf_balls));
  CHECK(to_vector(surface.leaf_vertices) == parts.leaf_vertices);
  CHECK(to_vector(surface.leaf_bones) == parts.leaf_bones);
  CHECK(to_vector(surface.corners) == parts.corners);
  CHECK(to_vector(surface.source_vertices) == parts.source_vertices);
  CHECK(to_vector(surface.welds) == parts.welds);
  CHECK(same_bits(to_vector(surface.slot_positions), parts.slot_positions));
  CHECK(same_bits(to_vector(surface.slot_weights), parts.slot_weights));
  CHECK(same_bits(to_vector(surface.slot_morphs), parts.slot_morphs));
  CHECK(to_vector(surface.cover_term_counts) == parts.cover_term_counts);
  CHECK(to_vector(surface.cover_term_bones) == parts.cover_term_bones);
  CHECK(same_bits(to_vector(surface.cover_terms), parts.cover_terms));
  CHECK(to_vector(surface.cover_morph_counts) == parts.cover_morph_counts);
  CHECK(to_vector(surface.cover_morph_targets) == parts.cover_morph_targets);
  CHECK(same_bits(to_vector(surface.cover_morphs), parts.cover_morphs));
  CHECK(to_vector(surface.rest_contacts) == parts.rest_contacts);
  CHECK(same_bits(to_vector(surface.leaf_boxes), parts.leaf_boxes));
  CHECK(same_bits(to_vector(surface.outlines), parts.outlines));
  CHECK(same_bits(to_vector(surface.outline_bones), parts.outline_bones));
  CHECK(same_bits(to_vector(surface.outline_points), parts.outline_points));
  CHECK(same_bits(to_vector(surface.outline_weights), parts.outline_weights));
}

}  // namespace

TEST_CASE("the views of a surface hold what was written") {
  const TinyAsset tiny = tiny_with_surface();
  const OpenedAsset opened(tiny.parts);
  REQUIRE(opened.status == Status::kOk);
  CHECK(opened.asset.leaf_count() == 24);
  CHECK(tiny.parts.surface.cover_term_counts.size() == 3);
  CHECK(!tiny.parts.surface.cover_morphs.empty());
  check_same(opened.asset.surface(), tiny.parts.surface);
}

TEST_CASE("a surface that nothing moves has leaves, and no bones") {
  TinyAsset tiny = random_asset(3, 1);
  add_surface(tiny, nullptr, 4);
  const OpenedAsset opened(tiny.parts);
  REQUIRE(opened.status == Status::kOk);
  CHECK(opened.asset.leaf_count() == 3);
  CHECK(opened.asset.surface().cover_terms.size == 0);
  check_same(opened.asset.surface(), tiny.parts.surface);
}

TEST_CASE("a surface of an older baker has no boxes around its leaves") {
  TinyAsset tiny = tiny_with_surface();
  tiny.parts.surface.leaf_boxes.clear();
  const OpenedAsset opened(tiny.parts);
  REQUIRE(opened.status == Status::kOk);
  CHECK(opened.asset.surface().leaf_boxes.size == 0);
  check_same(opened.asset.surface(), tiny.parts.surface);
}

TEST_CASE("a surface of an older baker has no outlines of its spheres") {
  TinyAsset tiny = tiny_with_surface();
  tiny.parts.surface.outlines.clear();
  const OpenedAsset opened(tiny.parts);
  REQUIRE(opened.status == Status::kOk);
  CHECK(opened.asset.surface().outlines.size == 0);
  CHECK(opened.asset.surface().outline_weights.size == 0);
}

TEST_CASE("an asset without a surface opens and has no leaves") {
  const OpenedAsset opened(random_asset(3, 1).parts);
  REQUIRE(opened.status == Status::kOk);
  CHECK(opened.asset.leaf_count() == 0);
  CHECK(opened.asset.surface().corners.size == 0);
}

TEST_CASE("each wrong value of a surface is refused by its name") {
  const TinyAsset tiny = tiny_with_surface();
  REQUIRE(OpenedAsset(tiny.parts).status == Status::kOk);
  using S = SurfaceParts;
  struct Corruption {
    const char* message;
    std::function<void(S&)> apply;
  };
  const std::vector<Corruption> corruptions{
      {"surface.source_vertices[3]: 144 is past", [](S& s) { s.source_vertices[3] = 144; }},
      {"surface.welds: 143", [](S& s) { s.welds.pop_back(); }},
      {"surface.welds[3]: not the lowest", [](S& s) { s.welds[3] = 4; }},
      {"surface.welds[3]: not the lowest", [](S& s) { s.welds[3] = 0xFFFFFFFFU; }},
      {"surface.welds[5]: not the lowest", [](S& s) { s.welds[4] = 2, s.welds[5] = 4; }},
      {"surface.corners: 143 of them, but 144", [](S& s) { s.corners.pop_back(); }},
      {"surface.corners: triangle 3 has", [](S& s) { s.corners[10] = 3; }},
      {"surface.corners: triangle 3 has", [](S& s) { s.corners[10] = s.corners[9]; }},
      {"surface.leaves[23]: the leaves do not tile", [](S& s) { s.leaves.pop_back(); }},
      {"surface.leaves: 25 of them, but 24", [](S& s) { s.leaves.push_back(s.leaves.back()); }},
      {"surface.leaves[2]: the leaves do not tile the triangles of sphere 1", [](S& s) { s.leaves[2].sphere = 0; }},
      {"surface.leaves[2]: the leaves do not tile", [](S& s) { s.leaves[2].first_triangle += 1; }},
      {"surface.leaves[2]: the leaves do not tile", [](S& s) { s.leaves[2].triangle_count = 0; }},
      {"surface.leaves[2]: the leaves do not tile", [](S& s) { s.leaves[2].triangle_count = 5; }},
      {"surface.leaves[2]: its vertex_count", [](S& s) { s.leaves[2].vertex_count = 0; }},
      {"surface.leaves[2]: its vertex_count", [](S& s) { s.leaves[2].vertex_count = 256; }},
      {"surface.leaves[2]: its vertex_count", [](S& s) { s.leaves[2].reserved = 1; }},
      {"surface.leaves[2]: it hangs on no bone", [](S& s) { s.leaves[2].bone_count = 0; }},
      {"surface.leaves[2]: a run of it", [](S& s) { s.leaves[2].first_vertex += 1; }},
      {"surface.leaves[2]: a run of it", [](S& s) { s.leaves[2].first_bone = 0xFFFFFFFFU; }},
      {"surface.leaves[2]: a run of it", [](S& s) { s.leaves[2].first_slot -= 1; }},
      {"surface.leaves[2]: a run of it", [](S& s) { s.leaves[2].first_weight += 8; }},
      {"surface.leaves[2]: a run of it", [](S& s) { s.leaves[2].first_morph = 0x80000000U; }},
      {"surface.leaves[23]: a run of it", [](S& s) { s.leaves[23].vertex_count = 255; }},
      {"surface.leaves[23]: a run of it", [](S& s) { s.leaves[23].morph_count = 0xFFFFFFFFU; }},
      {"surface.leaves[23]: a run of it", [](S& s) { s.leaf_bones.pop_back(); }},
      {"surface.leaves[23]: a run of it", [](S& s) { s.slot_positions.pop_back(); }},
      {"surface.leaves[23]: a run of it", [](S& s) { s.slot_weights.pop_back(); }},
      {"surface.slot_positions: ", [](S& s) { s.slot_positions.push_back(0); }},
      {"surface.slot_weights: ", [](S& s) { s.slot_weights.push_back(0); }},
      {"surface.slot_morphs: ",
       [](S& s) {
         s.slot_morphs.push_back({0, 0, {}});
       }},
      {"surface.leaves[0]: a position", [](S& s) { s.slot_positions[47] = kNan; }},
      {"surface.leaves[1]: a position", [](S& s) { s.slot_positions[48] = kInfinity; }},
      {"surface.leaves[0]: a weight", [](S& s) { s.slot_weights[7] = kNan; }},
      {"surface.leaves[0]: a weight", [](S& s) { s.slot_weights[7] = -0.1F; }},
      {"surface.leaves[0]: a weight", [](S& s) { s.slot_weights[7] = 1.1F; }},
      {"surface.slot_morphs[1].target: 3 is past the 3", [](S& s) { s.slot_morphs[1].target = 3; }},
      {"surface.slot_morphs[1]: its slot", [](S& s) { s.slot_morphs[1].slot = 16; }},
      {"surface.slot_morphs[1]: its slot", [](S& s) { s.slot_morphs[1].delta.z = kInfinity; }},
      {"surface.slot_morphs[1]: not sorted", [](S& s) { s.slot_morphs[1] = s.slot_morphs[0]; }},
      {"surface.leaf_vertices: 145", [](S& s) { s.leaf_vertices.push_back(0); }},
      {"surface.leaf_vertices[4]: 144 is past", [](S& s) { s.leaf_vertices[4] = 144; }},
      {"surface.leaf_vertices[4]: not above", [](S& s) { s.leaf_vertices[4] = s.leaf_vertices[3]; }},
      {"surface.leaf_bones: ", [](S& s) { s.leaf_bones.push_back(0); }},
      {"surface.leaf_bones[1]: 5 is past", [](S& s) { s.leaf_bones[1] = 5; }},
      {"surface.leaf_bones[1]: not above", [](S& s) { s.leaf_bones[1] = s.leaf_bones[0]; }},
      {"surface.leaf_balls: 2 of them, but 3", [](S& s) { s.leaf_balls.pop_back(); }},
      {"surface.leaf_balls[1]: not finite", [](S& s) { s.leaf_balls[1].x[7] = kNan; }},
      {"surface.leaf_balls[1]: not finite", [](S& s) { s.leaf_balls[1].radius[0] = -1; }},
      {"surface.leaf_boxes: 2 of them, but 3", [](S& s) { s.leaf_boxes.pop_back(); }},
      {"surface.leaf_boxes[1]: not finite", [](S& s) { s.leaf_boxes[1].z[7] = kNan; }},
      {"surface.leaf_boxes[1]: not finite", [](S& s) { s.leaf_boxes[1].half_x[0] = -1; }},
      {"surface.leaf_boxes[0]: not finite", [](S& s) { s.leaf_boxes[0].half_y[3] = kInfinity; }},
      {"surface.leaf_boxes[2]: not finite", [](S& s) { s.leaf_boxes[2].half_z[1] = kNan; }},
      {"surface.leaf_boxes[2]: not finite", [](S& s) { s.leaf_boxes[2].radius[1] = -1; }},
      {"surface.cover_term_counts: 2 of them", [](S& s) { s.cover_term_counts.pop_back(); }},
      {"surface.cover_term_counts[1]: its entries are past", [](S& s) { s.cover_term_counts[1] = 0xFFFFFFFFU; }},
      {"surface.cover_term_bones: ", [](S& s) { s.cover_term_counts[2] -= 1; }},
      {"surface.cover_terms: ", [](S& s) { s.cover_terms.pop_back(); }},
      {"surface.cover_term_bones[1]: 5 is past", [](S& s) { s.cover_term_bones[1] = 5; }},
      {"surface.cover_term_bones[1]: not above", [](S& s) { s.cover_term_bones[1] = 0; }},
      {"surface.cover_term_bones[1]: its lanes", [](S& s) { s.cover_terms[1].weights[2] = kInfinity; }},
      {"surface.cover_term_bones[1]: its lanes", [](S& s) { s.cover_terms[1].deviations[2] = -0.5F; }},
      {"surface.cover_morph_counts: 2 of them", [](S& s) { s.cover_morph_counts.pop_back(); }},
      {"surface.cover_morph_counts[0]: its entries are past", [](S& s) { s.cover_morph_counts[0] = 77; }},
      {"surface.cover_morph_targets[1]: 3 is past", [](S& s) { s.cover_morph_targets[1] = 3; }},
      {"surface.cover_morph_targets[1]: not above", [](S& s) { s.cover_morph_targets[1] = 0; }},
      {"surface.cover_morph_targets[1]: its lanes", [](S& s) { s.cover_morphs[1].radius[3] = -1; }},
      {"surface.cover_morphs: ", [](S& s) { s.cover_morphs.pop_back(); }},
      {"surface.outlines: 11 of them, but 12", [](S& s) { s.outlines.pop_back(); }},
      {"surface.outlines[1]: not where its leaves start", [](S& s) { s.outlines[1].first_leaf = 1; }},
      {"surface.outlines[11]: not where its leaves start", [](S& s) { s.outlines[11].bone_count = 0; }},
      {"surface.outlines[11]: not where its leaves start", [](S& s) { s.outlines[11].point_count = 0; }},
      {"surface.outlines[2]: not where its leaves start", [](S& s) { s.outlines[2].point_count = 15; }},
      {"surface.outlines[2]: a run of it", [](S& s) { s.outlines[2].first_bone -= 1; }},
      {"surface.outlines[2]: a run of it", [](S& s) { s.outlines[2].first_point = 0xFFFFFFF0U; }},
      {"surface.outlines[2]: a run of it", [](S& s) { s.outlines[2].first_weight += 16; }},
      {"surface.outlines[11]: a run of it", [](S& s) { s.outlines[11].point_count = 0xFFF0; }},
      {"surface.outlines[11]: a run of it", [](S& s) { s.outlines[11].bone_count = 0xFFFF; }},
      {"surface.outlines[11]: a run of it", [](S& s) { s.outline_points.pop_back(); }},
      {"surface.outlines[11]: a run of it", [](S& s) { s.outline_weights.pop_back(); }},
      {"surface.outlines[3]: its center", [](S& s) { s.outlines[3].center.y = kNan; }},
      {"surface.outlines[3]: its center", [](S& s) { s.outlines[3].radius = kInfinity; }},
      {"surface.outlines[3]: its center", [](S& s) { s.outlines[3].radius = -1; }},
      {"surface.outlines[3]: its center", [](S& s) { s.outlines[3].slack = kNan; }},
      {"surface.outline_bones[4]: past the bones", [](S& s) { s.outline_bones[4].bone = 5; }},
      {"surface.outline_bones[4]: past the bones", [](S& s) { s.outline_bones[4].x = kNan; }},
      {"surface.outline_bones[4]: past the bones", [](S& s) { s.outline_bones[4].w = -1; }},
      {"surface.outline_points: one is not finite", [](S& s) { s.outline_points[7] = kInfinity; }},
      {"surface.outline_weights: one is not from 0 to 1", [](S& s) { s.outline_weights[7] = kNan; }},
      {"surface.outline_weights: one is not from 0 to 1", [](S& s) { s.outline_weights[7] = 1.5F; }},
      {"surface.outline_bones: ",
       [](S& s) {
         s.outline_bones.push_back({0, 0, 0, 0, 0});
       }},
      {"surface.outline_points: ", [](S& s) { s.outline_points.insert(s.outline_points.end(), 3, 0.0F); }},
      {"surface.outline_weights: ", [](S& s) { s.outline_weights.push_back(0); }},
      {"surface.rest_contacts[1]: a is not below b",
       [](S& s) {
         s.rest_contacts[1] = {3, 3};
       }},
      {"surface.rest_contacts[0]: a is not below b", [](S& s) { s.rest_contacts[0].b = 48; }},
      {"surface.rest_contacts[1]: not sorted", [](S& s) { s.rest_contacts[1] = s.rest_contacts[0]; }},
  };
  for (const Corruption& corruption : corruptions) {
    AssetParts parts = tiny.parts;
    corruption.apply(parts.surface);
    const OpenedAsset opened(parts);
    INFO("expected: ", corruption.message);
    INFO("message:  ", opened.message);
    CHECK(opened.status == Status::kCorrupt);
    CHECK(opened.message.find(corruption.message) == 0);
    CHECK(opened.asset.leaf_count() == 0);
  }
}

TEST_CASE("a spare lane of a group of leaves that is not 0 is refused") {
  TinyAsset tiny = random_asset(3, 1);  // three leaves: five spare lanes
  const TinySkin skin = add_bones(tiny, 3, 2);
  add_surface(tiny, &skin, 4);
  REQUIRE(OpenedAsset(tiny.parts).status == Status::kOk);
  const auto refuses = [&](auto change) {
    AssetParts parts = tiny.parts;
    change(parts.surface);
    return OpenedAsset(parts).status == Status::kCorrupt;
  };
  CHECK(refuses([](SurfaceParts& s) { s.leaf_balls[0].y[3] = 1; }));
  CHECK(refuses([](SurfaceParts& s) { s.leaf_boxes[0].half_x[5] = 1; }));
  CHECK(refuses([](SurfaceParts& s) { s.cover_terms[0].weights[7] = 1; }));
  CHECK(refuses([](SurfaceParts& s) { s.cover_morphs[0].radius[4] = 1; }));
}

}  // namespace spherechain::test

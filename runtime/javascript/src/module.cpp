// SPDX-License-Identifier: MIT
// Functions that spherechain.js needs beside the C interface, and where it finds the fields of the interface's structs.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "runtime/src/base/message.h"
#include "runtime/src/bodies/body.h"
#include "runtime/src/clusters/set_up.h"
#include "runtime/src/simd/simd.h"
#include "runtime/src/skin/skin_inputs.h"
#include "runtime/src/skin/skin_table.h"
#include "spherechain/response.h"
#include "spherechain/version.h"

#define EXPORT(name) extern "C" __attribute__((export_name(#name)))

using namespace spherechain;

static_assert(sizeof(void*) == 4 && sizeof(sc_status) == 2 * 4 && offsetof(sc_status, field) == 4);
static_assert(offsetof(sc_asset_info, vertex_count) == 6 * 4 && offsetof(sc_asset_info, writer) == 9 * 4);
static_assert(offsetof(sc_asset_info, origin) == 16 * 4 && offsetof(sc_asset_info, metres_per_unit) == 29 * 4);
static_assert(offsetof(sc_asset_info, ignored_pairs) == 30 * 4 && sizeof(sc_asset_info) == 32 * 4);
static_assert(SC_ABI_VERSION == 18);
static_assert(sizeof(sc_bone) == 2 * 4 && sizeof(sc_part) == 5 * 4 && sizeof(sc_rest_sphere) == 9 * 4);
static_assert(sizeof(sc_model_def) == 7 * 4 && offsetof(sc_model_def, inverse_bind_layout) == 4);
static_assert(sizeof(sc_body_def) == 6 * 4 && offsetof(sc_body_def, finds_steps) == 4);
static_assert(sizeof(sc_triangle) == 3 * 4);
static_assert(sizeof(sc_pose) == 9 * 4 && offsetof(sc_pose, morph_weights) == 4 * 4);
static_assert(sizeof(sc_transform) == 10 * 4 && offsetof(sc_transform, scale) == 7 * 4);
static_assert(sizeof(sc_rule) == 19 * 4 && offsetof(sc_rule, inside) == 14 * 4);
static_assert(sizeof(sc_query) == 15 * 4 && offsetof(sc_query, radius) == 3 * 4 && offsetof(sc_query, rule) == 8 * 4);
static_assert(sizeof(sc_ground) == 7 * 4 && offsetof(sc_ground, height) == 4 * 4);
static_assert(sizeof(sc_penetrations) == 3 * 4);
static_assert(sizeof(sc_contacts) == 8 * 4 && offsetof(sc_contacts, triangles) == 5 * 4);
static_assert(sizeof(sc_sphere_pairs) == 5 * 4 && offsetof(sc_sphere_pairs, pairs) == 2 * 4);
static_assert(sizeof(sc_part_contact) == 9 * 4 && offsetof(sc_part_contact, low) == 3 * 4);
static_assert(sizeof(sc_triangle_contact) == 12 * 4 && offsetof(sc_triangle_contact, from) == 6 * 4);
static_assert(sizeof(sc_penetration) == 55 * 4 && offsetof(sc_penetration, direction) == 4 * 4);
static_assert(offsetof(sc_penetration, centre) == 9 * 4 && offsetof(sc_penetration, deepest) == 18 * 4);
static_assert(offsetof(sc_penetration, measures) == 32 * 4 && offsetof(sc_measures, relation) == 11 * 4);
static_assert(sizeof(sc_measures) == 19 * 4 && offsetof(sc_measures, through) == 14 * 4);
static_assert(SC_RESPONSE_WORDS == 480 && sizeof(sc_contact_row) == 14 * 4 &&
              offsetof(sc_contact_row, normal) == 9 * 4);
static_assert(sizeof(sc_response_def) == 9 * 4 && offsetof(sc_response_def, part_pairs) == 6 * 4);
static_assert(sizeof(sc_response_frame) == 21 * 4 && offsetof(sc_response_frame, seconds) == 5 * 4);
static_assert(offsetof(sc_response_frame, others) == 10 * 4 && offsetof(sc_response_frame, target) == 15 * 4);
static_assert(offsetof(sc_response_frame, rows) == 19 * 4);
static_assert(sizeof(sc_step_contact) == 11 * 4 && offsetof(sc_step_contact, triangle_a) == 6 * 4);

namespace {

Surface surface_of(const sc_model& model) {
  Surface surface;
  if (has_skin(view_of(model.asset))) {
    read_skin_table(view_of(model.asset), model.skin_table, surface);
  }
  return surface;
}

bool are_finite(const float* values, std::size_t count) {
  return std::all_of(values, values + count, [](float value) { return std::isfinite(value); });
}

}  // namespace

EXPORT(version) const char* version() { return SC_VERSION; }

// Takes the pose back if it has a number that is not finite: such a pose has no contacts, and would look clean. Then it
// returns 1, and `message` (256 bytes) names the number's bone, morph or vertex.
EXPORT(refuse_not_finite) int refuse_not_finite(sc_body* body, char* message) {
  const AssetView& asset = asset_of(*body);
  const sc_pose& pose = body->now.pose;
  Message sentence(message, 256);
  bool is_finite = true;
  for (std::size_t b = 0; pose.bones != nullptr && is_finite && b < asset.bone_count(); ++b) {
    const std::uint32_t* const joints = body->model->joint_of_bone;
    is_finite = are_finite(pose.bones + 12 * b, 12) ||
                sentence.wrong("the palette's matrix of bone \"%s\" (joint %zu) is not finite",
                               sc_asset_bone(&body->model->asset, b).name, joints == nullptr ? b : joints[b]);
  }
  for (std::size_t m = 0; pose.morph_weights != nullptr && is_finite && m < asset.morph_count(); ++m) {
    is_finite = std::isfinite(pose.morph_weights[m]) ||
                sentence.wrong("the weight of morph \"%s\" is not finite", sc_asset_morph_name(&body->model->asset, m));
  }
  for (std::size_t v = 0; pose.vertices != nullptr && is_finite && v < asset.vertex_count(); ++v) {
    is_finite = are_finite(pose.vertices + 3 * v, 3) || sentence.wrong("vertex %zu is not finite", v);
  }
  body->now.is_given = is_finite;
  return is_finite ? 0 : 1;
}

// Vertices of the skin: the asset merges the source's duplicates.
EXPORT(count_skin_vertices) std::size_t count_skin_vertices(const sc_model* model) {
  return surface_of(*model).source_vertices.size;
}

// Three of them for each of the source's triangles; zeros where the skin leaves a triangle out.
EXPORT(index_triangles) void index_triangles(const sc_model* model, std::uint32_t* out) {
  const Surface surface = surface_of(*model);
  std::fill_n(out, 3 * view_of(model->asset).info().triangle_count, 0U);
  for (std::size_t place = 0; place < surface.triangles.size; ++place) {
    std::copy_n(surface.triangle_vertices.data + 3 * place, 3, out + 3 * surface.triangles[place]);
  }
}

// Where they are in the body's pose, x, y, z each. 0 where it has none.
EXPORT(pose_skin) int pose_skin(const sc_body* body, float* out) {
  const Surface surface = surface_of(*body->model);
  const sc_pose& pose = body->now.pose;
  if (!body->now.is_given) {
    return 0;
  }
  if (pose.vertices == nullptr) {
    Target target{};
    resolve_target(SC_TARGET_BEST, target);
    skin_vertices(surface, pose, target, {}, out);
    return 1;
  }
  for (std::size_t v = 0; v < surface.source_vertices.size; ++v) {
    std::copy_n(pose.vertices + 3 * surface.source_vertices[v], 3, out + 3 * v);
  }
  return 1;
}

/* SPDX-License-Identifier: MIT */
#include "c_calls.h"

#include <stdlib.h>
#include <string.h>

#define EXPECT(condition)                         \
  do {                                            \
    if (!(condition)) {                           \
      if (!out->failed) out->failed = #condition; \
    }                                             \
  } while (0)
#define OK(call) EXPECT((call).code == SC_OK)

static uint64_t* words(size_t count) { return (uint64_t*)calloc(count + 1, sizeof(uint64_t)); }

static void call_accessors(const sc_asset* asset, const float* rest, size_t vertex_count, c_calls_result* out) {
  const sc_asset_info info = sc_asset_get_info(asset);
  size_t count = 0;
  EXPECT(info.vertex_count == vertex_count);
  EXPECT(sc_asset_sphere(asset, 0).radius > 0);
  EXPECT(strcmp(sc_asset_bone(asset, 0).name, "bone0") == 0);
  EXPECT(strcmp(sc_asset_part(asset, 0).name, "left hand") == 0);
  EXPECT(strcmp(sc_asset_morph_name(asset, 0), "morph0") == 0);
  EXPECT(strcmp(sc_asset_region_name(asset, 0), "left_arm") == 0);
  EXPECT(sc_asset_source_buffer(asset, 0).vertex_count == 4);
  EXPECT(sc_hash_positions(rest, vertex_count, 12) == info.source_rest_hash);
  OK(sc_check_source(asset, SC_WHOLE_SOURCE, rest, vertex_count, 12));
  EXPECT(strcmp(sc_code_text(SC_NULL), "null") == 0);
  EXPECT(strcmp(sc_field_name(SC_FIELD_BONES), "pose.bones") == 0);
  EXPECT(strcmp(sc_target_name(SC_TARGET_SCALAR), "scalar") == 0);
  EXPECT(sc_supported_targets(&count)[0] != SC_TARGET_BEST && count > 0);
}

static void call_crowd(const sc_asset* asset, const sc_pose* pose, c_calls_result* out) {
  sc_crowd_job crowd = {.struct_size = sizeof crowd};
  sc_scene_job scene = {0};
  sc_scene_body bodies[2] = {{0}, {0}};
  uint32_t pair_counts[1];
  const size_t word_count = sc_pair_words(asset), bit = 5 * (5 - 1) / 2 + 2; /* of spheres 2 and 5 */
  uint64_t* ignored_pairs = words(word_count);
  memcpy(ignored_pairs, sc_asset_get_info(asset).ignored_pairs, word_count * sizeof *ignored_pairs);
  ignored_pairs[bit / 64] |= (uint64_t)1 << bit % 64;
  OK(sc_ignore_parts(asset, ignored_pairs, 0, 1, 1));
  crowd.asset = asset;
  crowd.pose = *pose;
  crowd.instance_count = 1;
  crowd.ignored_pairs = ignored_pairs;
  crowd.scratch_words = sc_crowd_scratch_words(asset, 1);
  crowd.scratch = words(crowd.scratch_words);
  crowd.counts = pair_counts;
  crowd.count_capacity = 1;
  crowd.pairs = out->crowd_pairs;
  crowd.pair_capacity = C_CALLS_ROOM;
  OK(sc_detect_crowd(&crowd));
  out->crowd_pair_count = crowd.pair_count;
  scene.bodies = bodies; /* two boxes in one place */
  scene.body_count = 2;
  scene.scratch_words = sc_scene_scratch_words(2);
  scene.scratch = words(scene.scratch_words);
  OK(sc_find_meetings(&scene));
  EXPECT(scene.pair_count == 1);
  free(scene.scratch);
  free(crowd.scratch);
  free(ignored_pairs);
}

static void call_binding(const sc_asset* asset, const sc_pose* pose, c_calls_result* out) {
  sc_bone joints[64];
  uint32_t joint_of_bone[64];
  float* bones = (float*)words(12 * pose->bone_count);
  size_t b;
  for (b = 0; b < pose->bone_count; ++b) joints[b] = sc_asset_bone(asset, b);
  OK(sc_bind_joints(asset, joints, pose->bone_count, SC_ROWS_3X4, joint_of_bone, 64, NULL, 0));
  EXPECT(joint_of_bone[0] == 0 && joint_of_bone[pose->bone_count - 1] == SC_NO_JOINT);
  OK(sc_gather_bones(asset, joint_of_bone, pose, bones));
  EXPECT(memcmp(bones, pose->bones, 12 * sizeof(float)) == 0);
  {
    const sc_transform place = {{1, 0, 0}, {0, 0, 0, 1}, {1, 1, 1}};
    const float x = bones[3];
    OK(sc_place_bones(&place, bones, pose->bone_count));
    EXPECT(bones[3] == x + 1);
  }
  free(bones);
}

static void call_model_and_body(const void* data, size_t size, const sc_pose* pose, c_calls_result* out) {
  sc_model_def def = {.struct_size = sizeof def};
  sc_body_def body_def = {.struct_size = sizeof body_def};
  sc_query query = {.struct_size = sizeof query};
  sc_ground ground = {.struct_size = sizeof ground};
  sc_model* model = NULL;
  sc_body *body = NULL, *other = NULL;
  sc_contacts contacts;
  sc_penetrations found;
  sc_sphere_pairs spheres;
  const sc_step_contact* steps;
  size_t step_count;
  sc_vec3 low, high;
  sc_pose rest = *pose;
  float* rest_bones = (float*)words(12 * pose->bone_count);
  size_t b;
  EXPECT(sc_part_words(sc_get_asset(NULL)) == 0);
  def.data = data;
  def.size = size;
  body_def.finds_steps = 1;
  query.classes = ~0U;
  OK(sc_create_model(SC_ABI_VERSION, &def, &model, NULL, 0));
  OK(sc_create_body(model, &body_def, &body));
  OK(sc_create_body(model, NULL, &other));
  EXPECT(sc_asset_get_info(sc_get_asset(model)).sphere_count > 0);
  EXPECT(sc_check_rest(model, pose, NULL, 0).code == SC_OTHER_BIND);
  EXPECT(sc_get_part_joint(model, 0) == (uint32_t)sc_asset_part(sc_get_asset(model), 0).bone);
  EXPECT(sc_get_triangle(model, 0).part < sc_asset_get_info(sc_get_asset(model)).part_count);
  OK(sc_set_pose(body, pose, NULL));
  OK(sc_set_pose(other, pose, NULL));
  query.full = 1;
  OK(sc_find_contacts(body, NULL, &query, &contacts));
  memcpy(out->parts, contacts.parts, (out->part_count = contacts.part_count) * sizeof *out->parts);
  memcpy(out->triangles, contacts.triangles, (out->triangle_count = contacts.triangle_count) * sizeof *out->triangles);
  OK(sc_find_penetrations(body, NULL, &query, &found));
  EXPECT(found.count > 0 && found.total == found.count);
  EXPECT(sc_classify(NULL, &found.items[0].measures) == found.items[0].kind);
  EXPECT(strcmp(sc_penetration_class_name(SC_CLASS_FOLD), "fold") == 0);
  OK(sc_find_contacts(body, other, &query, &contacts));
  out->body_triangle_count = contacts.triangle_total;
  OK(sc_find_penetrations(body, other, &query, &found));
  out->body_part_count = found.total;
  OK(sc_find_sphere_pairs(body, NULL, &spheres));
  memcpy(out->spheres, spheres.spheres, spheres.sphere_count * sizeof *out->spheres);
  memcpy(out->pairs, spheres.pairs, (out->pair_count = spheres.count) * sizeof *out->pairs);
  ground.up.x = 1;
  ground.height = 100; /* all of it is below */
  OK(sc_find_in_ground(body, &ground, &query, &found));
  out->floor_part_count = found.total;
  OK(sc_get_bounds(body, &low, &high));
  EXPECT(low.x < high.x);
  for (b = 0; b < 12 * pose->bone_count; ++b) rest_bones[b] = b % 12 % 5 == 0 ? 1.0F : 0.0F;
  rest.bones = rest_bones;
  OK(sc_set_pose(body, &rest, NULL));
  OK(sc_find_steps(body, NULL, NULL, &steps, &step_count));
  memcpy(out->step_contacts, steps, (out->step_contact_count = step_count) * sizeof *out->step_contacts);
  free(rest_bones);
  sc_destroy_body(other);
  sc_destroy_body(body);
  sc_destroy_model(model);
}

void c_call_all(const void* data, size_t size, const float* matrices, size_t bone_count, const float* rest,
                size_t vertex_count, c_calls_result* out) {
  sc_asset asset;
  sc_pose pose = {0};
  pose.bones = matrices;
  pose.bone_count = bone_count;
  pose.bone_layout = SC_ROWS_3X4;
  OK(sc_asset_open(&asset, SC_ABI_VERSION, data, size, NULL, 0));
  call_accessors(&asset, rest, vertex_count, out);
  call_crowd(&asset, &pose, out);
  call_binding(&asset, &pose, out);
  call_model_and_body(data, size, &pose, out);
}

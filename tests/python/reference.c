/* SPDX-License-Identifier: MIT */
/* reference ASSET BONES: what the C interface answers, for a comparison bit by bit. BONES holds matrices of 3 by 4
 * floats, pose after pose. For each pose it writes to standard output the spheres; each after their number as 8 bytes,
 * the pairs of spheres, contacts of parts, spheres and triangles, all penetrations, the faults, what is below y = 0,
 * what is in the first pose, the touches on the way from there; and the bounds.
 * reference ASSET BONES PARENTS JOINTS: what a response makes of JOINTS, frame after frame, twice: alone, and with all
 * its options, beside another body in the first pose of BONES. For each frame it writes the joints, what is said of
 * them, and the rows after their number. */
#include <spherechain/spherechain.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { kMaxTriangles = 65536, kMaxPenetrations = 512 };

static void* read_file(const char* path, size_t* size) {
  FILE* file = fopen(path, "rb");
  if (file == NULL || fseek(file, 0, SEEK_END) != 0) {
    exit(3);
  }
  *size = (size_t)ftell(file);
  rewind(file);
  void* bytes = malloc(*size);
  if (bytes == NULL || fread(bytes, 1, *size, file) != *size) {
    exit(3);
  }
  fclose(file);
  return bytes;
}

static void require(sc_status status) {
  if (status.code != SC_OK) {
    fprintf(stderr, "%s: %s\n", sc_field_name(status.field), sc_code_text(status.code));
    exit(1);
  }
}

static void put(const void* entries, size_t size, size_t count) {
  const uint64_t number = count;
  fwrite(&number, sizeof number, 1, stdout);
  fwrite(entries, size, count, stdout);
}

static void respond(sc_body* body, const sc_body* other, const char* parents, const char* joints, int with_options) {
  size_t size, joints_size;
  sc_response_def def = {.struct_size = sizeof def};
  def.parents = read_file(parents, &size);
  def.joint_count = size / sizeof *def.parents;
  sc_transform* clip = read_file(joints, &joints_size);
  const size_t frame_size = def.joint_count * sizeof *clip, frames = joints_size / frame_size;
  sc_response* response;
  require(sc_create_response(body, &def, &response));
  sc_transform* own = malloc(frame_size);
  const sc_transform place = {{0.25f, 0.5f, 0}, {0, 0.6f, 0, 0.8f}, {1, 1, 1}};
  const sc_ground ground = {.struct_size = sizeof ground, .up = {0, 1, 0}, .height = 0.75f};
  const uint32_t planted = 2;
  uint64_t state[SC_RESPONSE_WORDS] = {0};
  for (size_t i = 0; i < frames; ++i) {
    memcpy(own, clip + i * def.joint_count, frame_size);
    sc_response_frame frame = {.struct_size = sizeof frame};
    frame.joints = own;
    frame.seconds = 1.0f / 32;
    if (with_options) {
      frame.place = &place;
      frame.weakness = 0.25f;
      frame.rounds = 2;
      frame.ahead = clip + (i + 1 < frames ? i + 1 : i) * def.joint_count;
      frame.ahead_frames = 1;
      frame.others = &other;
      frame.other_count = 1;
      frame.ground = &ground;
      frame.planted = &planted;
      frame.planted_count = 1;
    }
    require(sc_respond(response, state, &frame));
    fwrite(own, frame_size, 1, stdout);
    fwrite(&frame.turned, sizeof frame.turned, 1, stdout);
    fwrite(&frame.at_budget, sizeof frame.at_budget, 1, stdout);
    fwrite(&frame.remaining, sizeof frame.remaining, 1, stdout);
    put(frame.rows, sizeof *frame.rows, frame.row_count);
  }
  fwrite(state, sizeof state, 1, stdout);
  sc_destroy_response(response);
}

int main(int argc, char** argv) {
  if (argc != 3 && argc != 5) {
    return 2;
  }
  size_t size, bones_size;
  void* data = read_file(argv[1], &size);
  float* bones = read_file(argv[2], &bones_size);
  sc_model_def def = {.struct_size = sizeof def};
  def.data = data;
  def.size = size;
  sc_model* model;
  require(sc_create_model(SC_ABI_VERSION, &def, &model, NULL, 0));
  const sc_asset_info info = sc_asset_get_info(sc_get_asset(model));
  sc_body_def body_def = {.struct_size = sizeof body_def};
  body_def.max_triangles = kMaxTriangles;
  body_def.max_penetrations = kMaxPenetrations;
  body_def.finds_steps = 1;
  sc_body *body, *other;
  require(sc_create_body(model, &body_def, &body));
  require(sc_create_body(model, &body_def, &other));
  const size_t floats = 12 * info.bone_count, poses = bones_size / (floats * sizeof(float));
  if (argc == 5) {
    sc_pose pose = {0};
    pose.bones = bones;
    pose.bone_count = info.bone_count;
    pose.bone_layout = SC_ROWS_3X4;
    require(sc_set_pose(other, &pose, NULL));
    respond(body, other, argv[3], argv[4], 0);
    respond(body, other, argv[3], argv[4], 1);
    return 0;
  }
  sc_query query = {.struct_size = sizeof query};
  query.full = 1;
  query.classes = ~0U;
  for (size_t i = 0; i < poses; ++i) {
    sc_pose pose = {0};
    pose.bones = bones + i * floats;
    pose.bone_count = info.bone_count;
    pose.bone_layout = SC_ROWS_3X4;
    require(sc_set_pose(body, &pose, NULL));

    sc_sphere_pairs spheres;
    require(sc_find_sphere_pairs(body, NULL, &spheres));
    fwrite(spheres.spheres, sizeof *spheres.spheres, spheres.sphere_count, stdout);
    put(spheres.pairs, sizeof *spheres.pairs, spheres.count);

    sc_contacts contacts;
    require(sc_find_contacts(body, NULL, &query, &contacts));
    put(contacts.parts, sizeof *contacts.parts, contacts.part_count);
    put(contacts.spheres, sizeof *contacts.spheres, contacts.sphere_count);
    put(contacts.triangles, sizeof *contacts.triangles, contacts.triangle_count);

    sc_penetrations found;
    require(sc_find_penetrations(body, NULL, &query, &found));
    put(found.items, sizeof *found.items, found.count);
    require(sc_find_penetrations(body, NULL, NULL, &found));
    put(found.items, sizeof *found.items, found.count);

    sc_ground ground = {.struct_size = sizeof ground, .up = {0, 1, 0}};
    require(sc_find_in_ground(body, &ground, &query, &found));
    put(found.items, sizeof *found.items, found.count);

    /* Another body in the first pose, and the way from there to this pose. */
    pose.bones = bones;
    require(sc_set_pose(other, &pose, NULL));
    require(sc_find_penetrations(body, other, &query, &found));
    put(found.items, sizeof *found.items, found.count);
    pose.bones = bones + i * floats;
    require(sc_set_pose(other, &pose, NULL));
    const sc_step_contact* steps;
    size_t step_count;
    require(sc_find_steps(other, NULL, NULL, &steps, &step_count));
    put(steps, sizeof *steps, step_count);
    sc_vec3 box[2];
    require(sc_get_bounds(body, &box[0], &box[1]));
    fwrite(box, sizeof box, 1, stdout);
  }
  return 0;
}

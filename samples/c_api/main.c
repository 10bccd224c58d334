/* SPDX-License-Identifier: MIT */
/* c_api ASSET.sphc MODEL.glb: which body parts are inside each other, in C99. */
#include <stdio.h>
#include <stdlib.h>

#include "gltf_pose_c.h"
#include "spherechain/spherechain.h"

/* The whole file, or null. */
static void* read_file(const char* path, size_t* size) {
  FILE* const file = fopen(path, "rb");
  char* bytes = NULL;
  long length = -1;
  if (file == NULL) {
    return NULL;
  }
  if (fseek(file, 0, SEEK_END) == 0) {
    length = ftell(file);
  }
  rewind(file);
  if (length > 0) {
    *size = (size_t)length;
    bytes = malloc(*size);
    if (bytes != NULL && fread(bytes, 1, *size, file) != *size) {
      free(bytes);
      bytes = NULL;
    }
  }
  fclose(file);
  return bytes;
}

/* Plays the file's clip at 30 frames a second. */
static sc_status play(const sc_model* model, sc_body* body, gltf_character* file) {
  const sc_asset* const asset = sc_get_asset(model);
  const double metres = sc_asset_get_info(asset).metres_per_unit;
  sc_penetrations found;
  sc_status status = {SC_OK, SC_FIELD_NONE};
  sc_pose pose = {0};
  const sc_bone* const joints = gltf_joints(file, &pose.bone_count);
  size_t i;
  int frame;
  pose.bone_layout = SC_COLUMNS_4X4;
  for (frame = 0; frame <= 30 * gltf_duration(file) && status.code == SC_OK; ++frame) {
    pose.bones = gltf_palette(file, frame / 30.0);
    status = sc_set_pose(body, &pose, NULL);
    if (status.code == SC_OK) {
      status = sc_find_penetrations(body, NULL, NULL, &found);
    }
    for (i = 0; status.code == SC_OK && i < found.count; ++i) {
      const sc_penetration* const p = &found.items[i];
      printf("frame %d: %s in %s, %.0f mm; move %s by (%.3f, %.3f, %.3f)\n", frame,
             sc_asset_part(asset, p->part).name, sc_asset_part(asset, p->other).name,
             1000.0 * metres * p->measures.depth, p->joint == SC_NO_JOINT ? "nothing" : joints[p->joint].name,
             (double)(p->distance * p->direction.x), (double)(p->distance * p->direction.y),
             (double)(p->distance * p->direction.z));
    }
  }
  return status;
}

int main(int argc, char** argv) {
  char message[256];
  sc_model_def def = {.struct_size = sizeof def};
  sc_model* model = NULL;
  sc_body* body = NULL;
  gltf_character* file;
  sc_status status;
  void* bytes;

  if (argc != 3) {
    fputs("usage: c_api ASSET.sphc MODEL.glb\n", stderr);
    return 2;
  }
  bytes = read_file(argv[1], &def.size);
  if (bytes == NULL) {
    fprintf(stderr, "c_api: error: %s: cannot be read\n", argv[1]);
    return 3;
  }
  file = gltf_open(argv[2], message, sizeof message);
  if (file == NULL) {
    fprintf(stderr, "c_api: error: %s\n", message);
    free(bytes);
    return 3;
  }
  def.data = bytes;
  def.joints = gltf_joints(file, &def.joint_count);
  def.inverse_bind_layout = SC_COLUMNS_4X4;
  status = sc_create_model(SC_ABI_VERSION, &def, &model, message, sizeof message);
  free(bytes); /* the model has a copy */
  if (status.code != SC_OK) {
    fprintf(stderr, "c_api: error: %s: %s\n", argv[1], message);
  } else {
    status = sc_create_body(model, NULL, &body);
    if (status.code == SC_OK) {
      status = play(model, body, file);
    }
    if (status.code != SC_OK) {
      fprintf(stderr, "c_api: error: %s: %s\n", sc_field_name(status.field), sc_code_text(status.code));
    }
  }
  sc_destroy_body(body);
  sc_destroy_model(model);
  gltf_close(file);
  return status.code == SC_OK ? 0 : 3;
}

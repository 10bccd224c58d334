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

/* Plays the model's clip at 30 frames a second. */
static sc_status play(sc_character* character, gltf_character* model) {
  const sc_asset* const asset = sc_character_asset(character);
  const sc_part_contact* contacts = NULL;
  sc_status status = {SC_OK, SC_FIELD_NONE};
  size_t count = 0, i;
  sc_pose pose = {0};
  int frame;
  gltf_joints(model, &pose.bone_count);
  pose.bone_layout = SC_COLUMNS_4X4;
  for (frame = 0; frame <= 30 * gltf_duration(model) && status.code == SC_OK; ++frame) {
    pose.bones = gltf_palette(model, frame / 30.0);
    status = sc_character_contacts(character, &pose, &contacts, &count);
    for (i = 0; i < count; ++i) {
      printf("frame %d: %s in %s\n", frame, sc_asset_part(asset, contacts[i].part_a).name,
             sc_asset_part(asset, contacts[i].part_b).name);
    }
  }
  return status;
}

int main(int argc, char** argv) {
  char message[256];
  sc_character* character = NULL;
  gltf_character* model;
  const sc_bone* joints;
  size_t size = 0, joint_count = 0;
  sc_status status;
  void* bytes;

  if (argc != 3) {
    fputs("usage: c_api ASSET.sphc MODEL.glb\n", stderr);
    return 2;
  }
  bytes = read_file(argv[1], &size);
  if (bytes == NULL) {
    fprintf(stderr, "c_api: error: %s: cannot be read\n", argv[1]);
    return 3;
  }
  model = gltf_open(argv[2], message, sizeof message);
  if (model == NULL) {
    fprintf(stderr, "c_api: error: %s\n", message);
    free(bytes);
    return 3;
  }
  joints = gltf_joints(model, &joint_count);
  status = sc_character_create(SC_ABI_VERSION, bytes, size, joints, joint_count, SC_COLUMNS_4X4, &character, message,
                               sizeof message);
  free(bytes); /* the character has a copy */
  if (status.code != SC_OK) {
    fprintf(stderr, "c_api: error: %s: %s\n", argv[1], message);
  } else {
    status = play(character, model);
    if (status.code != SC_OK) {
      fprintf(stderr, "c_api: error: %s: %s\n", sc_field_name(status.field), sc_code_text(status.code));
    }
  }
  sc_character_destroy(character);
  gltf_close(model);
  return status.code == SC_OK ? 0 : 3;
}

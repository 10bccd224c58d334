/* SPDX-License-Identifier: MIT */
/* A game in C: from bones to pairs of spheres, and to pairs of body parts whose skins intersect. */
#include <spherechain/spherechain.h>
#include <stdio.h>
#include <stdlib.h>

static void* read_file(const char* path, size_t* size) {
  FILE* file = fopen(path, "rb");
  void* bytes = NULL;
  *size = 0;
  if (file != NULL && fseek(file, 0, SEEK_END) == 0) {
    const long length = ftell(file);
    rewind(file);
    bytes = malloc((size_t)length);
    *size = fread(bytes, 1, (size_t)length, file);
  }
  if (file != NULL) {
    fclose(file);
  }
  return bytes;
}

int main(int argc, char** argv) {
  size_t size = 0, i, part_count;
  void* bytes = read_file(argc > 1 ? argv[1] : "", &size);
  sc_character* character = NULL;
  const sc_asset* asset;
  const sc_part_contact* parts;
  sc_asset_info info;
  sc_pose pose = {0};
  sc_refit_job refit = {0};
  sc_detect_job detect = {0};
  sc_sphere* spheres;
  float* matrices;
  char message[160];
  if (sc_character_create(SC_ABI_VERSION, bytes, size, NULL, 0, SC_LAYOUT_UNSET, &character, message, sizeof message)
          .code != SC_OK) {
    fprintf(stderr, "stranger_c: %s\n", message);
    return 3;
  }
  asset = sc_character_asset(character);
  info = sc_asset_get_info(asset);
  spheres = calloc(info.sphere_count, sizeof *spheres);
  matrices = calloc(info.bone_count, 12 * sizeof *matrices);
  for (i = 0; i < info.bone_count; ++i) {
    matrices[12 * i] = matrices[12 * i + 5] = matrices[12 * i + 10] = 1.0F;
  }
  pose.bones = matrices;
  pose.bone_count = info.bone_count;
  pose.bone_layout = SC_ROWS_3X4;
  refit.asset = detect.asset = asset;
  refit.pose = pose;
  refit.spheres = spheres;
  detect.spheres = spheres;
  refit.sphere_capacity = detect.sphere_count = info.sphere_count;
  if (sc_refit(&refit).code != SC_OK || sc_detect(&detect).code != SC_OK) {
    return 1;
  }
  for (i = 0; i < info.bone_count; ++i) { /* pull the body apart */
    matrices[12 * i + 3] = 0.5F * (float)i;
  }
  if (sc_character_contacts(character, &pose, &parts, &part_count).code != SC_OK) {
    return 1;
  }
  printf("%zu spheres, %zu pairs, %zu pairs of body parts\n", info.sphere_count, detect.pair_count, part_count);
  sc_character_destroy(character);
  free(matrices);
  free(spheres);
  free(bytes);
  return 0;
}

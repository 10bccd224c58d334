/* SPDX-License-Identifier: MIT */
/* The same road in C: bones to pairs. */
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
  size_t size = 0, i, bone_count;
  void* bytes = read_file(argc > 1 ? argv[1] : "", &size);
  void* memory = malloc(sc_asset_size());
  const sc_asset* asset = NULL;
  sc_asset_info info;
  sc_refit_bones_job refit = SC_REFIT_BONES_JOB_INIT;
  sc_detect_job detect = SC_DETECT_JOB_INIT;
  sc_sphere* spheres;
  float* matrices;
  char message[160];
  if (sc_asset_open(SC_ABI_VERSION, memory, sc_asset_size(), bytes, size, &asset, message, sizeof message) != SC_OK) {
    fprintf(stderr, "stranger_c: %s\n", message);
    return 3;
  }
  info.struct_size = sizeof info;
  if (sc_asset_get_info(asset, &info) != SC_OK) {
    return 1;
  }
  bone_count = info.bone_count;
  spheres = calloc(info.sphere_count, sizeof *spheres);
  matrices = calloc(bone_count + 1, 12 * sizeof *matrices);
  for (i = 0; i < bone_count; ++i) {
    matrices[12 * i] = matrices[12 * i + 5] = matrices[12 * i + 10] = 1.0F;
  }
  refit.asset = detect.asset = asset;
  refit.bones.data = matrices;
  refit.bones.count = bone_count;
  refit.spheres = spheres;
  detect.spheres = spheres;
  refit.sphere_count = detect.sphere_count = info.sphere_count;
  if (sc_refit_bones(&refit) != SC_OK || sc_detect(&detect) != SC_OK) {
    return 1;
  }
  printf("%zu spheres, %zu pairs\n", info.sphere_count, detect.pair_count);
  free(matrices);
  free(spheres);
  free(memory);
  free(bytes);
  return 0;
}

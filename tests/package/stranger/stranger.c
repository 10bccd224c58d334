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
  sc_model_def def = {.struct_size = sizeof def};
  void* bytes = read_file(argc > 1 ? argv[1] : "", &def.size);
  sc_model* model = NULL;
  sc_body* body = NULL;
  sc_sphere_pairs spheres;
  sc_contacts contacts;
  sc_asset_info info;
  sc_pose pose = {0};
  size_t i, sphere_pair_count;
  float* matrices;
  char message[160] = "out of memory";
  def.data = bytes;
  if (sc_create_model(SC_ABI_VERSION, &def, &model, message, sizeof message).code != SC_OK ||
      sc_create_body(model, NULL, &body).code != SC_OK) {
    fprintf(stderr, "stranger_c: %s\n", message);
    return 3;
  }
  info = sc_asset_get_info(sc_get_asset(model));
  matrices = calloc(info.bone_count, 12 * sizeof *matrices);
  for (i = 0; i < info.bone_count; ++i) {
    matrices[12 * i] = matrices[12 * i + 5] = matrices[12 * i + 10] = 1.0F;
  }
  pose.bones = matrices;
  pose.bone_count = info.bone_count;
  pose.bone_layout = SC_ROWS_3X4;
  if (sc_set_pose(body, &pose, NULL).code != SC_OK || sc_find_sphere_pairs(body, NULL, &spheres).code != SC_OK) {
    return 1;
  }
  sphere_pair_count = spheres.total;
  for (i = 0; i < info.bone_count; ++i) { /* pull the body apart */
    matrices[12 * i + 3] = 0.5F * (float)i;
  }
  if (sc_set_pose(body, &pose, NULL).code != SC_OK || sc_find_contacts(body, NULL, NULL, &contacts).code != SC_OK) {
    return 1;
  }
  printf("%zu spheres, %zu pairs, %zu pairs of body parts\n", info.sphere_count, sphere_pair_count,
         contacts.part_count);
  sc_destroy_body(body);
  sc_destroy_model(model);
  free(matrices);
  free(bytes);
  return 0;
}

/* SPDX-License-Identifier: MIT */
/* What a game links: from a palette to contacts by body part, and nothing else. */
#include <spherechain/body.h>
#include <stdio.h>

static uint64_t bytes[1 << 16];
static float matrices[12 * 64];

int main(int argc, char** argv) {
  FILE* file = fopen(argc > 1 ? argv[1] : "", "rb");
  sc_model_def def = {.struct_size = sizeof def};
  sc_model* model = NULL;
  sc_body* body = NULL;
  sc_contacts found;
  sc_pose pose = {0};
  size_t i;
  char message[160] = "cannot be read";
  if (file != NULL) {
    def.size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
  }
  def.data = bytes;
  if (sc_create_model(SC_ABI_VERSION, &def, &model, message, sizeof message).code != SC_OK) {
    fprintf(stderr, "%s\n", message);
    return 3;
  }
  pose.bones = matrices;
  pose.bone_count = sizeof matrices / (12 * sizeof *matrices);
  pose.bone_layout = SC_ROWS_3X4;
  for (i = 0; i < pose.bone_count; ++i) {
    matrices[12 * i] = matrices[12 * i + 5] = matrices[12 * i + 10] = 1.0F;
    matrices[12 * i + 3] = 0.5F * (float)i;
  }
  if (sc_create_body(model, NULL, &body).code != SC_OK || sc_set_pose(body, &pose, NULL).code != SC_OK ||
      sc_find_contacts(body, NULL, NULL, &found).code != SC_OK) {
    return 1;
  }
  printf("%zu pairs of body parts\n", found.part_count);
  sc_destroy_body(body);
  sc_destroy_model(model);
  return 0;
}

/* SPDX-License-Identifier: MIT */
/* What a game links: from a palette to contacts by body part, and nothing else. */
#include <spherechain/character.h>
#include <stdio.h>

static uint64_t bytes[1 << 16];
static float matrices[12 * 64];

int main(int argc, char** argv) {
  FILE* file = fopen(argc > 1 ? argv[1] : "", "rb");
  sc_character* character = NULL;
  const sc_part_contact* parts;
  sc_pose pose = {0};
  size_t size = 0, i, count;
  char message[160] = "cannot be read";
  if (file != NULL) {
    size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
  }
  if (sc_character_create(SC_ABI_VERSION, bytes, size, NULL, 0, SC_LAYOUT_UNSET, &character, message, sizeof message)
          .code != SC_OK) {
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
  if (sc_character_contacts(character, &pose, &parts, &count).code != SC_OK) {
    return 1;
  }
  printf("%zu pairs of body parts\n", count);
  sc_character_destroy(character);
  return 0;
}

/* SPDX-License-Identifier: MIT */
/* c_api ASSET: bones to contacts in C99, with a filter edited at run time. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "spherechain/spherechain.h"

static int fail(const char* file, const char* what) {
  fprintf(stderr, "c_api: error: %s: %s\n", file, what);
  return 3;
}

/* The file's bytes, or null. */
static void* read_file(const char* path, size_t* size) {
  FILE* file = fopen(path, "rb");
  char* bytes = NULL;
  size_t capacity = 0, got = 1;
  *size = 0;
  while (file != NULL && got > 0) {
    if (*size == capacity) {
      capacity = 2 * capacity + 65536;
      bytes = realloc(bytes, capacity);
      if (bytes == NULL) {
        break;
      }
    }
    got = fread(bytes + *size, 1, capacity - *size, file);
    *size += got;
  }
  if (file != NULL) {
    fclose(file);
  }
  return bytes;
}

/* Stands for your animation: what hangs on the left upper arm turns about the character's forward axis through the
 * shoulder. `palette`: a matrix a bone, rows of 3 by 4. */
static void swing_left_arm(const sc_asset* asset, const sc_asset_info* info, float angle, float* palette) {
  const float x = info->forward.x, y = info->forward.y, z = info->forward.z;
  const float c = cosf(angle), s = sinf(angle), t = 1.0F - c;
  const float turned[9] = {c + t * x * x,     t * x * y - s * z, t * x * z + s * y, /* row by row */
                           t * x * y + s * z, c + t * y * y,     t * y * z - s * x, /* */
                           t * x * z - s * y, t * y * z + s * x, c + t * z * z};
  const float still[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  int* is_arm = calloc(info->bone_count, sizeof *is_arm);
  float about[3] = {0, 0, 0};
  size_t i, row;
  for (i = 0; is_arm != NULL && i < info->bone_count; ++i) {
    sc_joint joint = {NULL, -1, {0, 0, 0}, {0, 0, 0}};
    const float* r = still;
    if (sc_asset_joint(asset, i, &joint) == SC_OK) { /* a rest bone is no joint */
      const int is_shoulder = strcmp(joint.name, "left_shoulder") == 0;
      is_arm[i] = is_shoulder || (joint.parent >= 0 && is_arm[joint.parent]);
      if (is_shoulder) {
        about[0] = joint.position.x;
        about[1] = joint.position.y;
        about[2] = joint.position.z;
      }
      r = is_arm[i] ? turned : still;
    }
    for (row = 0; row < 3; ++row) {
      float* m = palette + 12 * i + 4 * row;
      memcpy(m, r + 3 * row, 3 * sizeof *m);
      m[3] = about[row] - (m[0] * about[0] + m[1] * about[1] + m[2] * about[2]);
    }
  }
  free(is_arm);
}

int main(int argc, char** argv) {
  enum { kPairs = 256 };
  size_t size = 0, sphere_count = 0;
  void *bytes, *memory;
  const sc_asset* asset = NULL;
  const sc_rest_sphere* rest;
  sc_asset_info info;
  sc_region region_a, region_b;
  sc_sphere* spheres;
  float* palette;
  uint64_t* ignored;
  sc_pair pairs[kPairs];
  sc_contact contacts[kPairs];
  sc_refit_bones_job refit = SC_REFIT_BONES_JOB_INIT;
  sc_detect_job detect = SC_DETECT_JOB_INIT;
  sc_confirm_job confirm = SC_CONFIRM_JOB_INIT;
  sc_contact_job contact = SC_CONTACT_JOB_INIT;
  uint64_t* scratch;
  sc_pair skins[kPairs];
  sc_filter filter = {NULL, 0, NULL, 0, NULL, 0};
  sc_status status;
  char message[160];

  if (argc != 2) {
    fputs("usage: c_api ASSET.sphc\n", stderr);
    return 2;
  }
  bytes = read_file(argv[1], &size);
  if (bytes == NULL) {
    return fail(argv[1], "cannot be read");
  }

  /* All memory is yours: ask for the sizes, then give it. */
  memory = malloc(sc_asset_size());
  if (sc_asset_open(SC_ABI_VERSION, memory, sc_asset_size(), bytes, size, &asset, message, sizeof message) != SC_OK) {
    return fail(argv[1], message);
  }
  info.struct_size = sizeof info;
  if (sc_asset_get_info(asset, &info) != SC_OK || info.joint_count == 0 || info.bone_count < info.joint_count) {
    return fail(argv[1], "has no automatic rig");
  }
  rest = sc_asset_spheres(asset, &sphere_count);
  spheres = malloc(sphere_count * sizeof *spheres);
  palette = malloc(info.bone_count * 12 * sizeof *palette);
  filter.ignored_words = sc_filter_ignored_words(asset);
  ignored = malloc(filter.ignored_words * sizeof *ignored);
  filter.ignored = ignored;
  if (spheres == NULL || palette == NULL || ignored == NULL) {
    return fail(argv[1], "no memory");
  }

  swing_left_arm(asset, &info, -0.8F, palette);
  refit.asset = asset;
  refit.bones.data = palette;
  refit.bones.count = info.bone_count;
  refit.spheres = spheres;
  refit.sphere_count = sphere_count;
  status = sc_refit_bones(&refit);

  detect.asset = asset;
  detect.spheres = spheres;
  detect.sphere_count = sphere_count;
  detect.pairs = pairs;
  detect.pair_capacity = kPairs;
  status = status == SC_OK ? sc_detect(&detect) : status;

  /* Spheres touch before skins do: those that the triangles confirm, where the asset has them. */
  confirm.asset = asset;
  confirm.bones = refit.bones;
  confirm.candidates = pairs;
  confirm.candidate_count = detect.pair_count;
  confirm.pairs = skins;
  confirm.pair_capacity = kPairs;
  confirm.scratch_words = sc_triangle_contact_scratch_words(asset);
  confirm.scratch = scratch = malloc(confirm.scratch_words * sizeof *scratch);
  if (status == SC_OK && scratch != NULL && confirm.scratch_words > 0) {
    status = sc_confirm(&confirm);
  }

  contact.asset = asset;
  contact.spheres = spheres;
  contact.sphere_count = sphere_count;
  contact.pairs = pairs;
  contact.pair_count = detect.pair_count;
  contact.contacts = contacts;
  contact.contact_capacity = kPairs;
  status = status == SC_OK ? sc_contacts(&contact) : status;
  if (status != SC_OK) {
    return fail(argv[1], sc_status_string(status));
  }
  printf("%lu pairs touch\n", (unsigned long)detect.pair_count);
  printf("%lu of them with their skin\n", (unsigned long)confirm.pair_count);
  if (contact.deepest < contact.contact_count) {
    const sc_contact* deepest = &contacts[contact.deepest];
    printf("deepest: spheres %lu and %lu, %.1f %% of the height\n", (unsigned long)deepest->pair.a,
           (unsigned long)deepest->pair.b, 100.0 * (double)(deepest->depth / info.height));

    /* A game that wants to hear nothing of these two regions says so, in its own copy of the asset's table. */
    status = sc_reset_filter(asset, &filter);
    status = status == SC_OK
                 ? sc_ignore_regions(asset, &filter, rest[deepest->pair.a].region, rest[deepest->pair.b].region, 1)
                 : status;
    detect.filter = &filter;
    detect.pairs = NULL; /* counts */
    detect.pair_capacity = 0;
    status = status == SC_OK ? sc_detect(&detect) : status;
    status = status == SC_OK ? sc_asset_region(asset, rest[deepest->pair.a].region, &region_a) : status;
    status = status == SC_OK ? sc_asset_region(asset, rest[deepest->pair.b].region, &region_b) : status;
    if (status == SC_OK) {
      printf("%s and %s ignored: %lu pairs\n", region_a.name, region_b.name, (unsigned long)detect.pair_count);
    }
  }
  free(scratch);
  free(ignored);
  free(palette);
  free(spheres);
  free(memory);
  free(bytes);
  return status == SC_OK ? 0 : 1;
}

/* SPDX-License-Identifier: MIT */
/* reference ASSET BONES: what the C interface answers, for a comparison bit by bit. BONES holds matrices of 3 by 4 floats,
 * pose after pose. Of each pose it writes to standard output the spheres, then, each after their number as 8 bytes, the
 * pairs of spheres, the pairs of triangles and the penetrations. */
#include <spherechain/spherechain.h>
#include <stdio.h>
#include <stdlib.h>

enum { kMaxPairs = 4096, kMaxTriangles = 65536, kMaxPenetrations = 512 };

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

int main(int argc, char** argv) {
  if (argc != 3) {
    return 2;
  }
  size_t size, bones_size;
  void* data = read_file(argv[1], &size);
  float* bones = read_file(argv[2], &bones_size);
  sc_asset asset = {{0}};
  require(sc_asset_open(&asset, SC_ABI_VERSION, data, size, NULL, 0));
  const sc_asset_info info = sc_asset_get_info(&asset);
  const size_t floats = 12 * info.bone_count, poses = bones_size / (floats * sizeof(float));
  sc_sphere* spheres = calloc(info.sphere_count, sizeof *spheres);
  sc_pair* pairs = calloc(kMaxPairs, sizeof *pairs);
  sc_triangle_contact* triangles = calloc(kMaxTriangles, sizeof *triangles);
  sc_penetration* penetrations = calloc(kMaxPenetrations, sizeof *penetrations);
  const size_t words = sc_skin_scratch_words(&asset), depth_words = sc_penetration_scratch_words(&asset, kMaxTriangles);
  const size_t table_words = sc_skin_table_words(&asset);
  uint64_t* scratch = calloc(words + depth_words + table_words, sizeof *scratch);
  uint64_t* table = scratch + words + depth_words;
  require(sc_prepare_skin(&asset, table, table_words));
  for (size_t i = 0; i < poses; ++i) {
    sc_pose pose = {0};
    pose.bones = bones + i * floats;
    pose.bone_count = info.bone_count;
    pose.bone_layout = SC_ROWS_3X4;

    sc_refit_job refit = {0};
    refit.asset = &asset;
    refit.pose = pose;
    refit.spheres = spheres;
    refit.sphere_capacity = info.sphere_count;
    require(sc_refit(&refit));
    fwrite(spheres, sizeof *spheres, info.sphere_count, stdout);

    sc_detect_job detect = {0};
    detect.asset = &asset;
    detect.spheres = spheres;
    detect.sphere_count = info.sphere_count;
    detect.pairs = pairs;
    detect.pair_capacity = kMaxPairs;
    require(sc_detect(&detect));
    put(pairs, sizeof *pairs, detect.pair_count);

    sc_skin_contact_job skin = {0};
    skin.asset = &asset;
    skin.pose = pose;
    skin.skin_table = table;
    skin.scratch = scratch;
    skin.scratch_words = words;
    skin.triangles = triangles;
    skin.triangle_capacity = kMaxTriangles;
    require(sc_find_skin_contacts(&skin));
    put(triangles, sizeof *triangles, skin.triangle_count);

    sc_penetration_job depth = {0};
    depth.asset = &asset;
    depth.pose = pose;
    depth.skin_table = table;
    depth.contacts = triangles;
    depth.contact_count = skin.triangle_count;
    depth.scratch = scratch + words;
    depth.scratch_words = depth_words;
    depth.penetrations = penetrations;
    depth.penetration_capacity = kMaxPenetrations;
    require(sc_measure_penetrations(&depth));
    put(penetrations, sizeof *penetrations, depth.penetration_count);
  }
  return 0;
}

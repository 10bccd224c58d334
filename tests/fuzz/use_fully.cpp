// SPDX-License-Identifier: MIT
#include "use_fully.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "jobs.h"
#include "tiny_asset.h"

namespace spherechain::test {
namespace {

constexpr std::size_t kMaxVertexCount = std::size_t{1} << 20, kMaxTableWords = std::size_t{1} << 21;
constexpr std::size_t kMaxTossed = 2000;  // vertices: of more, skins that lie about at random touch too often

volatile std::size_t sink;  // so that no read is optimized away

void read(const char* text) { sink = sink + std::strlen(text); }

template <typename T>
void read(const T* data, std::size_t count) {
  std::size_t sum = 0;
  for (std::size_t i = 0; i < count * sizeof(T); ++i) {
    sum += reinterpret_cast<const unsigned char*>(data)[i];
  }
  sink = sink + sum;
}

void read_all(const Asset& asset) {
  const AssetInfo info = sc_asset_get_info(&asset);
  for (const char* text : {info.writer, info.settings, info.settings_sha256, info.source_file, info.source_sha256}) {
    read(text);
  }
  for (std::size_t i = 0; i < info.sphere_count; ++i)
    read(sc_asset_region_name(&asset, sc_asset_sphere(&asset, i).region));
  for (std::size_t i = 0; i < info.bone_count; ++i) {
    const Bone bone = sc_asset_bone(&asset, i);
    read(bone.name);
    read(bone.inverse_bind, 12);
  }
  for (std::size_t i = 0; i < info.part_count; ++i) read(sc_asset_part(&asset, i).name);
  for (std::size_t i = 0; i < info.morph_count; ++i) read(sc_asset_morph_name(&asset, i));
  for (std::size_t i = 0; i < info.source_buffer_count; ++i) {
    sink = sink + sc_asset_source_buffer(&asset, i).vertex_count;
  }
  // Tables that only this repository reads: the paper's chains, the automatic rig, the pivots.
  const AssetView& view = view_of(asset);
  read(view.pivots().data, view.pivots().size);
  for (std::size_t i = 0; i < view.chain_count(); ++i) {
    const ChainView chain = view.chain(i);
    read(chain.name);
    read(chain.regions.data, chain.regions.size);
    for (const std::uint32_t sphere : chain.spheres) read(&view.spheres()[sphere], 1);
  }
  for (std::size_t i = 0; i < view.joint_count(); ++i) read(view.joint(i).name);
}

bool broken(const char* what) {
  std::fprintf(stderr, "fuzz_asset: %s\n", what);
  return false;
}

bool detect_both_radii(const Asset& asset, const std::vector<Sphere>& spheres) {
  for (const Radius radius : {SC_RADIUS_FIT, SC_RADIUS_DETECT}) {
    const Detected found = detect(asset, spheres, radius);
    if (found.status != SC_OK) return broken("a detect job failed");
    for (const Pair& pair : found.pairs) {
      if (pair.a >= pair.b || pair.b >= spheres.size()) return broken("a pair of spheres that do not exist");
    }
  }
  return true;
}

// In the rest pose answers are of the body's size, whatever figures the asset has been given.
bool are_sane(const Asset& asset, const std::vector<Sphere>& spheres) {
  constexpr double kFar = 1e5;  // heights
  const AssetInfo info = sc_asset_get_info(&asset);
  const double limit = kFar * double{info.height};
  const double origin[3] = {double{info.origin.x}, double{info.origin.y}, double{info.origin.z}};
  return std::all_of(spheres.begin(), spheres.end(), [&](const Sphere& s) {
    return std::abs(double{s.x} - origin[0]) <= limit && std::abs(double{s.y} - origin[1]) <= limit &&
           std::abs(double{s.z} - origin[2]) <= limit && double{s.radius} >= 0 && double{s.radius} <= limit;
  });
}

bool refit_and_detect(const Asset& asset, const Pose& pose, bool is_sane) {
  for (const Radius radius : {SC_RADIUS_FIT, SC_RADIUS_DETECT}) {
    const Refitted refitted = refit(asset, pose, radius);
    const bool has_moments = view_of(asset).refit_rule() == RefitRule::kMoments;
    if (pose.bones != nullptr && !has_moments) return true;
    if (refitted.status != SC_OK) return broken("a refit job failed");
    if (is_sane && !are_sane(asset, refitted.spheres)) return broken("spheres at rest are not of the body's size");
    if (!detect_both_radii(asset, refitted.spheres)) return false;
  }
  return true;
}

bool find_all_contacts(const Asset& asset, const Pose& pose) {
  const std::size_t triangle_count = sc_asset_get_info(&asset).triangle_count, parts = view_of(asset).part_count();
  SkinContactJob job;
  job.asset = &asset;
  job.pose = pose;
  job.scope = SC_SCOPE_ALL;
  const SkinContacts found = find_contacts(job);
  if (found.status != SC_OK) return broken("a skin contact job failed");
  for (const TriangleContact& contact : found.triangles) {
    // A changed asset may have a triangle twice.
    if (contact.triangle_a > contact.triangle_b || contact.triangle_b >= triangle_count) {
      return broken("triangles that do not exist");
    }
  }
  for (const PartContact& contact : found.parts) {
    if (contact.part_a > contact.part_b || contact.part_b >= parts) return broken("parts that do not exist");
  }
  return true;
}

std::vector<float> tossed(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<float> figures(count);
  std::generate(figures.begin(), figures.end(), [&] { return uniform(random, -1, 1); });
  return figures;
}

// With matrices and weights in blocks of exactly as many as the asset has: tossed ones, and the rest pose.
bool use_bones(const Asset& asset, bool has_skin, bool is_small) {
  const std::size_t bones = view_of(asset).bone_count();
  if (bones == 0) {
    return true;
  }
  const std::vector<float> weights = tossed(view_of(asset).morph_count(), 2), anywhere = tossed(12 * bones, 3);
  std::vector<float> rest(12 * bones);
  for (std::size_t b = 0; b < bones; ++b) rest[12 * b] = rest[12 * b + 5] = rest[12 * b + 10] = 1;
  for (const bool is_rest : {true, false}) {
    const std::vector<float>& matrices = is_rest ? rest : anywhere;
    Pose pose{matrices.data(), bones, SC_ROWS_3X4};
    pose.morph_weights = weights.empty() ? nullptr : weights.data();
    pose.morph_weight_count = weights.size();
    if (!refit_and_detect(asset, pose, is_rest)) return false;
    if (has_skin && (is_small || is_rest) && !find_all_contacts(asset, pose)) return false;
  }
  return true;
}

bool use_vertices(const Asset& asset, bool has_skin, bool is_small) {
  const std::size_t count = view_of(asset).vertex_count();
  // Nearly all variants agree on the vertex count: its buffer, sized exactly, is made and hashed once.
  static std::vector<float> vertices;
  if (vertices.size() != 3 * count) {
    vertices = tossed(3 * count, 1);
    (void)sc_check_source(&asset, SC_WHOLE_SOURCE, vertices.data(), count, 12);
    for (std::size_t i = 0; i < view_of(asset).source_buffers().size; ++i) {
      (void)sc_check_source(&asset, i, vertices.data(), count, 12);
    }
  }
  Pose pose;
  pose.vertices = vertices.data();
  pose.vertex_count = count;
  return refit_and_detect(asset, pose, true) && (!has_skin || !is_small || find_all_contacts(asset, pose));
}

}  // namespace

Use use_fully(const Asset& asset) {
  read_all(asset);
  const AssetInfo info = sc_asset_get_info(&asset);
  const bool is_usual = info.vertex_count <= kMaxVertexCount && skin_table_words(&asset) <= kMaxTableWords;
  const bool is_small = is_usual && info.vertex_count <= kMaxTossed;
  const bool has_skin = is_usual && skin_table_words(&asset) > 0;
  if (has_skin) {
    const PreparedSkin table(asset);
    if (table.status != SC_OK) {
      broken("the skin is not prepared");
      return Use::kBroken;
    }
  }
  if (!use_bones(asset, has_skin, is_small) || (is_usual && !use_vertices(asset, has_skin, is_small))) {
    return Use::kBroken;
  }
  return is_usual ? Use::kFull : Use::kPartly;
}

}  // namespace spherechain::test

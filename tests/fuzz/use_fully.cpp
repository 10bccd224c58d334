// SPDX-License-Identifier: MIT
#include "use_fully.h"

#include <algorithm>
#include <cstdio>
#include <cstring>

#include "jobs.h"
#include "tiny_asset.h"

namespace spherechain::test {
namespace {

constexpr std::uint32_t kMaxVertexCount = 1U << 20;

volatile std::size_t sink;  // so that no read is optimized away

void read(const char* text) { sink = sink + std::strlen(text); }

template <typename T>
void read(Span<T> span) {
  std::size_t sum = 0;
  for (std::size_t i = 0; i < span.size * sizeof(T); ++i) {
    sum += reinterpret_cast<const unsigned char*>(span.data)[i];
  }
  sink = sink + sum;
}

// As refit does: batch by batch, sphere by sphere, pair by pair, to the bones.
void read_moments(const Asset& asset) {
  const MomentTables& tables = asset.moment_tables();
  read(tables.batches);
  read(tables.centers);
  read(tables.moments);
  std::size_t sum = 0, first_pair = 0, sphere = 0, bone = 0, pair = 0;
  for (const MomentBatch& batch : tables.batches) {
    for (std::uint32_t left = batch.sphere_count; left > 0; --left, ++sphere) {
      const std::size_t bones = tables.bone_counts[sphere];
      sum += asset.spheres()[tables.spheres[sphere]].region;
      for (const std::size_t end = bone + bones; bone < end; ++bone) {
        sum += asset.bone(tables.bones[bone]).is_rest ? 1 : 0;
      }
      for (const std::size_t end = pair + bones * (bones + 1) / 2; pair < end; ++pair) {
        const BonePair& of = tables.pairs[first_pair + tables.pair_places[pair]];
        sum += asset.bone(of.a).is_rest == asset.bone(of.b).is_rest ? 1 : 0;
      }
    }
    first_pair += batch.pair_count;
  }
  if (sphere > 0) {
    sum += asset.bone(tables.reference).is_rest ? 1 : 0;
  }
  sink = sink + sum;
}

void read_surface(const Asset& asset) {
  const Surface& surface = asset.surface();
  read(surface.leaves);
  read(surface.leaf_balls);
  read(surface.leaf_vertices);
  read(surface.leaf_bones);
  read(surface.corners);
  read(surface.source_vertices);
  read(surface.welds);
  read(surface.slot_positions);
  read(surface.slot_weights);
  read(surface.slot_morphs);
  read(surface.cover_term_counts);
  read(surface.cover_term_bones);
  read(surface.cover_terms);
  read(surface.cover_morph_counts);
  read(surface.cover_morph_targets);
  read(surface.cover_morphs);
  read(surface.rest_contacts);
  read(surface.leaf_boxes);
  read(surface.outlines);
  read(surface.outline_bones);
  read(surface.outline_points);
  read(surface.outline_weights);
  // What a narrow phase would do: leaf by leaf, corner by corner, to the source's vertex.
  std::size_t sum = 0;
  for (const Leaf& leaf : surface.leaves) {
    for (std::uint32_t corner = 0; corner < 3U * leaf.triangle_count; ++corner) {
      const std::uint8_t slot = surface.corners[std::size_t{3} * leaf.first_triangle + corner];
      sum += surface.source_vertices[surface.leaf_vertices[leaf.first_vertex + slot]];
    }
    sum += asset.spheres()[leaf.sphere].region;
  }
  sink = sink + sum;
}

void read_all(const Asset& asset) {
  const AssetInfo info = asset.info();
  for (const char* text : {info.writer, info.settings, info.settings_sha256, info.source_file, info.source_sha256}) {
    read(text);
  }
  read(asset.source_parts());
  read(asset.spheres());
  read(asset.pivots());
  read(asset.triangles());
  read(asset.ignored());
  read(asset.near_pairs(RadiusKind::kFit));
  read(asset.near_pairs(RadiusKind::kDetect));
  for (std::size_t i = 0; i < asset.region_count(); ++i) {
    read(asset.region(i).name);
  }
  for (std::size_t i = 0; i < asset.chain_count(); ++i) {
    const ChainView chain = asset.chain(i);
    read(chain.name);
    read(chain.regions);
    read(chain.spheres);
  }
  for (std::size_t i = 0; i < asset.joint_count(); ++i) {
    const JointView joint = asset.joint(i);
    read(joint.name);
    sink = sink + static_cast<std::size_t>(joint.parent + 1);
  }
  for (std::size_t i = 0; i < asset.bone_count(); ++i) {
    const BoneView bone = asset.bone(i);
    read(bone.name);
    read(Span<const float>{bone.inverse_bind, 12});
  }
  for (std::size_t i = 0; i < asset.morph_count(); ++i) {
    read(asset.morph_name(i));
  }
  read(asset.pivot_vertices());
  read(asset.packed_pivots());
  read_moments(asset);
  read_surface(asset);
  // What a narrow phase would do with the surrounding regions.
  for (const RestSphere& sphere : asset.spheres()) {
    read(Span<const std::uint32_t>{asset.triangles().data + sphere.first_triangle, sphere.triangle_count});
    read(asset.region(sphere.region).name);
  }
}

bool broken(const char* what) {
  std::fprintf(stderr, "fuzz_asset: %s\n", what);
  return false;
}

bool detect_all_ways(const Asset& asset, const std::vector<Sphere>& spheres) {
  for (const RadiusKind kind : {RadiusKind::kFit, RadiusKind::kDetect}) {
    const Detected m1 = detect(asset, spheres, Method::kM1, kind);
    const Detected m2 = detect(asset, spheres, Method::kM2, kind);
    if (m1.status != Status::kOk || m2.status != Status::kOk) {
      return broken("a detect job failed");
    }
    for (const Pair& pair : m2.pairs) {
      if (pair.a >= pair.b || pair.b >= spheres.size()) {
        return broken("a pair of spheres that do not exist");
      }
    }
    if (!std::includes(m2.pairs.begin(), m2.pairs.end(), m1.pairs.begin(), m1.pairs.end())) {
      return broken("M1 found a pair that M2 did not");
    }
  }
  return true;
}

bool cover_and_skin(const Asset& asset, const BoneMatrices& bones, const std::vector<float>& morph_weights) {
  // Without bones there is no matrix to point to: which refusal comes first is of no matter.
  const bool wanted = asset.bone_count() > 0 && asset.leaf_count() > 0;
  const bool has_vertices = asset.info().source_vertex_count > 0 && asset.info().source_vertex_count <= kMaxVertexCount;
  return ((cover(asset, bones, morph_weights).status == Status::kOk) == wanted || broken("a cover job failed")) &&
         (!has_vertices || (skin(asset, bones, morph_weights).status == Status::kOk) == wanted ||
          broken("a skin job failed"));
}

// With matrices and weights in blocks of exactly as many as the asset has.
bool refit_bones_all_ways(const Asset& asset) {
  std::mt19937 random(2);
  std::vector<float> matrices(12 * asset.bone_count()), morph_weights(asset.morph_count());
  for (float& element : matrices) {
    element = uniform(random, -1, 1);
  }
  for (float& weight : morph_weights) {
    weight = uniform(random, -1, 1);
  }
  const BoneMatrices bones{matrices.data(), asset.bone_count()};
  for (const RadiusKind kind : {RadiusKind::kFit, RadiusKind::kDetect}) {
    for (const auto& weights : {std::vector<float>(), morph_weights}) {
      const Refitted refitted = refit_bones(asset, bones, weights, kind);
      if (asset.bone_count() > 0 && refitted.status != Status::kOk) {
        return broken("a refit job from bones failed");
      }
    }
  }
  return cover_and_skin(asset, bones, {}) && cover_and_skin(asset, bones, morph_weights);
}

}  // namespace

Use use_fully(const Asset& asset) {
  read_all(asset);
  std::vector<Sphere> rest;
  for (const RestSphere& sphere : asset.spheres()) {
    rest.push_back({sphere.center.x, sphere.center.y, sphere.center.z, sphere.detect_radius});
  }
  if (!detect_all_ways(asset, rest) || !refit_bones_all_ways(asset)) {
    return Use::kBroken;
  }
  const std::uint32_t vertex_count = asset.info().source_vertex_count;
  if (vertex_count > kMaxVertexCount) {
    return Use::kWithoutRefit;
  }
  // Nearly all variants agree on the vertex count: its buffer, sized exactly, is made and hashed once.
  static std::vector<float> positions;
  if (positions.size() != std::size_t{3} * vertex_count) {
    std::mt19937 random(1);
    positions = std::vector<float>(std::size_t{3} * vertex_count);
    std::generate(positions.begin(), positions.end(), [&] { return uniform(random, -1, 1); });
    (void)check_source(asset, positions.data(), vertex_count);
    for (std::size_t i = 0; i < asset.source_parts().size; ++i) {
      const SourcePart& part = asset.source_parts()[i];
      (void)check_source_part(asset, i, positions.data() + std::size_t{3} * part.first_vertex, part.vertex_count);
    }
  }
  for (const RadiusKind kind : {RadiusKind::kFit, RadiusKind::kDetect}) {
    const Refitted refitted = refit(asset, positions, kind);
    if (refitted.status != Status::kOk) {
      broken("a refit job failed");
      return Use::kBroken;
    }
    if (!detect_all_ways(asset, refitted.spheres)) {
      return Use::kBroken;
    }
  }
  return Use::kFull;
}

}  // namespace spherechain::test

// SPDX-License-Identifier: MIT
// Small synthetic assets, valid or broken to measure.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "spherechain/asset.h"

namespace spherechain::test {

inline constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct RegionParts {
  std::string name;
  std::uint32_t triangle_count = 0;
};

struct ChainParts {
  std::string name;
  std::vector<std::uint8_t> regions;
  std::vector<std::uint32_t> spheres;
};

struct JointParts {
  std::string name;
  std::int32_t parent = -1;
  Vec3 position{}, tail{};
};

struct BoneParts {
  std::string name;
  std::array<float, 12> inverse_bind{};
  bool is_rest = false;
};

struct MomentParts {
  Vec3 origin{};
  std::uint32_t reference = 0;
  std::vector<MomentBatch> batches;
  std::vector<BonePair> pairs;
  std::vector<std::uint32_t> spheres;
  std::vector<std::uint8_t> bone_counts;
  std::vector<std::uint16_t> bones;
  std::vector<CenterTerm> centers;
  std::vector<std::uint8_t> pair_places;
  std::vector<Moment> moments;
};

struct BoneRefitParts {
  std::vector<BoneParts> bones;
  std::vector<std::string> morphs;
  std::vector<PivotLanes> weights;
  std::vector<std::uint32_t> term_counts, term_bones;
  std::vector<BoneTerm> terms;
  std::vector<std::uint32_t> morph_term_counts, morph_targets;
  std::vector<MorphTerm> morph_terms;
  MomentParts moments;  // left out where it has no batches
};

struct SurfaceParts {
  std::vector<Leaf> leaves;
  std::vector<BallLanes> leaf_balls;
  std::vector<std::uint32_t> leaf_vertices, leaf_bones;
  std::vector<std::uint8_t> corners;
  std::vector<std::uint32_t> source_vertices, welds;
  std::vector<float> slot_positions, slot_weights;
  std::vector<SlotMorph> slot_morphs;
  std::vector<std::uint32_t> cover_term_counts, cover_term_bones;
  std::vector<CoverTerm> cover_terms;
  std::vector<std::uint32_t> cover_morph_counts, cover_morph_targets;
  std::vector<BallLanes> cover_morphs;
  std::vector<TrianglePair> rest_contacts;
  std::vector<BoxLanes> leaf_boxes;  // left out where there are none
  std::vector<Outline> outlines;     // likewise, and then the next three too
  std::vector<OutlineBone> outline_bones;
  std::vector<float> outline_points, outline_weights;
};

// Everything an asset holds, to be changed before build().
struct AssetParts {
  std::uint32_t format_version = kFormatVersion;
  std::string writer = "spherechain test";
  std::string settings = "{}";
  std::string settings_sha256 = "44136fa3";
  std::string source_file = "tiny.obj";
  std::string source_sha256 = "e3b0c442";
  std::uint32_t vertex_count = 0;
  std::uint32_t triangle_count = 0;
  std::uint64_t rest_hash = 0;
  float metres_per_unit = 0.1F;
  Vec3 origin{0.0F, 0.25F, 0.0F};
  Vec3 left{1.0F, 0.0F, 0.0F}, up{0.0F, 1.0F, 0.0F}, forward{0.0F, 0.0F, 1.0F};
  float height = 1.75F;
  FitError phi1{0.5F, 1.5F}, phi1_adjusted{0.25F, 1.25F}, phi2{0.75F, 2.5F};
  std::uint8_t refit = 1;
  std::uint32_t chain_entries_table1 = 0;
  std::vector<RegionParts> regions;
  std::vector<RestSphere> spheres;
  std::vector<Pivot> pivots;
  std::vector<std::uint32_t> triangles;
  std::vector<ChainParts> chains;
  std::vector<std::uint64_t> ignored;
  std::vector<NearPair> near_fit, near_detect;
  std::vector<SourcePart> source_parts;
  std::vector<JointParts> joints;
  std::vector<std::uint32_t> pivot_vertices;
  std::vector<Pivot> packed_pivots;
  BoneRefitParts bone_refit;  // left out where it has neither bones nor weights
  SurfaceParts surface;       // left out where it has no leaves

  // Ways of breaking an asset that no value above can express.
  std::string without;              // a struct to leave out: "frame.up", "fit.phi1", "joints.tail", "packed_pivots" ...
  bool chains_share_array = false;  // all chains point at the first one's spheres
};

// The bytes of a .sphc file. A vector's memory is aligned for any Asset and sized exactly.
std::vector<std::uint8_t> build(const AssetParts& parts);

struct TinyAsset {
  AssetParts parts;
  std::vector<float> rest;          // x, y, z of each vertex in the rest pose
  std::vector<Pair> ignored_pairs;  // what parts.ignored says, as a list
};

// `sphere_count` spheres strewn over a unit box, four pivots each with vertices of their own, five regions, a few
// chains, some ignored and near pairs, three joints. The same seed gives the same asset.
TinyAsset random_asset(std::size_t sphere_count, unsigned seed);

// Spheres strewn over a unit box, about half of them on a coarse grid where exact contacts happen.
std::vector<Sphere> random_spheres(std::size_t count, std::mt19937& random);

// In [low, high); the same on every standard library, unlike std::uniform_real_distribution.
float uniform(std::mt19937& random, float low, float high);

// The bytes and the view of them; REQUIREs nothing, so look at `status`.
struct OpenedAsset {
  explicit OpenedAsset(const AssetParts& parts);
  OpenedAsset(const OpenedAsset&) = delete;
  OpenedAsset& operator=(const OpenedAsset&) = delete;

  std::vector<std::uint8_t> bytes;
  std::string message;
  Asset asset;
  Status status;
};

}  // namespace spherechain::test

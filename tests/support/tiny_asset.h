// SPDX-License-Identifier: MIT
// Small synthetic assets, valid or broken to measure: the schema's tables as plain vectors.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "runtime/src/asset/asset_view.h"
#include "runtime/src/skin/skin_table.h"

namespace spherechain::test {

inline constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct RegionEntry {
  std::string name;
  std::uint32_t triangle_count = 0;
};

struct PartEntry {
  std::string name;
  std::uint8_t side = 0;
  std::int32_t bone = -1;
  std::int32_t parent = -1;
  std::uint8_t mobility = 0;
};

struct ChainEntry {
  std::string name;
  std::vector<std::uint8_t> regions;
  std::vector<std::uint32_t> spheres;
};

struct JointEntry {
  std::string name;
  std::int32_t parent = -1;
  Vec3 position{}, tail{};
};

struct BoneEntry {
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

using Numbers = std::vector<std::uint32_t>;  // what the asset has as a stream

struct SkinParts {
  std::uint32_t vertex_count = 0;
  Numbers triangles;
  std::vector<std::uint8_t> corners, part_runs;
  Numbers part_run_ends;
  std::vector<PackedCluster> clusters;
  Numbers cluster_vertices, cluster_bones, sources, welds;
  std::vector<float> positions;
  std::vector<std::uint8_t> influence_counts;
  Numbers influence_bones;
  std::vector<float> influence_weights;
  std::vector<std::uint16_t> morph_counts;
  std::vector<MorphDelta> morphs;
  std::vector<BoxLanes> boxes;
  std::vector<std::uint32_t> bounds_term_counts, bounds_term_bones;  // no streams
  std::vector<BoundsTerm> bounds_terms;
  std::vector<std::uint32_t> bounds_morph_counts, bounds_morph_targets;  // no streams
  std::vector<BallLanes> bounds_morphs;
  std::vector<std::pair<std::string, float>> pieces;  // names and borders
  Numbers covers;
  std::vector<float> cover_distances;
  Numbers rest_contacts, layer_pairs;
  std::vector<std::uint8_t> layer_runs;
  Numbers layer_run_ends;
  std::vector<std::int8_t> windings, core_windings;
  Numbers core_triangles;
  std::vector<PackedHull> hulls;
  std::vector<HullBone> hull_bones;
  Numbers hull_points;
};

// Everything an asset holds, to be changed before build().
struct AssetParts {
  std::uint32_t format_version = kFormatVersion;
  std::string writer = "spherechain test", settings = "{}", settings_sha256 = "44136fa3";
  std::string source_file = "tiny.obj", source_sha256 = "e3b0c442";
  std::uint32_t vertex_count = 0, triangle_count = 0;
  std::uint64_t rest_hash = 0;
  float metres_per_unit = 0.1F;
  Vec3 origin{0.0F, 0.25F, 0.0F};
  Vec3 left{1.0F, 0.0F, 0.0F}, up{0.0F, 1.0F, 0.0F}, forward{0.0F, 0.0F, 1.0F};
  float height = 1.75F;
  FitError phi1{0.5F, 1.5F}, phi1_adjusted{0.25F, 1.25F}, phi2{0.75F, 2.5F};
  std::uint8_t refit = 1;  // of RefitRule
  std::vector<RegionEntry> regions;
  std::vector<PartEntry> parts;
  std::vector<RestSphere> spheres;
  std::vector<Pivot> pivots;
  std::vector<ChainEntry> chains;
  std::vector<std::uint64_t> ignored;
  std::vector<RestPair> rest_fit, rest_detect;
  std::vector<sc_source_buffer> buffers;
  std::vector<JointEntry> joints;
  std::vector<BoneEntry> bones;
  std::vector<std::string> morphs;
  MomentParts moments;  // left out where it has no batches
  SkinParts skin;

  // Ways of breaking an asset that no value above can express.
  std::string without;              // a struct to leave out: "frame.up", "fit.phi1", "joints.tail", "inverse_bind" ...
  bool chains_share_array = false;  // all chains point at the first one's spheres
};

// The bytes of a .sphc file. A vector's memory is aligned for any asset and sized exactly.
std::vector<std::uint8_t> build(const AssetParts& parts);

// A stream of the asset.
std::vector<std::uint8_t> encode(const Numbers& numbers);

// An asset and the source that it stands for.
struct TinyAsset {
  AssetParts parts;
  std::vector<float> rest;                            // x, y, z of each vertex in the rest pose
  std::vector<std::array<std::uint32_t, 3>> corners;  // of each triangle
  std::vector<Numbers> triangles;                     // of each sphere; of no effect before add_skin()
  std::vector<std::uint8_t> part_of_triangle;
  std::vector<Pair> ignored_pairs;  // what parts.ignored says, as a list
};

// `sphere_count` spheres strewn over a unit box, four pivots each with vertices of their own, five regions, five body
// parts, a few chains, some ignored and rest pairs, three joints; no bones and no skin. The same seed gives the same
// asset. Its refit rule is moments.
TinyAsset random_asset(std::size_t sphere_count, unsigned seed);

// A band that winds through a unit box, twelve triangles a sphere; spheres that share vertices, or positions, are
// ignored pairs. Without bones and skin.
TinyAsset random_band(std::size_t sphere_count, unsigned seed);

// Spheres strewn over a unit box, about half of them on a coarse grid where exact contacts happen.
std::vector<Sphere> random_spheres(std::size_t count, std::mt19937& random);

// In [low, high); the same on every standard library, unlike std::uniform_real_distribution.
float uniform(std::mt19937& random, float low, float high);

// The bytes and the view of them; REQUIREs nothing, so look at `status`.
struct OpenedAsset {
  explicit OpenedAsset(const AssetParts& parts);
  OpenedAsset(const OpenedAsset&) = delete;
  OpenedAsset& operator=(const OpenedAsset&) = delete;
  const AssetView& view() const { return view_of(asset); }

  std::vector<std::uint8_t> bytes;
  std::string message;
  Asset asset;
  Status status;
};

}  // namespace spherechain::test

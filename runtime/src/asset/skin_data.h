// SPDX-License-Identifier: MIT
// The skin as the asset's bytes have it, packed: schemas/sphere_chains.fbs, Skin. skin/skin_table.h expands it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "runtime/src/base/span.h"
#include "spherechain/types.h"

namespace spherechain {

inline constexpr std::size_t kClusterLanes = 8;  // clusters that are bounded together
inline constexpr std::size_t kSlotLanes = 8;     // a cluster's slots are a multiple of it
inline constexpr std::size_t kMaxClusterTriangles = 64;
inline constexpr std::size_t kMaxClusterVertices = 3 * kMaxClusterTriangles;
inline constexpr std::size_t kHullLanes = 16;  // a hull's points are a multiple of it

inline constexpr std::uint8_t kOneWeightLeftOut = 128;                          // bit of an influence count
inline constexpr std::uint8_t kIsCovered = 1, kIsInsideOut = 2, kIsDouble = 4;  // bits of a run of layers
inline constexpr std::size_t kCorePoints = 128;                                 // a part: see core_point()

// Eight balls, or boxes along the axes, one a lane.
struct BallLanes {
  float x[kClusterLanes], y[kClusterLanes], z[kClusterLanes], radius[kClusterLanes];
};
struct BoxLanes {
  float x[kClusterLanes], y[kClusterLanes], z[kClusterLanes];
  float half_x[kClusterLanes], half_y[kClusterLanes], half_z[kClusterLanes];
  float radius[kClusterLanes];
};

struct BoundsTerm {
  float weights[kClusterLanes];     // w_b, the cluster's mid weights: over the bones they add up to 1
  float deviations[kClusterLanes];  // d_b, the greatest |a vertex' weight - w_b|
};

struct PackedCluster {
  std::uint8_t triangle_count, vertex_count;
  std::uint16_t bone_count;
  std::uint8_t is_buried, reserved;
};

struct PackedHull {
  std::uint16_t bone_count, point_count;
  Vec3 center;
  float radius, slack;
};

struct HullBone {
  std::uint32_t bone;
  float x, y, z, w;
};

struct MorphDelta {
  std::uint32_t target;
  Vec3 delta;
};

// How much the expanded tables hold, all clusters together.
struct SkinSizes {
  std::size_t triangles = 0, clusters = 0, vertices = 0, influences = 0;
  std::size_t cluster_vertices = 0, cluster_bones = 0, slots = 0, weights = 0, slot_morphs = 0;
  std::size_t rest_contacts = 0, layer_pairs = 0, hulls = 0, hull_bones = 0, hull_points = 0, hull_weights = 0;
};

struct SkinData {
  SkinSizes sizes;
  Span<const std::uint8_t> triangles, cluster_vertices, cluster_bones, sources, welds;          // streams
  Span<const std::uint8_t> influence_bones, rest_contacts, hull_points;                         // likewise
  Span<const std::uint8_t> part_run_ends, layer_pairs, layer_run_ends, core_triangles, covers;  // likewise
  Span<const std::uint8_t> part_runs, layer_runs, corners, influence_counts;
  Span<const std::int8_t> windings, core_windings;
  Span<const std::uint16_t> morph_counts;
  Span<const PackedCluster> clusters;
  Span<const float> positions, influence_weights, cover_distances;
  Span<const MorphDelta> morphs;
  Span<const BoxLanes> boxes;
  Span<const std::uint32_t> bounds_term_counts, bounds_term_bones, bounds_morph_counts, bounds_morph_targets;
  Span<const BoundsTerm> bounds_terms;
  Span<const BallLanes> bounds_morphs;
  Span<const PackedHull> hulls;
  Span<const HullBone> hull_bones;
};

}  // namespace spherechain

// SPDX-License-Identifier: MIT
// The asset's skin, expanded so that kernels read it side by side: what sc_prepare_skin() makes of the packed one.
#pragma once

#include <cstddef>
#include <cstdint>

#include "asset/asset_view.h"

namespace spherechain {

// A cluster of at most 64 triangles of one sphere. A slot is a place for a vertex of the cluster.
struct Cluster {
  std::uint32_t sphere;
  std::uint32_t first_triangle;  // into Surface::triangles
  std::uint32_t first_vertex;    // into Surface::cluster_vertices
  std::uint32_t first_bone;      // into Surface::cluster_bones
  std::uint32_t first_slot;      // a third of the place in Surface::slot_positions
  std::uint32_t first_weight;    // into Surface::slot_weights
  std::uint32_t first_morph;     // into Surface::slot_morphs
  std::uint32_t morph_count;
  std::uint16_t triangle_count;  // >= 1
  std::uint16_t vertex_count;    // >= 1
  std::uint16_t bone_count;      // >= 1; 0 where nothing moves the source
  std::uint16_t reserved;
};

// As many as vertices, up to the next multiple of kSlotLanes; those beyond repeat the last vertex.
constexpr std::size_t slot_count(const Cluster& cluster) noexcept {
  return (cluster.vertex_count + kSlotLanes - 1) / kSlotLanes * kSlotLanes;
}

// What a morph target of weight 1 adds to the rest position in a slot.
struct SlotMorph {
  std::uint32_t target, slot;
  Vec3 delta;
};

// Points near whose convex hull a sphere's vertices stay in every pose (schemas/sphere_chains.fbs, Hull).
struct Hull {
  std::uint32_t first_cluster;  // the sphere's
  std::uint32_t first_bone;     // into Surface::hull_bones
  std::uint32_t first_point;    // a third of the place in Surface::hull_points
  std::uint32_t first_weight;   // into Surface::hull_weights
  std::uint16_t bone_count, point_count;
  Vec3 center;
  float radius, slack;
};

// A vertex stands for all source vertices that have its rest position and move as it does; a corner is the slot of a
// vertex in its cluster. Two triangles are neighbours where a corner's weld is the same. Groups are of eight clusters.
struct Surface {
  Span<const std::uint32_t> triangles;           // the source's numbers, by sphere, in it by cluster
  Span<const Cluster> clusters;                  // by sphere
  Span<const std::uint32_t> cluster_vertices;    // the vertex in a slot: ascending in a cluster
  Span<const std::uint32_t> cluster_bones;       // ascending in a cluster
  Span<const std::uint8_t> corners;              // three a triangle, in the source's order
  Span<const std::uint8_t> parts;                // of each triangle
  Span<const std::uint32_t> source_vertices;     // a vertex' lowest source vertex
  Span<const std::uint32_t> welds;               // the lowest vertex at the same rest position: at most its own number
  Span<const float> slot_positions;              // at rest: of a cluster all x, all y, all z
  Span<const float> slot_weights;                // of a cluster its first bone's in all slots, its second's ...
  Span<const SlotMorph> slot_morphs;             // of a cluster sorted by target, then slot
  Span<const BoxLanes> boxes;                    // a group's: around a cluster's vertices at rest, without its morphs
  Span<const std::uint32_t> bounds_term_counts;  // a group's; empty where nothing moves the source
  Span<const std::uint32_t> bounds_term_bones;   // a term's, ascending in a group
  Span<const BoundsTerm> bounds_terms;
  Span<const std::uint32_t> bounds_morph_counts;   // a group's; empty where no morph moves the skin
  Span<const std::uint32_t> bounds_morph_targets;  // an entry's of bounds_morphs, ascending in a group
  Span<const BallLanes> bounds_morphs;             // around the deltas of a cluster's vertices
  Span<const Pair> rest_contacts;                  // source triangles that intersect in the rest pose, sorted
  // Of the rest pose without morphs; empty where nothing moves the source.
  Span<const Hull> hulls;           // a sphere's
  Span<const HullBone> hull_bones;  // of hull after hull
  Span<const float> hull_points;    // of a hull all x, all y, all z
  Span<const float> hull_weights;   // of a hull its first bone's of all points, its second's ...
};

std::size_t skin_table_words(const AssetView& asset);
void fill_skin_table(const AssetView& asset, std::uint64_t* words);

// A table of this asset; else SC_NULL, SC_MISALIGNED or SC_BAD_VALUE.
Status read_skin_table(const AssetView& asset, const std::uint64_t* words, Surface& surface);

}  // namespace spherechain

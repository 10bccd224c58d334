// SPDX-License-Identifier: MIT
// The asset's skin, expanded so that kernels read it side by side: what prepare_skin() makes of the packed one.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "runtime/src/asset/asset_view.h"

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

// The displacement of the rest position in a slot by a morph target of weight 1.
struct SlotMorph {
  std::uint32_t target, slot;
  Vec3 delta;
};

// Triangles side by side, of one cluster.
struct TriangleRun {
  std::uint32_t cluster, first, count;
};

// Points near whose convex hull a sphere's vertices stay in every pose (schemas/sphere_chains.fbs, Hull).
struct Hull {
  std::uint32_t first_bone;    // into Surface::hull_bones
  std::uint32_t first_point;   // a third of the place in Surface::hull_points
  std::uint32_t first_weight;  // into Surface::hull_weights
  std::uint16_t bone_count, point_count;
  Vec3 center;
  float radius, slack;
};

// Around the vertices that a bone moves, at rest; `half` is negative where it moves none.
struct BoneBox {
  Vec3 center, half;
};

inline constexpr std::uint32_t kNoPlace = 0xFFFFFFFF;

// A vertex stands for all source vertices that have its rest position and move as it does; a corner is the slot of a
// vertex in its cluster. Two triangles are neighbours where a corner's weld is the same. Groups are of eight clusters.
struct Surface {
  // In the caller's words, which prepare_skin() alone writes.
  Span<std::uint32_t> triangles;            // the source's numbers, by sphere, in it by cluster
  Span<Cluster> clusters;                   // by sphere
  Span<std::uint32_t> first_clusters;       // a sphere's, and the end
  Span<std::uint32_t> cluster_vertices;     // the vertex in a slot: ascending in a cluster
  Span<std::uint32_t> cluster_bones;        // ascending in a cluster
  Span<std::uint8_t> parts;                 // of each triangle
  Span<std::uint8_t> layers;                // of each triangle: bits kIsCovered, kIsInsideOut and kIsDouble
  Span<std::uint32_t> triangle_vertices;    // three of each triangle
  Span<std::uint16_t> triangle_spheres;     // of each triangle
  Span<std::uint32_t> place_of_source;      // a source triangle's place in `triangles`; kNoPlace where it is not there
  Span<TriangleRun> part_runs;              // of part after part
  Span<std::uint32_t> first_of_part;        // a part's in part_runs, and the end
  Span<float> part_areas;                   // a part's, at rest
  Span<std::uint32_t> pieces;               // of each vertex: equal where triangles join two vertices
  Span<std::uint32_t> source_vertices;      // a vertex' lowest source vertex
  Span<std::uint32_t> welds;                // the lowest vertex at the same rest position: at most its own number
  Span<float> slot_positions;               // at rest: of a cluster all x, all y, all z
  Span<float> slot_weights;                 // of a cluster its first bone's in all slots, its second's ...
  Span<SlotMorph> slot_morphs;              // of a cluster sorted by target, then slot
  Span<std::uint32_t> bounds_first_terms;   // a group's, and the end
  Span<std::uint32_t> bounds_first_morphs;  // likewise; empty where no morph moves the skin
  Span<Pair> rest_contacts;                 // source triangles that intersect in the rest pose, sorted
  Span<BoneBox> bone_boxes;                 // a bone's
  Span<float> morph_reach;                  // how far a morph target of weight 1 moves a vertex at most
  // Hulls in the rest pose without morphs; empty where nothing moves the source.
  Span<Hull> hulls;          // a sphere's
  Span<float> hull_points;   // of a hull all x, all y, all z
  Span<float> hull_weights;  // of a hull its first bone's of all points, its second's ...
  // Clusters that are layers of one place, the one over the other, in rows of bits: bit k of layer_bits[i] is of
  // cluster 64 layer_words[i] + k.
  Span<std::uint32_t> first_of_layers;  // a cluster's in the two below, and the end
  Span<std::uint32_t> layer_words;      // ascending in a row
  Span<std::uint64_t> layer_bits;
  Span<std::uint64_t> buried;          // a bit for each cluster that other pieces lie closely over
  Span<std::uint32_t> core_triangles;  // of kCorePoints a part: kNoPlace where no skin encloses the point at rest

  // The asset's own.
  Span<const float> rest_positions;             // x, y, z of each vertex
  Span<const std::uint8_t> corners;             // three a triangle, in the source's order
  Span<const BoxLanes> boxes;                   // a group's: around a cluster's vertices at rest, without its morphs
  Span<const std::uint32_t> bounds_term_bones;  // a term's, ascending in a group
  Span<const BoundsTerm> bounds_terms;
  Span<const std::uint32_t> bounds_morph_targets;  // an entry's of bounds_morphs, ascending in a group
  Span<const BallLanes> bounds_morphs;             // around the deltas of a cluster's vertices
  Span<const HullBone> hull_bones;                 // of hull after hull
  // How often the skin winds around a point at rest, as counted along x, y and z: see windings.h.
  Span<const std::int8_t> windings;       // around each sphere's centre
  Span<const std::int8_t> core_windings;  // around each core point
};

inline std::uint32_t cluster_of(const Surface& surface, std::uint32_t triangle) {
  const auto after = std::upper_bound(surface.clusters.begin(), surface.clusters.end(), triangle,
                                      [](std::uint32_t t, const Cluster& c) { return t < c.first_triangle; });
  return static_cast<std::uint32_t>(after - surface.clusters.begin() - 1);
}

inline Span<const TriangleRun> runs_of(const Surface& surface, std::size_t part) {
  const std::uint32_t first = surface.first_of_part[part];
  return {surface.part_runs.data + first, surface.first_of_part[part + 1] - first};
}

// True of triangles that other pieces of the skin hide at rest: a body below a suit, teeth, the lining of a coat.
inline bool is_covered(const Surface& surface, std::size_t triangle) {
  return (surface.layers[triangle] & kIsCovered) != 0;
}

// -1 of a piece that is inside out at rest; 0: other triangles count for this one.
inline int facing(const Surface& surface, std::size_t triangle) {
  const unsigned layer = surface.layers[triangle];
  return (layer & kIsDouble) != 0 ? 0 : (layer & kIsInsideOut) != 0 ? -1 : 1;
}

// Hands out arrays of a caller's words, each from a cache line on, and with a line to spare: vectors of any target may
// be read and written that far past its end. With null words it only counts how many there have to be.
class WordMemory {
 public:
  explicit WordMemory(std::uint64_t* words, std::size_t used = 0) : words_(words), used_(used) {}

  template <typename T>
  void take(T*& out, std::size_t count) {
    const std::uintptr_t place = reinterpret_cast<std::uintptr_t>(words_) / sizeof(std::uint64_t) + used_;
    used_ += words_ == nullptr ? kLine - 1 : (kLine - place % kLine) % kLine;
    out = words_ == nullptr ? nullptr : reinterpret_cast<T*>(words_ + used_);
    used_ += (count * sizeof(T) + sizeof(std::uint64_t) - 1) / sizeof(std::uint64_t) + kLine;
  }
  template <typename T>
  void take(Span<T>& out, std::size_t count) {
    take(out.data, count);
    out.size = count;
  }
  std::size_t used() const { return used_; }

 private:
  static constexpr std::size_t kLine = 64 / sizeof(std::uint64_t);
  std::uint64_t* words_;
  std::size_t used_;
};

std::size_t skin_table_words(const AssetView& asset);

// A table of this asset; else SC_NULL, SC_MISALIGNED or SC_BAD_VALUE.
Status read_skin_table(const AssetView& asset, const std::uint64_t* words, Surface& surface);

}  // namespace spherechain

// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "spherechain/types.h"

namespace spherechain {

inline constexpr std::size_t kLeafLanes = 8;          // leaves that are bounded together
inline constexpr std::size_t kMaxLeafVertices = 255;  // so that a corner is a byte
inline constexpr std::size_t kSlotLanes = 8;          // a leaf's slots are a multiple of it

// Eight balls, one a lane. Spare lanes are 0.
struct BallLanes {
  float x[kLeafLanes], y[kLeafLanes], z[kLeafLanes], radius[kLeafLanes];
};

// Eight boxes along the axes, one a lane: centres and half of the extents, and how far from the centre what is in it
// reaches. Spare lanes are 0.
struct BoxLanes {
  float x[kLeafLanes], y[kLeafLanes], z[kLeafLanes];
  float half_x[kLeafLanes], half_y[kLeafLanes], half_z[kLeafLanes];
  float radius[kLeafLanes];
};

// What a bone has to do with eight leaves. 0 in lanes the bone does not move, and in spare ones.
struct CoverTerm {
  float weights[kLeafLanes];     // w_b, the leaf's mid weights: over the bones they add up to 1
  float deviations[kLeafLanes];  // d_b, the greatest |a vertex' weight - w_b| of the leaf
};

// A cluster of triangles of one surrounding region. The leaves of sphere 0 come first, and so on; a sphere's leaves
// tile its run of Asset::triangles(). A slot is a place for a vertex of the leaf.
struct Leaf {
  std::uint32_t sphere;
  std::uint32_t first_triangle;  // into Asset::triangles()
  std::uint32_t first_vertex;    // into Surface::leaf_vertices
  std::uint32_t first_bone;      // into Surface::leaf_bones
  std::uint32_t first_slot;      // a third of the place in Surface::slot_positions
  std::uint32_t first_weight;    // into Surface::slot_weights
  std::uint32_t first_morph;     // into Surface::slot_morphs
  std::uint32_t morph_count;
  std::uint16_t triangle_count;  // >= 1
  std::uint16_t vertex_count;    // 1 to kMaxLeafVertices
  std::uint16_t bone_count;      // >= 1; 0 where nothing moves the source
  std::uint16_t reserved;
};

// As many as vertices, up to the next multiple of kSlotLanes; those beyond repeat the last vertex.
constexpr std::size_t slot_count(const Leaf& leaf) noexcept {
  return (leaf.vertex_count + kSlotLanes - 1) / kSlotLanes * kSlotLanes;
}

// What a morph target of weight 1 adds to the rest position in a slot.
struct SlotMorph {
  std::uint32_t target, slot;
  Vec3 delta;
};

inline constexpr std::size_t kOutlineLanes = 16;  // an outline's points are a multiple of it

// What keeps a sphere's triangles together in every pose: points near whose hull they stay, that move as vertices do.
// For each vertex of the sphere there are shares of the points, at least 0, that add up to 1, so that the two vectors
// w_b (v - center; 1), w_b a bone's weight, of the vertex and of its shares of the points are, coordinate by
// coordinate, as close as OutlineBone says; and the sums over the bones of their first three as `slack` says.
struct Outline {
  std::uint32_t first_leaf;    // the sphere's
  std::uint32_t first_bone;    // into Surface::outline_bones
  std::uint32_t first_point;   // a third of the place in Surface::outline_points
  std::uint32_t first_weight;  // into Surface::outline_weights
  std::uint16_t bone_count;    // 0 where the sphere has no leaves
  std::uint16_t point_count;   // a multiple of kOutlineLanes; likewise
  Vec3 center;                 // rest
  float radius;                // from there to the farthest vertex or point
  float slack;
};

// The first of an outline's is the one that moves most of it.
struct OutlineBone {
  std::uint32_t bone;
  float x, y, z, w;
};

// Source triangle numbers, a < b.
struct TrianglePair {
  std::uint32_t a, b;

  friend constexpr bool operator==(const TrianglePair& l, const TrianglePair& r) { return l.a == r.a && l.b == r.b; }
  friend constexpr bool operator!=(const TrianglePair& l, const TrianglePair& r) { return !(l == r); }
  // By one comparison: lists of contacts are sorted every frame.
  friend constexpr bool operator<(const TrianglePair& l, const TrianglePair& r) {
    return (std::uint64_t{l.a} << 32 | l.b) < (std::uint64_t{r.a} << 32 | r.b);
  }
};

// The triangles of Asset::triangles(), in that order, as what exact contacts are found in. A surface vertex stands for
// all source vertices that have its rest position and move as it does; a corner is the slot of a surface vertex in its
// leaf. Two triangles are neighbours where a corner's weld is the same. Groups are of eight leaves one after another,
// the last filled up with spare lanes.
struct Surface {
  Span<const Leaf> leaves;
  Span<const BallLanes> leaf_balls;           // a group's: around the leaf's vertices at rest, without its morphs
  Span<const std::uint32_t> leaf_vertices;    // the surface vertex in a slot: ascending in a leaf
  Span<const std::uint32_t> leaf_bones;       // bones that move a leaf's vertices: ascending in a leaf
  Span<const std::uint8_t> corners;           // three a triangle of Asset::triangles(), in the source's order
  Span<const std::uint32_t> source_vertices;  // a surface vertex' lowest source vertex
  Span<const std::uint32_t> welds;    // the lowest surface vertex at the same rest position: at most its own number
  Span<const float> slot_positions;   // at rest: of a leaf all x, all y, all z
  Span<const float> slot_weights;     // of a leaf its first bone's in all slots, its second's ...; they add up to 1
  Span<const SlotMorph> slot_morphs;  // of a leaf sorted by target, then slot
  Span<const std::uint32_t> cover_term_counts;  // a group's; empty where nothing moves the source
  Span<const std::uint32_t> cover_term_bones;   // a term's, ascending in a group
  Span<const CoverTerm> cover_terms;
  Span<const std::uint32_t> cover_morph_counts;   // a group's; empty where no morph moves the surface
  Span<const std::uint32_t> cover_morph_targets;  // an entry's of cover_morphs, ascending in a group
  Span<const BallLanes> cover_morphs;             // around the deltas of a leaf's vertices, 0 where a vertex has none
  Span<const TrianglePair> rest_contacts;         // triangles that intersect in the rest pose, sorted
  Span<const BoxLanes> leaf_boxes;  // a group's: around the leaf's vertices at rest, without its morphs; may be empty

  // Of the rest pose without morphs; empty in assets of older bakers, and where nothing moves the source.
  Span<const Outline> outlines;           // a sphere's
  Span<const OutlineBone> outline_bones;  // of outline after outline
  Span<const float> outline_points;       // of an outline all x, all y, all z
  Span<const float> outline_weights;      // of an outline its first bone's of all points, its second's ...
};

}  // namespace spherechain

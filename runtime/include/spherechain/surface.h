// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "spherechain/types.h"

namespace spherechain {

inline constexpr std::size_t kLeafLanes = 8;          // leaves that are bounded together
inline constexpr std::size_t kMaxLeafVertices = 255;  // so that a corner is a byte
inline constexpr std::size_t kMaxInfluences = 64;     // bones of a vertex; spherechain's baker writes up to 8

// Eight balls, one a lane. Spare lanes are 0.
struct BallLanes {
  float x[kLeafLanes], y[kLeafLanes], z[kLeafLanes], radius[kLeafLanes];
};

// What a bone has to do with eight leaves. 0 in lanes the bone does not move, and in spare ones.
struct CoverTerm {
  float weights[kLeafLanes];     // w_b, the leaf's mid weights: over the bones they add up to 1
  float deviations[kLeafLanes];  // d_b, the greatest |a vertex' weight - w_b| of the leaf
};

// A cluster of triangles of one surrounding region. The leaves of sphere 0 come first, and so on; a sphere's leaves
// tile its run of Asset::triangles().
struct Leaf {
  std::uint32_t sphere;
  std::uint32_t first_triangle;  // into Asset::triangles()
  std::uint32_t first_vertex;    // into Surface::leaf_vertices
  std::uint32_t first_bone;      // into Surface::leaf_bones
  std::uint16_t triangle_count;  // >= 1
  std::uint16_t vertex_count;    // 1 to kMaxLeafVertices
  std::uint16_t bone_count;      // >= 1; 0 where nothing moves the source
  std::uint16_t reserved;
};

// How a surface vertex moves: its rest position and the sum of morph weight * delta, by the sum of weight * the bone's
// matrix.
struct SurfaceVertex {
  Vec3 position;                  // rest
  std::uint32_t first_influence;  // into Surface::influences
  std::uint32_t first_morph;      // into Surface::morphs
  std::uint16_t influence_count;  // 1 to kMaxInfluences; 0 where nothing moves the source
  std::uint16_t morph_count;
};

// A bone's part in a surface vertex: bones ascending in a vertex, weights in (0, 1] that add up to 1.
struct Influence {
  std::uint32_t bone;
  float weight;
};

// What a morph target of weight 1 adds to a rest position: targets ascending in a vertex.
struct MorphDelta {
  std::uint32_t target;
  Vec3 delta;
};

// Source triangle numbers, a < b.
struct TrianglePair {
  std::uint32_t a, b;

  friend constexpr bool operator==(const TrianglePair& l, const TrianglePair& r) { return l.a == r.a && l.b == r.b; }
  friend constexpr bool operator!=(const TrianglePair& l, const TrianglePair& r) { return !(l == r); }
  friend constexpr bool operator<(const TrianglePair& l, const TrianglePair& r) {
    return l.a != r.a ? l.a < r.a : l.b < r.b;
  }
};

// The triangles of Asset::triangles(), in that order, as what exact contacts are found in. A surface vertex stands for
// all source vertices that have its rest position and move as it does; a corner is the place of a surface vertex in
// its leaf's run of leaf_vertices. Groups are of eight leaves one after another, the last filled up with spare lanes.
struct Surface {
  Span<const Leaf> leaves;
  Span<const BallLanes> leaf_balls;         // a group's: around the leaf's vertices at rest, without its morphs
  Span<const std::uint32_t> leaf_vertices;  // surface vertices: ascending in a leaf
  Span<const std::uint32_t> leaf_bones;     // of the leaf's vertices: ascending in a leaf
  Span<const std::uint8_t> corners;         // three a triangle of Asset::triangles(), in the source's order
  Span<const SurfaceVertex> vertices;
  Span<const std::uint32_t> source_vertices;  // a surface vertex' lowest source vertex
  Span<const std::uint32_t> welds;  // the lowest surface vertex at the same rest position: its own number, or less
  Span<const Influence> influences;
  Span<const MorphDelta> morphs;
  Span<const std::uint32_t> cover_term_counts;  // a group's; empty where nothing moves the source
  Span<const std::uint32_t> cover_term_bones;   // a term's, ascending in a group
  Span<const CoverTerm> cover_terms;
  Span<const std::uint32_t> cover_morph_counts;   // a group's; empty where no morph moves the surface
  Span<const std::uint32_t> cover_morph_targets;  // an entry's of cover_morphs, ascending in a group
  Span<const BallLanes> cover_morphs;             // around the deltas of a leaf's vertices, 0 where a vertex has none
  Span<const TrianglePair> rest_contacts;         // triangles that intersect in the rest pose, sorted
};

}  // namespace spherechain

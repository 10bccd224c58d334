// SPDX-License-Identifier: MIT
// A skin in a pose: its clusters of triangles, with bounds that are computed when they are needed.
#pragma once

#include <cstddef>
#include <cstdint>

#include "runtime/src/skin/skin_inputs.h"
#include "runtime/src/skin/skin_table.h"
#include "runtime/src/triangles/exact_triangles.h"

namespace spherechain {

// Vectors of any target may be read, and written, this far past the end of what is there.
inline constexpr std::size_t kContactPadding = 16;

// Along which a cluster's vertices are spanned: the axes x, y and z and the diagonals of their planes, x + y, y + z, z
// + x, x - y, y - z and z - x. Most clusters whose boxes touch are apart along a diagonal. And room for a vector.
inline constexpr std::size_t kDirections = 9, kSpanLanes = 16;

// Floats of a bone's matrix, stored by columns of four.
inline constexpr std::size_t kColumnFloats = 16;

// How large a bone's matrix is.
struct BoneSize {
  float norm;         // at least the spectral norm of its linear part, but for rounding
  float translation;  // the greatest magnitude of a component
};

// Boxes coordinate by coordinate.
struct BoxColumns {
  float* low[3];
  float* high[3];
};

struct PosedClusters {
  const Surface* surface = nullptr;
  std::size_t sphere_count = 0;
  Span<const std::uint64_t> ignored;
  Span<const Pair> candidates;                   // of spheres: the pairs to decide; null: those of the scope
  Span<const Pair> candidate_clusters;           // of loaded clusters: the pairs to decide; null: those of spheres
  bool apart = true, neighbours = false;         // which of them to pair: see sc_scope
  bool layers = true;                            // pairs clusters that are layers of one place, too
  bool has_sphere_boxes = false;                 // those below are of this pose already
  bool first_only = false;                       // of each two spheres no more once one candidate is a contact
  const float* positions = nullptr;              // the source's; null: from bones
  bool has_balls = false;                        // bounded by bones
  bool has_hulls = false;                        // and sphere by sphere first: clusters only as needed
  std::size_t stride = 0;                        // floats
  SkinInputs skin{};                             // from bones
  const std::uint32_t* first_cluster = nullptr;  // a sphere's, and the end
  // Scratch memory.
  BoxColumns spheres, clusters;
  std::uint8_t* is_loaded = nullptr;   // a cluster's: are its vertices and its span below?
  std::uint8_t* is_bounded = nullptr;  // a sphere's: are its clusters' boxes there?
  float* spans = nullptr;              // of cluster after cluster: the least in each direction, then the greatest
  float* slots = nullptr;              // x, y, z of a cluster's vertices, of cluster after cluster
  // From bones.
  float* ball_columns[4] = {};               // around the clusters, by coordinates, the radius last
  std::uint8_t* is_group_bounded = nullptr;  // a group's of eight clusters
  BoneSize* bone_sizes = nullptr;
  // The bones' boxes in the pose, low corner first, where bones move both of two bodies. If null, spheres are bounded
  // wherever they are.
  float* bone_boxes = nullptr;
  // With hulls.
  float* columns = nullptr;       // of bone after bone four of four floats, the fourth the translation
  float* hulls = nullptr;         // of sphere after sphere the points' x, y and z in the pose
  float* hull_margins = nullptr;  // how far from the points' hull the sphere's vertices are at most
};

// The bodies whose spheres are paired: one body with itself, or two bodies.
struct Bodies {
  const PosedClusters &a, &b;
  bool are_one;
};

}  // namespace spherechain

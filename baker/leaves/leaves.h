// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "bind/bind.h"
#include "bind/bind_bones.h"

namespace spherechain::baker {

struct Influence {
  Index bone;
  float weight;

  bool operator==(const Influence&) const = default;
};

struct MorphDelta {
  Index target;
  Vec3 delta;  // exactly representable as float

  bool operator==(const MorphDelta&) const = default;
};

// Stands for the source vertices that have its rest position and move as it does.
struct SurfaceVertex {
  Index source;                       // the lowest of them
  Index weld;                         // the lowest surface vertex at the same rest position
  std::vector<Influence> influences;  // bones ascending; none where nothing moves the source
  std::vector<MorphDelta> morphs;     // targets ascending
};

// About a float centre, with float extents: contains its points to the last bit.
struct Box {
  Vec3 center, half;
  double radius;  // how far from the centre they reach
};

// A bone's mid weight over a leaf's vertices, and the greatest distance of a weight from it. In single precision, as
// the asset has them; a leaf's mid weights add up to 1.
struct LeafBone {
  Index bone;
  float weight, deviation;
};

// Around the deltas of a leaf's vertices, zero where a vertex has none.
struct LeafMorph {
  Index target;
  Ball ball;
};

// A compact cluster of triangles of one surrounding region. Balls have float centres and radii and contain their points
// to the last bit.
struct Leaf {
  std::uint32_t sphere;
  std::vector<Index> triangles;            // of Character::skin, in the order of their source triangles
  std::vector<Index> vertices;             // of Leaves::vertices, ascending; at most 255
  Ball ball{Vec3::Zero(), 0};              // around them at rest
  Box box{Vec3::Zero(), Vec3::Zero(), 0};  // the same, along the axes
  std::vector<LeafBone> bones;             // ascending
  std::vector<LeafMorph> morphs;
};

// How far the parts a bone has of vertices are off their means of an outline's points: |w (v - center; 1)|, in single
// precision.
struct OutlineBone {
  Index bone;
  std::array<float, 4> off;
};

// Points near whose hull a sphere's vertices stay in every pose (schema::Outline). Nothing where it has no leaves.
struct Outline {
  std::vector<Index> points;  // of Leaves::vertices; a multiple of 16, of which the last may be there often
  std::vector<OutlineBone> bones;
  Vec3 center = Vec3::Zero();  // exactly representable as float, as the next two
  double radius = 0, slack = 0;
};

struct Leaves {
  std::vector<Leaf> leaves;             // in sphere order
  std::vector<Outline> outlines;        // the spheres'; none where nothing moves the source
  std::vector<SurfaceVertex> vertices;  // in the order of the first leaf they are in
  std::vector<Index> vertex_of_source;  // kNoIndex where no triangle of the skin uses it
};

struct LeafSettings {
  int triangles = 64;  // of a leaf, at most; 4 to 64
  // 2, 4 or 8: spheres are roots, and what has more triangles than a leaf may have is divided into so many children, of
  // which the lowest are the leaves. 0: the fewest leaves.
  int branching = 0;
};

// `rig_weights` as in bind_bones().
Leaves make_leaves(const Character& character, const Binding& binding, const BoneBinding& bones,
                   const std::vector<VertexWeights>& rig_weights, const LeafSettings& settings);

// make_leaves' parts.

// `triangles` cut into the fewest clusters that the settings allow, of even size, across where they are longest; in an
// order in which neighbours are near each other.
std::vector<std::vector<Index>> cluster_triangles(const Mesh& mesh, const std::vector<Index>& triangles,
                                                  const LeafSettings& settings);

// All source vertices that are corners of the skin, by source vertex; welds and places are the source's own yet.
std::vector<SurfaceVertex> surface_vertices(const Character& character, const BoneBinding& bones,
                                            const std::vector<VertexWeights>& rig_weights,
                                            std::vector<Index>& vertex_of_source);

// `of_spheres`: the vertices of each sphere's leaves, in any order.
std::vector<Outline> outline_spheres(const Character& character, const std::vector<SurfaceVertex>& vertices,
                                     std::vector<std::vector<Index>> of_spheres);

// Fills in a leaf's ball, box, bones and morphs from its vertices.
void bound_leaf(const Character& character, const std::vector<SurfaceVertex>& vertices, Leaf& leaf);

}  // namespace spherechain::baker

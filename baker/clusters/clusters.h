// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "baker/bind/bind.h"
#include "baker/bind/bind_bones.h"

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

// One vertex for all source vertices that have the same rest position and move alike.
struct SurfaceVertex {
  Index source;                       // the lowest of them
  Index weld;                         // the lowest surface vertex at the same rest position
  std::vector<Influence> influences;  // bones ascending; none where nothing moves the source
  std::vector<MorphDelta> morphs;     // targets ascending
};

// A box along the axes that contains its points to the last bit. All values are exactly representable as float.
struct ClusterBox {
  Vec3 center, half;
  double radius;  // distance of the farthest point from the centre
};

// The middle of a bone's weights over a cluster's vertices, and how far a weight is from it at most. The middles of a
// cluster's bones add up to 1.
struct ClusterBone {
  Index bone;
  float weight, deviation;
};

// A ball around the deltas of a cluster's vertices; a vertex that the target does not move counts as zero.
struct ClusterMorph {
  Index target;
  Ball ball;
};

// A compact group of one sphere's triangles, of one piece of the skin. Its balls have float centres and radii and
// contain their points to the last bit.
struct Cluster {
  std::uint32_t sphere;
  std::vector<Index> triangles;                   // of Character::skin, in the order of their source triangles
  std::vector<Index> vertices;                    // of Clusters::vertices, ascending; at most 255
  ClusterBox box{Vec3::Zero(), Vec3::Zero(), 0};  // around them at rest
  std::vector<ClusterBone> bones;                 // ascending
  std::vector<ClusterMorph> morphs;
};

// A sphere's vertices v are means of its hull's points, but for a rest. `off` bounds that rest as bone b moves it: the
// magnitudes of the four components of w_b (v - center; 1), over all vertices.
struct HullBone {
  Index bone;
  std::array<float, 4> off;
};

// A hull that stays near all vertices of a sphere in every pose. Empty if the sphere has no clusters.
struct Hull {
  std::vector<Index> points;  // of Clusters::vertices; a multiple of 16: the last one is repeated
  std::vector<HullBone> bones;
  Vec3 center = Vec3::Zero();  // exactly representable as float, as the next two
  double radius = 0, slack = 0;
};

// All clusters of a character.
struct Clusters {
  std::vector<Cluster> clusters;        // in sphere order
  std::vector<Hull> hulls;              // one a sphere; none where nothing moves the source
  std::vector<SurfaceVertex> vertices;  // in the order of the first cluster they are in
  std::vector<Index> vertex_of_source;  // kNoIndex where no triangle of the skin uses it
};

struct ClusterSettings {
  int triangles = 64;  // of a cluster, at most; 4 to 64
  // 0: as few clusters as possible. 2, 4 or 8: each piece of a sphere's skin is the root of a tree. A node with too
  // many triangles for a cluster is divided into so many children; the lowest nodes are the clusters.
  int branching = 0;
};

// `rig_weights` as in bind_bones().
Clusters make_clusters(const Character& character, const Binding& binding, const BoneBinding& bones,
                       const std::vector<VertexWeights>& rig_weights, const ClusterSettings& settings);

// make_clusters' parts.

// Divides triangles into as few groups as the settings allow, all of about the same size. Each cut is across the
// longest extent; groups that follow each other are near each other.
std::vector<std::vector<Index>> cluster_triangles(const Mesh& mesh, const std::vector<Index>& triangles,
                                                  const ClusterSettings& settings);

// The surface vertices of all corners of the skin, in the order of the source. Their welds are vertices of the skin,
// which make_clusters replaces.
std::vector<SurfaceVertex> surface_vertices(const Character& character, const BoneBinding& bones,
                                            const std::vector<VertexWeights>& rig_weights,
                                            std::vector<Index>& vertex_of_source);

// `of_spheres`: the vertices of each sphere's clusters, in any order. Returns one hull a sphere.
std::vector<Hull> make_hulls(const Character& character, const std::vector<SurfaceVertex>& vertices,
                             std::vector<std::vector<Index>> of_spheres);

// Fills in a cluster's box, bones and morphs from its vertices.
void bound_cluster(const Character& character, const std::vector<SurfaceVertex>& vertices, Cluster& cluster);

}  // namespace spherechain::baker

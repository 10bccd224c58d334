// SPDX-License-Identifier: MIT
// The data that the stages of a step job hand to each other.
#pragma once

#include "runtime/src/clusters/posed_clusters.h"

namespace spherechain {

// A skin between two poses of one step, or of a piece of it. Vertices go straight from where they start to where they
// end, but for `strays`.
struct MovingSkin {
  const PosedClusters &start, &end;
  // Scratch memory.
  float* strays;  // of a sphere: how far a vertex may be off its straight line; find_moving_spheres() adds roundings
  BoxColumns spheres, clusters;  // around all of the way
  std::uint8_t* is_swept;        // a sphere's: are its clusters' boxes there?
};

struct MovingBodies {
  const MovingSkin &a, &b;
  bool are_one;
};

// Two triangles that may touch on the way. Corners at the start, and at the end.
struct MovingCandidate {
  std::size_t cluster_a, cluster_b;
  std::size_t triangle_a, triangle_b;  // in Surface::triangles of body a and of body b
  float stray;                         // of corners of both, added
  TriangleCorners a[2], b[2];
};

class StepCollector;

// Pairs of clusters that may touch on the way.
struct MovingClusters {
  Pair* pairs;
  std::size_t room;
  // Null, or: what takes them in whenever there is no more room.
  void (*take)(void* user, Span<const Pair> pairs);
  void* user;
  std::size_t count = 0;

  bool put(std::size_t a, std::size_t b);  // false: no room
};

// Lists the pairs of spheres that may touch on the way. `pairs` has room for all that there are. The skins then have
// their spheres' boxes.
void find_moving_spheres(Target resolved, const MovingBodies& bodies, Span<Pair>& pairs);

// Lists the pairs of their clusters that may. False where there was no room for all. The clusters then are loaded.
bool find_moving_clusters(Target resolved, const MovingBodies& bodies, Span<const Pair> spheres, MovingClusters& found);

// Hands the collector all triangles of the clusters that touch on the way, and a few more.
void find_moving_candidates(Target resolved, const MovingBodies& bodies, Span<const Pair> clusters,
                            StepCollector& collector);

}  // namespace spherechain

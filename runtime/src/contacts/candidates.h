// SPDX-License-Identifier: MIT
// Pairs of triangles that may intersect: the kernel finds them, the collector decides.
#pragma once

#include <cstddef>

#include "runtime/src/clusters/posed_clusters.h"
#include "runtime/src/triangles/exact_triangles.h"

namespace spherechain {

class ContactCollector;  // where triangles that intersect go

// Two triangles of two clusters whose boxes touch, and whose planes may cross: the decision.
struct Candidate {
  std::size_t cluster_a, cluster_b;
  std::size_t triangle_a, triangle_b;  // in Surface::triangles of body a and of body b
  TriangleCorners a, b;
  bool meets;  // is known to: no more to decide
};

// Hands all candidates that there are, and a few more, to the collector.
void find_candidates(Target resolved, const Bodies& bodies, ContactCollector& collector);

}  // namespace spherechain

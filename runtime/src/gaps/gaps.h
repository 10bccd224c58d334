// SPDX-License-Identifier: MIT
// How near do parts of a body come to each other, or to those of another body, where they do not meet?
#pragma once

#include "runtime/src/base/double3.h"
#include "runtime/src/clusters/posed_clusters.h"
#include "runtime/src/skin/job_body.h"

namespace spherechain {

// Two spots of the outer skin that face each other.
struct Gap {
  std::uint32_t part, other;
  Double3 at, at_other;
  double distance;
};

// All is checked before. Layers of one place, ignored pairs of spheres, skin that is near at rest and skin that touches
// have no gap.
struct GapJob {
  JobBody a, b;  // of one body: the same
  bool are_one = true;
  const std::uint64_t* part_pairs = nullptr;  // bit p n + q: part p of a and q of b, which has n parts, are asked about
  double margin = 0;                          // in the pose's units: what is farther apart has no gap
  double patch = 0;                           // of two parts, spots within this distance of each other are one gap
  Target target{};                            // resolved
  std::uint64_t* scratch = nullptr;           // gap_scratch_words() of them
  Span<Gap> gaps;                             // out: the narrowest that there is room for
  std::size_t count = 0;                      // of them

  void run();
};

std::size_t gap_scratch_words(const AssetView& a, const AssetView& b);

// A cluster in the pose: its vertices, coordinate by coordinate.
struct NearCluster {
  std::size_t cluster;
  const float* axes[3];
  float low[3], high[3];
};

// Gets the pairs of clusters that may come within a margin of each other: all of them, and a few more.
class NearClusters {
 public:
  virtual bool asks(std::size_t sphere_a, std::size_t sphere_b) const = 0;
  virtual bool leaves_out(std::size_t cluster_a, std::size_t cluster_b) const = 0;
  virtual void add(const NearCluster& a, const NearCluster& b) = 0;

 protected:
  ~NearClusters() = default;
};
void find_near(Target resolved, const PosedClusters& a, const PosedClusters& b, float margin, NearClusters& found);

}  // namespace spherechain

// SPDX-License-Identifier: MIT
// Bounds spheres and clusters of a posed skin when they are needed.
#include "runtime/src/simd/highway.h"

#if defined(SPHERECHAIN_BOUNDS_ON_DEMAND_H) == defined(HWY_TARGET_TOGGLE)  // once a target
#ifdef SPHERECHAIN_BOUNDS_ON_DEMAND_H
#undef SPHERECHAIN_BOUNDS_ON_DEMAND_H
#else
#define SPHERECHAIN_BOUNDS_ON_DEMAND_H
#endif

#include <cstring>

#include "runtime/src/base/pair_bits.h"
#include "runtime/src/clusters/hulls.h"
#include "runtime/src/clusters/posed_clusters.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

// Bounds of the clusters of spheres [first, end).
inline HWY_NOINLINE void bound_clusters(const PosedClusters& posed, std::size_t first, std::size_t end) {
  std::memset(posed.is_bounded + first, 1, end - first);
  const std::size_t first_cluster = posed.first_cluster[first], end_cluster = posed.first_cluster[end];
  if (posed.has_balls) {
    bound_clusters_by_bones(posed, first_cluster, end_cluster);
    return;
  }
  const Cluster* const clusters = posed.surface->clusters.data;
  for (std::size_t i = first_cluster; i < end_cluster; ++i) {
    const Box box = box_of_cluster(posed, clusters[i]);
    put_box(posed.clusters, i, is_within(box, kPointSize / 2) ? kEmptyBox : box);
  }
}

HWY_INLINE void bound_once(const PosedClusters& posed, std::size_t sphere) {
  if (posed.is_bounded[sphere] == 0) {
    bound_clusters(posed, sphere, sphere + 1);
  }
}

// A sphere's box by its hull; by its clusters where it may be a point, whose boxes then are empty.
HWY_INLINE void bound_sphere(const PosedClusters& posed, std::size_t sphere) {
  bound_hull(posed, sphere);
  if (HWY_UNLIKELY(is_within(box_at(posed.spheres, sphere), kPointReach))) {
    bound_once(posed, sphere);
    unite_clusters(posed, sphere);
  }
}

// Boxes of the spheres: by their hulls; else of those whose clusters are bounded, of all of them before this. Vectors
// that are loaded right after their lanes were stored one by one have to wait.
inline HWY_NOINLINE void bound_spheres(const PosedClusters& posed) {
  for (std::size_t s = 0; s < posed.sphere_count; ++s) {
    if (posed.has_hulls) {
      bound_sphere(posed, s);
    } else if (posed.is_bounded[s] != 0) {
      unite_clusters(posed, s);
    }
  }
}

// All of the spheres' boxes.
HWY_INLINE void bound(const PosedClusters& posed) {
  if (!posed.has_hulls) {
    bound_clusters(posed, 0, posed.sphere_count);
  }
  bound_spheres(posed);
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#endif

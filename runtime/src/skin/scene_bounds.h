// SPDX-License-Identifier: MIT
// A scene's boxes of spheres and of clusters, as they are needed.
#include "simd/highway.h"

#if defined(SPHERECHAIN_SKIN_SCENE_BOUNDS_H) == defined(HWY_TARGET_TOGGLE)  // once a target
#ifdef SPHERECHAIN_SKIN_SCENE_BOUNDS_H
#undef SPHERECHAIN_SKIN_SCENE_BOUNDS_H
#else
#define SPHERECHAIN_SKIN_SCENE_BOUNDS_H
#endif

#include <cstring>

#include "pairs/pair_bits.h"
#include "skin/hulls.h"
#include "skin/scene.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

// Bounds of the clusters of spheres [first, end).
inline HWY_NOINLINE void bound_clusters(const ContactScene& scene, std::size_t first, std::size_t end) {
  std::memset(scene.is_bounded + first, 1, end - first);
  const std::size_t first_cluster = scene.first_cluster[first], end_cluster = scene.first_cluster[end];
  if (scene.has_balls) {
    bound_clusters_by_bones(scene, first_cluster, end_cluster);
    return;
  }
  const Cluster* const clusters = scene.surface->clusters.data;
  for (std::size_t i = first_cluster; i < end_cluster; ++i) {
    const Box box = box_of_cluster(scene, clusters[i]);
    put_box(scene.clusters, i, is_within(box, kPointSize / 2) ? kEmptyBox : box);
  }
}

HWY_INLINE void bound_once(const ContactScene& scene, std::size_t sphere) {
  if (scene.is_bounded[sphere] == 0) {
    bound_clusters(scene, sphere, sphere + 1);
  }
}

// A sphere's box by its hull; by its clusters where it may be a point, whose boxes then are empty.
HWY_INLINE void bound_sphere(const ContactScene& scene, std::size_t sphere) {
  bound_hull(scene, sphere);
  if (HWY_UNLIKELY(is_within(box_at(scene.spheres, sphere), kPointReach))) {
    bound_once(scene, sphere);
    unite_clusters(scene, sphere);
  }
}

// Boxes of the spheres: by their hulls; else of those whose clusters are bounded, of all of them before this. Vectors
// that are loaded right after their lanes were stored one by one have to wait.
inline HWY_NOINLINE void bound_spheres(const ContactScene& scene) {
  for (std::size_t s = 0; s < scene.sphere_count; ++s) {
    if (scene.has_hulls) {
      bound_sphere(scene, s);
    } else if (scene.is_bounded[s] != 0) {
      unite_clusters(scene, s);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#endif

// SPDX-License-Identifier: MIT
// From boxes of spheres to boxes of clusters to the triangles that a line crosses.
#include <cfloat>

#include "runtime/src/base/pair_bits.h"
#include "runtime/src/inside/inside.h"
#include "runtime/src/simd/simd.h"
#include "runtime/src/triangles/crossing.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/src/inside/inside_kernel.cpp"
#include "runtime/src/clusters/blocks.h"
#include "runtime/src/clusters/bounds_on_demand.h"
#include "runtime/src/simd/highway.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

HWY_INLINE void cross_cluster(const PosedClusters& skin, std::size_t cluster, const BoxProbe& box, const Line& line,
                              Crossings& found) {
  if (skin.is_loaded[cluster] == 0) {
    load(skin, cluster);
  }
  Block block;
  if (!load_block(skin, cluster, box, block)) {
    return;
  }
  for (std::size_t i = 0; i < block.count; ++i) {
    float corners[3][3];
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        corners[k][axis] = block.corners[k][axis][i];
      }
    }
    const Crossing crossing = cross_line(corners, line.from, line.axis);
    if (crossing.side != 0 && (crossing.height > 0 ? line.goes_up : line.goes_down)) {
      found.add(block.triangles[i], crossing.side, crossing.height);
    }
  }
}

// Looks with a box as thin as the line. Targets may find different triangles that the line misses; none misses a
// triangle that it crosses.
void follow_line(const PosedClusters& skin, const Line& line, Crossings& found) {
  if (!skin.has_sphere_boxes) {
    bound(skin);
  }
  Box thin;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    thin.low[axis] = axis == line.axis && line.goes_down ? -FLT_MAX : line.from[axis];
    thin.high[axis] = axis == line.axis && line.goes_up ? FLT_MAX : line.from[axis];
  }
  const BoxProbe box(thin);
  const std::size_t count = skin.sphere_count;
  for (std::size_t first = 0; first < count; first += kLanes) {
    for (std::uint64_t bits = box.touching(skin.spheres, first, count - first); bits != 0; bits &= bits - 1) {
      const std::size_t sphere = first + lowest_bit(bits), end = skin.first_cluster[sphere + 1];
      bound_once(skin, sphere);
      for (std::size_t c = skin.first_cluster[sphere]; c < end; c += kLanes) {
        for (std::uint64_t met = box.touching(skin.clusters, c, end - c); met != 0; met &= met - 1) {
          cross_cluster(skin, c + lowest_bit(met), box, line, found);
        }
      }
    }
  }
}

void load_corners(const PosedClusters& skin, std::uint32_t triangle, float (&out)[3][3]) {
  const Surface& surface = *skin.surface;
  std::size_t c = surface.first_clusters[surface.triangle_spheres[triangle]];
  while (triangle >= surface.clusters[c].first_triangle + std::uint32_t{surface.clusters[c].triangle_count}) {
    ++c;
  }
  if (skin.is_loaded[c] == 0) {
    load(skin, c);
  }
  const Slots slots = slots_of(skin, c);
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      out[k][axis] = slots.axes[axis][surface.corners[3 * std::size_t{triangle} + k]];
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace spherechain {
namespace {

SPHERECHAIN_KERNELS(follow_line);
SPHERECHAIN_KERNELS(load_corners);

}  // namespace

void follow(Target resolved, const PosedClusters& skin, const Line& line, Crossings& found) {
  follow_line_kernels[index_of(resolved)](skin, line, found);
}

void find_corners(Target resolved, const PosedClusters& skin, std::uint32_t triangle, float (&out)[3][3]) {
  load_corners_kernels[index_of(resolved)](skin, triangle, out);
}

}  // namespace spherechain
#endif

// SPDX-License-Identifier: MIT
// From boxes of spheres to boxes of clusters that come within a margin of each other.
#include <cfloat>

#include "runtime/src/base/pair_bits.h"
#include "runtime/src/gaps/gaps.h"
#include "runtime/src/simd/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/src/gaps/gaps_kernel.cpp"
#include "runtime/src/clusters/blocks.h"
#include "runtime/src/clusters/bounds_on_demand.h"
#include "runtime/src/simd/highway.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

// By more than the margin: what is added is more than the roundings.
HWY_INLINE Box widened(const Box& box, float margin) {
  constexpr float kShare = 0x1p-20F;
  Box out = box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float low = out.low[axis], high = out.high[axis];
    out.low[axis] = low - margin - kShare * (margin + (low < 0 ? -low : low));
    out.high[axis] = high + margin + kShare * (margin + (high < 0 ? -high : high));
  }
  return out;
}

HWY_INLINE NearCluster near_cluster(const PosedClusters& posed, std::size_t cluster) {
  if (posed.is_loaded[cluster] == 0) {
    load(posed, cluster);
  }
  const Slots slots = slots_of(posed, cluster);
  const Box box = box_of_span(posed, cluster);
  NearCluster out{cluster, {slots.axes[0], slots.axes[1], slots.axes[2]}, {}, {}};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    out.low[axis] = box.low[axis];
    out.high[axis] = box.high[axis];
  }
  return out;
}

// Targets may find different clusters that are farther apart than the margin; none misses one that is not.
void find_near_clusters(const PosedClusters& a, const PosedClusters& b, float margin, NearClusters& found) {
  for (const PosedClusters* posed : {&a, &b}) {
    if (!posed->has_sphere_boxes && (posed == &a || &a != &b)) {
      bound(*posed);
    }
  }
  for (std::size_t s = 0; s < a.sphere_count; ++s) {
    const BoxProbe around(widened(box_at(a.spheres, s), margin));
    for (std::size_t first = 0; first < b.sphere_count; first += kLanes) {
      for (std::uint64_t bits = around.touching(b.spheres, first, b.sphere_count - first); bits != 0;
           bits &= bits - 1) {
        const std::size_t other = first + lowest_bit(bits);
        if (!found.asks(s, other)) {
          continue;
        }
        bound_once(a, s);
        bound_once(b, other);
        const std::size_t end = b.first_cluster[other + 1];
        for (std::size_t c = a.first_cluster[s]; c < a.first_cluster[s + 1]; ++c) {
          const BoxProbe box(widened(box_at(a.clusters, c), margin));
          for (std::size_t d = b.first_cluster[other]; d < end; d += kLanes) {
            for (std::uint64_t met = box.touching(b.clusters, d, end - d); met != 0; met &= met - 1) {
              const std::size_t near = d + lowest_bit(met);
              if (!found.leaves_out(c, near)) {
                found.add(near_cluster(a, c), near_cluster(b, near));
              }
            }
          }
        }
      }
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace spherechain {
namespace {

SPHERECHAIN_KERNELS(find_near_clusters);

}  // namespace

void find_near(Target resolved, const PosedClusters& a, const PosedClusters& b, float margin, NearClusters& found) {
  find_near_clusters_kernels[index_of(resolved)](a, b, margin, found);
}

}  // namespace spherechain
#endif

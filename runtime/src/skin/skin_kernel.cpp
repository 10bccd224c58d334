// SPDX-License-Identifier: MIT
#include "runtime/src/base/arithmetic.h"
#include "runtime/src/simd/simd.h"
#include "runtime/src/skin/skin_inputs.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/src/skin/skin_kernel.cpp"
#include "runtime/src/simd/highway.h"
#include "runtime/src/skin/skin_cluster.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

// Skins the listed clusters, or all if the list is null. Vertices go to their own place, or to their source vertex'.
void skin_all(const SkinInputs& in, Span<const std::uint32_t> listed, bool by_source, float* positions,
              std::size_t stride) {
  const Surface& surface = *in.surface;
  static_assert(kMaxClusterVertices % kSlotLanes == 0, "as many slots");
  HWY_ALIGN float x[kMaxClusterVertices], y[kMaxClusterVertices], z[kMaxClusterVertices];
  const std::size_t count = listed.data == nullptr ? surface.clusters.size : listed.size;
  for (std::size_t i = 0; i < count; ++i) {
    const Cluster& cluster = surface.clusters.data[listed.data == nullptr ? i : listed.data[i]];
    skin_cluster(in, cluster, x, y, z);
    for (std::size_t slot = 0; slot < cluster.vertex_count; ++slot) {
      const std::uint32_t vertex = surface.cluster_vertices.data[cluster.first_vertex + slot];
      float* out = positions + stride * (by_source ? surface.source_vertices.data[vertex] : vertex);
      out[0] = x[slot];
      out[1] = y[slot];
      out[2] = z[slot];
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace spherechain {
namespace {

SPHERECHAIN_KERNELS(skin_all);

}  // namespace

void skin_surface(const Surface& surface, const Pose& pose, Target resolved, float* positions, std::size_t stride) {
  skin_all_kernels[index_of(resolved)]({&surface, matrices_of(pose), pose.morph_weights}, {}, true, positions, stride);
}

void skin_vertices(const Surface& surface, const Pose& pose, Target resolved, Span<const std::uint32_t> clusters,
                   float* positions) {
  skin_all_kernels[index_of(resolved)]({&surface, matrices_of(pose), pose.morph_weights}, clusters, false, positions,
                                       3);
}

}  // namespace spherechain
#endif

// SPDX-License-Identifier: MIT
#include "arithmetic.h"
#include "simd.h"
#include "skin.h"
#include "skin_surface.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "skin_kernel.cpp"
#include "highway.h"
#include "skin_leaf.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

void skin_all(const SkinInputs& in, const SurfacePlaces& places, float* positions, std::size_t stride) {
  HWY_ALIGN float x[kMaxLeafSlots], y[kMaxLeafSlots], z[kMaxLeafSlots];
  for (std::size_t i = 0; i < places.leaf_count; ++i) {
    const Leaf& leaf = places.leaves[i];
    skin_leaf(in, leaf, x, y, z);
    for (std::size_t slot = 0; slot < leaf.vertex_count; ++slot) {
      float* out = positions + stride * places.source_vertices[places.leaf_vertices[leaf.first_vertex + slot]];
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

void skin_surface(const SkinInputs& inputs, const SurfacePlaces& places, Target resolved, float* positions,
                  std::size_t stride) {
  skin_all_kernels[index_of(resolved)](inputs, places, positions, stride);
}

}  // namespace spherechain
#endif

// SPDX-License-Identifier: MIT
// Where may two bodies meet that bones move? Boxes of their spheres there; empty ones of all other spheres.
#include "runtime/src/simd/highway.h"

#if defined(SPHERECHAIN_SKIN_BOUNDS_OF_TWO_H) == defined(HWY_TARGET_TOGGLE)  // once a target
#ifdef SPHERECHAIN_SKIN_BOUNDS_OF_TWO_H
#undef SPHERECHAIN_SKIN_BOUNDS_OF_TWO_H
#else
#define SPHERECHAIN_SKIN_BOUNDS_OF_TWO_H
#endif

#include <cfloat>

#include "runtime/src/clusters/bounds_on_demand.h"
#include "runtime/src/clusters/posed_clusters.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

// A box around the boxes of a sphere's bones, of every sphere: its vertices are means of where those move them.
inline HWY_NOINLINE void bound_by_bones(const PosedClusters& posed) {
  for (std::size_t s = 0; s < posed.sphere_count; ++s) {
    const Hull& hull = posed.surface->hulls.data[s];
    const HullBone* const bones = posed.surface->hull_bones.data + hull.first_bone;
    Box box = kEmptyBox;
    for (std::size_t k = 0; k < hull.bone_count; ++k) {
      const float* const of_bone = posed.bone_boxes + 6 * std::size_t{bones[k].bone};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        box.low[axis] = of_bone[axis] < box.low[axis] ? of_bone[axis] : box.low[axis];
        box.high[axis] = of_bone[3 + axis] > box.high[axis] ? of_bone[3 + axis] : box.high[axis];
      }
    }
    put_box(posed.spheres, s, box);
  }
}

// Intersects each sphere's box with `room` and returns the box around these intersections.
inline HWY_NOINLINE Box narrow(const PosedClusters& posed, const Box& room) {
  Box out = kEmptyBox;
  for (std::size_t s = 0; s < posed.sphere_count; ++s) {
    const Box box = box_at(posed.spheres, s);
    if (box.touches(room)) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const float low = box.low[axis] > room.low[axis] ? box.low[axis] : room.low[axis];
        const float high = box.high[axis] < room.high[axis] ? box.high[axis] : room.high[axis];
        out.low[axis] = low < out.low[axis] ? low : out.low[axis];
        out.high[axis] = high > out.high[axis] ? high : out.high[axis];
      }
    }
  }
  return out;
}

inline HWY_NOINLINE void bound_two(const Bodies& bodies) {
  const PosedClusters* const scenes[] = {&bodies.a, &bodies.b};
  Box room{{-FLT_MAX, -FLT_MAX, -FLT_MAX}, {FLT_MAX, FLT_MAX, FLT_MAX}};
  for (const PosedClusters* posed : scenes) {
    bound_by_bones(*posed);
    room = narrow(*posed, room);
  }
  for (const PosedClusters* posed : scenes) {
    room = narrow(*posed, room);
  }
  for (const PosedClusters* posed : scenes) {
    for (std::size_t s = 0; s < posed->sphere_count; ++s) {
      if (box_at(posed->spheres, s).touches(room)) {
        bound_sphere(*posed, s);
      } else {
        put_box(posed->spheres, s, kEmptyBox);
      }
    }
    room = narrow(*posed, room);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#endif

// SPDX-License-Identifier: MIT
// One cluster's vertices in a pose, a slot a lane; docs/arithmetic.md has the arithmetic.
#include "runtime/src/simd/highway.h"

#if defined(SPHERECHAIN_SKIN_SKIN_CLUSTER_H) == defined(HWY_TARGET_TOGGLE)  // once a target
#ifdef SPHERECHAIN_SKIN_SKIN_CLUSTER_H
#undef SPHERECHAIN_SKIN_SKIN_CLUSTER_H
#else
#define SPHERECHAIN_SKIN_SKIN_CLUSTER_H
#endif

#include "runtime/src/skin/skin_inputs.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

HWY_INLINE float fused_one(float a, float b, float c) {
#if SPHERECHAIN_FUSES
  const hn::CappedTag<float, 1> d;
  return hn::GetLane(hn::MulAdd(hn::Set(d, a), hn::Set(d, b), hn::Set(d, c)));
#else
  return fused_multiply_add(a, b, c);
#endif
}

// kParts registers of slots from `slot` on.
template <std::size_t kParts, class D>
HWY_INLINE void move_slots(D d, const SkinInputs& in, const Cluster& cluster, std::size_t slots, std::size_t slot,
                           const float* const (&rest)[3], float* const (&out)[3]) {
  constexpr std::size_t kWidth = hn::MaxLanes(D());
  hn::Vec<D> p[3][kParts], a[3][kParts];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t part = 0; part < kParts; ++part) {
      p[axis][part] = hn::LoadU(d, rest[axis] + slot + part * kWidth);
      a[axis][part] = hn::Zero(d);
    }
  }
  const std::uint32_t* const bones = in.surface->cluster_bones.data + cluster.first_bone;
  const float* weights = in.surface->slot_weights.data + cluster.first_weight + slot;
  const std::size_t row_step = in.bones.row, column_step = in.bones.column;
  for (std::size_t bone = 0; bone < cluster.bone_count; ++bone, weights += slots) {
    const float* row = in.bones.data + bones[bone] * in.bones.stride;
    for (std::size_t axis = 0; axis < 3; ++axis, row += row_step) {
      const auto m0 = hn::Set(d, row[0]), m1 = hn::Set(d, row[column_step]), m2 = hn::Set(d, row[2 * column_step]),
                 m3 = hn::Set(d, row[3 * column_step]);
      for (std::size_t part = 0; part < kParts; ++part) {
        const auto moved = fused(d, m2, p[2][part], fused(d, m1, p[1][part], fused(d, m0, p[0][part], m3)));
        a[axis][part] = fused(d, hn::LoadU(d, weights + part * kWidth), moved, a[axis][part]);
      }
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t part = 0; part < kParts; ++part) {
      hn::Store(a[axis][part], d, out[axis] + slot + part * kWidth);
    }
  }
}

// x, y, z: room for kMaxClusterVertices, aligned for the target's registers. As many are written as the cluster has
// slots: those beyond its vertices repeat the last one.
HWY_INLINE void skin_cluster(const SkinInputs& in, const Cluster& cluster, float* HWY_RESTRICT x, float* HWY_RESTRICT y,
                             float* HWY_RESTRICT z) {
  constexpr hn::CappedTag<float, kSlotLanes> d;
  const std::size_t slots = (cluster.vertex_count + kSlotLanes - 1) / kSlotLanes * kSlotLanes;
  const float* rest[3];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    rest[axis] = in.surface->slot_positions.data + 3 * std::size_t{cluster.first_slot} + axis * slots;
  }
  if (in.morph_weights != nullptr && cluster.morph_count > 0) {
    float* const morphed[3] = {x, y, z};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t slot = 0; slot < slots; slot += hn::MaxLanes(d)) {
        hn::Store(hn::LoadU(d, rest[axis] + slot), d, morphed[axis] + slot);
      }
      rest[axis] = morphed[axis];
    }
    const SlotMorph* const end = in.surface->slot_morphs.data + cluster.first_morph + cluster.morph_count;
    for (const SlotMorph* morph = end - cluster.morph_count; morph != end; ++morph) {
      const float weight = in.morph_weights[morph->target];
      if (weight != 0) {
        x[morph->slot] = fused_one(weight, morph->delta.x, x[morph->slot]);
        y[morph->slot] = fused_one(weight, morph->delta.y, y[morph->slot]);
        z[morph->slot] = fused_one(weight, morph->delta.z, z[morph->slot]);
      }
    }
  }
  float* const out[3] = {x, y, z};
  std::size_t slot = 0;
#if HWY_TARGET == HWY_AVX3
  const hn::CappedTag<float, 2 * kSlotLanes> wide;
  for (; slot + 4 * kSlotLanes <= slots; slot += 4 * kSlotLanes) {
    move_slots<2>(wide, in, cluster, slots, slot, rest, out);
  }
  for (; slot + 2 * kSlotLanes <= slots; slot += 2 * kSlotLanes) {
    move_slots<1>(wide, in, cluster, slots, slot, rest, out);
  }
#elif HWY_TARGET == HWY_AVX2
  for (; slot + 2 * kSlotLanes <= slots; slot += 2 * kSlotLanes) {
    move_slots<2>(d, in, cluster, slots, slot, rest, out);
  }
#endif
  for (; slot < slots; slot += hn::MaxLanes(d)) {
    move_slots<1>(d, in, cluster, slots, slot, rest, out);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#endif

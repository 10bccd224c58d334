// SPDX-License-Identifier: MIT
// One leaf's vertices in a pose, a slot a lane; the arithmetic is SkinJob's. Included by files of kernels once a
// target, after highway.h; no include guard.
#include "skin.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

HWY_INLINE float fused_one(float a, float b, float c) {
#if SPHERECHAIN_FUSES
  namespace hn = hwy::HWY_NAMESPACE;
  const hn::CappedTag<float, 1> d;
  return hn::GetLane(hn::MulAdd(hn::Set(d, a), hn::Set(d, b), hn::Set(d, c)));
#else
  return fused_multiply_add(a, b, c);
#endif
}

// x, y, z: room for kMaxLeafSlots, aligned for the target's registers. As many are written as the leaf has slots: those
// beyond its vertices repeat the last one.
HWY_INLINE void skin_leaf(const SkinInputs& in, const Leaf& leaf, float* HWY_RESTRICT x, float* HWY_RESTRICT y,
                          float* HWY_RESTRICT z) {
  namespace hn = hwy::HWY_NAMESPACE;
  constexpr hn::CappedTag<float, kSlotLanes> d;
  const std::size_t slots = (leaf.vertex_count + kSlotLanes - 1) / kSlotLanes * kSlotLanes;
  const float* rest[3];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    rest[axis] = in.slot_positions + 3 * std::size_t{leaf.first_slot} + axis * slots;
  }
  if (in.morph_weights != nullptr && leaf.morph_count > 0) {
    float* const morphed[3] = {x, y, z};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t slot = 0; slot < slots; slot += hn::MaxLanes(d)) {
        hn::Store(hn::LoadU(d, rest[axis] + slot), d, morphed[axis] + slot);
      }
      rest[axis] = morphed[axis];
    }
    const SlotMorph* const end = in.slot_morphs + leaf.first_morph + leaf.morph_count;
    for (const SlotMorph* morph = end - leaf.morph_count; morph != end; ++morph) {
      const float weight = in.morph_weights[morph->target];
      if (weight != 0) {
        x[morph->slot] = fused_one(weight, morph->delta.x, x[morph->slot]);
        y[morph->slot] = fused_one(weight, morph->delta.y, y[morph->slot]);
        z[morph->slot] = fused_one(weight, morph->delta.z, z[morph->slot]);
      }
    }
  }
  const float* const weights = in.slot_weights + leaf.first_weight;
  const std::uint32_t* const bones = in.leaf_bones + leaf.first_bone;
  for (std::size_t slot = 0; slot < slots; slot += hn::MaxLanes(d)) {
    const auto px = hn::LoadU(d, rest[0] + slot), py = hn::LoadU(d, rest[1] + slot), pz = hn::LoadU(d, rest[2] + slot);
    auto ax = hn::Zero(d), ay = hn::Zero(d), az = hn::Zero(d);
    for (std::size_t bone = 0; bone < leaf.bone_count; ++bone) {
      const float* const m = in.matrices + bones[bone] * in.stride;
      const auto weight = hn::LoadU(d, weights + bone * slots + slot);
      const auto row = [&](const float* r) HWY_ATTR {
        return fused(
            d, hn::Set(d, r[2 * in.column]), pz,
            fused(d, hn::Set(d, r[in.column]), py, fused(d, hn::Set(d, r[0]), px, hn::Set(d, r[3 * in.column]))));
      };
      ax = fused(d, weight, row(m), ax);
      ay = fused(d, weight, row(m + in.row), ay);
      az = fused(d, weight, row(m + 2 * in.row), az);
    }
    hn::Store(ax, d, x + slot);
    hn::Store(ay, d, y + slot);
    hn::Store(az, d, z + slot);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

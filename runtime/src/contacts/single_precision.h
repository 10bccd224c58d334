// SPDX-License-Identifier: MIT
// The answers that single precision can give about pairs of triangles.
#include "runtime/src/simd/highway.h"

#if defined(SPHERECHAIN_SKIN_SINGLE_PRECISION_H) == defined(HWY_TARGET_TOGGLE)  // once a target
#ifdef SPHERECHAIN_SKIN_SINGLE_PRECISION_H
#undef SPHERECHAIN_SKIN_SINGLE_PRECISION_H
#else
#define SPHERECHAIN_SKIN_SINGLE_PRECISION_H
#endif

#include "runtime/src/clusters/blocks.h"
#include "runtime/src/clusters/posed_clusters.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

struct Vector3 {
  Vector x, y, z;
};

HWY_INLINE Vector3 subtract(const Vector3& a, const Vector3& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
// Fused where the target can: the bound below holds either way.
HWY_INLINE Vector3 cross_product(const Vector3& a, const Vector3& b) {
  return {hn::NegMulAdd(a.z, b.y, hn::Mul(a.y, b.z)), hn::NegMulAdd(a.x, b.z, hn::Mul(a.z, b.x)),
          hn::NegMulAdd(a.y, b.x, hn::Mul(a.x, b.y))};
}
HWY_INLINE Vector dot_product(const Vector3& a, const Vector3& b) {
  return hn::MulAdd(a.z, b.z, hn::MulAdd(a.y, b.y, hn::Mul(a.x, b.x)));
}

// The bound of exact_orientation.h for single precision, where u = 2^-24; and what underflow may add, of subnormal
// figures taken as zero: six products, each off by 2^-126 times an extent. Infinite where something could overflow, and
// then nothing is certain.
HWY_INLINE Vector plane_error(const Vector3& extent) {
  constexpr Floats kFloats;
  const Vector sum = hn::Add(hn::Add(extent.x, extent.y), extent.z);
  const Vector rounding = hn::Mul(hn::Mul(hn::Mul(extent.x, extent.y), extent.z), hn::Set(kFloats, 0x1p-18F));
  const Vector underflow = hn::Mul(hn::Add(sum, hn::Set(kFloats, 1)), hn::Set(kFloats, 0x1p-120F));
  const auto fits = hn::Lt(sum, hn::Set(kFloats, 0x1p30F));
  return hn::IfThenElse(fits, hn::Add(rounding, underflow), hn::Inf(kFloats));
}

// Some of a register of triangles of a block, in any order.
struct GatheredTriangles {
  const Block* block;
  std::size_t first;  // of the register
  hn::Vec<hn::Rebind<std::int32_t, Floats> > which;

  HWY_INLINE GatheredTriangles(const Block& from, std::size_t begin, const std::int32_t* places)
      : block(&from), first(begin), which(hn::LoadU(hn::Rebind<std::int32_t, Floats>(), places)) {}
  HWY_INLINE Vector of(const float* column) const {
    constexpr Floats kFloats;
    return hn::TableLookupLanes(hn::LoadU(kFloats, column + first), hn::IndicesFromVec(kFloats, which));
  }
  HWY_INLINE Vector3 corner(std::size_t k) const {
    return {of(block->corners[k][0]), of(block->corners[k][1]), of(block->corners[k][2])};
  }
};

using LaneMask = hn::Mask<Floats>;

HWY_INLINE Vector3 choose(LaneMask mask, const Vector3& yes, const Vector3& no) {
  return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y), hn::IfThenElse(mask, yes.z, no.z)};
}

// Three corners against a plane: distances times the length of its normal.
struct Sides {
  Vector distances[3];

  HWY_INLINE Sides(const Vector3& at, const Vector3& normal, const Vector3 (&corners)[3]) {
    for (std::size_t k = 0; k < 3; ++k) {
      distances[k] = dot_product(normal, subtract(corners[k], at));
    }
  }
  // All on one side, for certain.
  HWY_INLINE LaneMask miss(Vector error) const {
    const Vector least = hn::Min(hn::Min(distances[0], distances[1]), distances[2]);
    const Vector most = hn::Max(hn::Max(distances[0], distances[1]), distances[2]);
    return hn::Or(hn::Gt(least, error), hn::Lt(most, hn::Neg(error)));
  }
  // True in lanes where every corner's side is certain.
  HWY_INLINE LaneMask known(Vector error) const {
    return hn::And(hn::And(hn::Gt(hn::Abs(distances[0]), error), hn::Gt(hn::Abs(distances[1]), error)),
                   hn::Gt(hn::Abs(distances[2]), error));
  }
  // Turns the corners until the first is the one alone on its side. All sides must be known. Returns the lanes in which
  // that corner is below.
  HWY_INLINE LaneMask put_alone_first(Vector3 (&corners)[3]) const {
    constexpr Floats kFloats;
    const Vector zero = hn::Zero(kFloats);
    const LaneMask below[3] = {hn::Lt(distances[0], zero), hn::Lt(distances[1], zero), hn::Lt(distances[2], zero)};
    const LaneMask third = hn::Not(hn::Xor(below[0], below[1]));  // the first two are together
    const LaneMask second = hn::Not(hn::Xor(below[0], below[2]));
    const Vector3 c0 = corners[0], c1 = corners[1], c2 = corners[2];
    corners[0] = choose(third, c2, choose(second, c1, c0));
    corners[1] = choose(third, c0, choose(second, c2, c1));
    corners[2] = choose(third, c1, choose(second, c0, c2));
    const Vector alone = hn::IfThenElse(third, distances[2], hn::IfThenElse(second, distances[1], distances[0]));
    return hn::Lt(alone, zero);
  }
};

// One bit a lane: `apart` if the two triangles certainly do not intersect, `meeting` if they certainly do. A lane with
// neither bit needs the exact test.
struct Verdicts {
  std::uint64_t apart, meeting;
};

// Classifies each lane's two triangles by the test of exact_crossing.h. A sign counts only if its value exceeds the
// rounding error's bound. Lanes that are not wanted may stay undecided.
HWY_INLINE Verdicts classify(const GatheredTriangles& first, const GatheredTriangles& second, std::uint64_t wanted) {
  Vector3 a[3] = {first.corner(0), first.corner(1), first.corner(2)};
  Vector3 b[3] = {second.corner(0), second.corner(1), second.corner(2)};
  Vector extents[3];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Vector low = hn::Min(first.of(first.block->low[axis]), second.of(second.block->low[axis]));
    const Vector high = hn::Max(first.of(first.block->high[axis]), second.of(second.block->high[axis]));
    extents[axis] = hn::Sub(high, low);
  }
  const Vector error = plane_error({extents[0], extents[1], extents[2]});
  const Sides of_b(a[0], cross_product(subtract(a[1], a[0]), subtract(a[2], a[0])), b);
  const Sides of_a(b[0], cross_product(subtract(b[1], b[0]), subtract(b[2], b[0])), a);
  const LaneMask missed = hn::Or(of_b.miss(error), of_a.miss(error));
  const std::uint64_t missed_bits = bits_of(missed);
  if ((wanted & ~missed_bits) == 0) {
    return {missed_bits, 0};
  }
  const LaneMask known = hn::AndNot(missed, hn::And(of_b.known(error), of_a.known(error)));
  const LaneMask a_turns_b = of_a.put_alone_first(a), b_turns_a = of_b.put_alone_first(b);
  const Vector3 q = choose(b_turns_a, a[2], a[1]), r = choose(b_turns_a, a[1], a[2]);
  const Vector3 v = choose(a_turns_b, b[2], b[1]), w = choose(a_turns_b, b[1], b[2]);
  const Vector3 u = subtract(b[0], a[0]);
  const Vector begins = dot_product(cross_product(subtract(q, a[0]), u), subtract(v, a[0]));
  const Vector ends = dot_product(cross_product(subtract(r, a[0]), u), subtract(w, a[0]));
  const Vector negative = hn::Neg(error);
  const LaneMask before = hn::Or(hn::Gt(begins, error), hn::Lt(ends, negative));
  const LaneMask meet = hn::And(hn::Lt(begins, negative), hn::Gt(ends, error));
  return {missed_bits | bits_of(hn::And(known, before)), bits_of(hn::And(known, meet))};
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#endif

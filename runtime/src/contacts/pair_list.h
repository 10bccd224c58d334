// SPDX-License-Identifier: MIT
// Pairs of numbers, written a register at a time.
#include "runtime/src/simd/highway.h"

#if defined(SPHERECHAIN_SKIN_PAIR_LIST_H) == defined(HWY_TARGET_TOGGLE)  // once a target
#ifdef SPHERECHAIN_SKIN_PAIR_LIST_H
#undef SPHERECHAIN_SKIN_PAIR_LIST_H
#else
#define SPHERECHAIN_SKIN_PAIR_LIST_H
#endif

#include "runtime/src/clusters/boxes.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

using Places = hn::Rebind<std::int32_t, Floats>;

// Pairs of numbers: one with some of a register of others. May be written to until it has no room for a register.
template <std::size_t kRoom>
struct PairList {
  std::size_t count = 0;
  std::int32_t a[kRoom + kLanes], b[kRoom + kLanes];  // vectors are written past the end

  // Where `at` pairs are; gives how many are then. In a loop that is to stay in a register: what the vectors write
  // could be `count`, for all that the compiler knows.
  HWY_INLINE std::size_t put(std::size_t at, std::size_t one, std::size_t first, hn::Mask<Floats> others) {
    constexpr Places kPlaces;
    hn::StoreU(hn::Set(kPlaces, static_cast<std::int32_t>(one)), kPlaces, a + at);
    const auto numbers = hn::Add(hn::Iota(kPlaces, 0), hn::Set(kPlaces, static_cast<std::int32_t>(first)));
    const auto which = hn::RebindMask(kPlaces, others);
    hn::StoreU(hn::Compress(numbers, which), kPlaces, b + at);
    return at + hn::CountTrue(kPlaces, which);
  }
  // Drops the pairs that `keeps` says false of; the others stay in order.
  template <class Keeps>
  HWY_INLINE void filter(const Keeps& keeps) {
    std::size_t left = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const std::int32_t one = a[k], other = b[k];
      a[left] = one;
      b[left] = other;
      left += keeps(static_cast<std::size_t>(one), static_cast<std::size_t>(other)) ? 1 : 0;
    }
    count = left;
  }
  static bool has_room(std::size_t at) { return at + kLanes <= kRoom; }
  HWY_INLINE void finish() {
    constexpr Places kPlaces;
    hn::StoreU(hn::Zero(kPlaces), kPlaces, a + count);
    hn::StoreU(hn::Zero(kPlaces), kPlaces, b + count);
  }
};

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#endif

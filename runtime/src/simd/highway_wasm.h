// SPDX-License-Identifier: MIT
// Highway for WebAssembly, but for what its version 1.0.3 does byte by byte through memory: these hide its own. For
// highway.h alone.
#pragma once

#include <cstddef>
#include <cstdint>

namespace spherechain {
namespace HWY_NAMESPACE {
namespace hn {

using namespace hwy::HWY_NAMESPACE;

template <typename T, std::size_t N>
using Register = hwy::HWY_NAMESPACE::Vec128<T, N>;
template <typename T, std::size_t N>
using LanesMask = hwy::HWY_NAMESPACE::Mask128<T, N>;

template <typename T, std::size_t N>
HWY_INLINE std::uint32_t bits_of_mask(LanesMask<T, N> mask) {
  static_assert(sizeof(T) * N == 16, "whole registers");
  switch (sizeof(T)) {
    case 1:
      return wasm_i8x16_bitmask(mask.raw);
    case 2:
      return wasm_i16x8_bitmask(mask.raw);
    case 4:
      return wasm_i32x4_bitmask(mask.raw);
    default:
      return wasm_i64x2_bitmask(mask.raw);
  }
}

template <class D, typename T, std::size_t N>
HWY_INLINE std::size_t StoreMaskBits(D, LanesMask<T, N> mask, std::uint8_t* bits) {
  const std::uint32_t all = bits_of_mask(mask);
  bits[0] = static_cast<std::uint8_t>(all);
  if (N > 8) {
    bits[1] = static_cast<std::uint8_t>(all >> 8);
  }
  return N > 8 ? 2 : 1;
}

template <class D, typename T, std::size_t N>
HWY_INLINE std::size_t CountTrue(D, LanesMask<T, N> mask) {
  return static_cast<std::size_t>(__builtin_popcount(bits_of_mask(mask)));
}

template <class D, typename T, std::size_t N>
HWY_INLINE bool AllFalse(D, LanesMask<T, N> mask) {
  return !wasm_v128_any_true(mask.raw);
}

// A place of 16 or more gives 0.
template <typename T, std::size_t N, typename TI, std::size_t NI>
HWY_INLINE Register<TI, NI> TableLookupBytes(Register<T, N> table, Register<TI, NI> places) {
  return {wasm_i8x16_swizzle(table.raw, places.raw)};
}

// Looks up lanes in registers of four lanes; the places are given as bytes.
template <class D, typename TI>
HWY_INLINE v128_t IndicesFromVec(D, Register<TI, 4> places) {
  const v128_t spread = wasm_i8x16_shuffle(places.raw, places.raw, 0, 0, 0, 0, 4, 4, 4, 4, 8, 8, 8, 8, 12, 12, 12, 12);
  return wasm_v128_or(wasm_i32x4_shl(spread, 2), wasm_i32x4_splat(0x03020100));
}
template <typename T>
HWY_INLINE Register<T, 4> TableLookupLanes(Register<T, 4> table, v128_t places) {
  return {wasm_i8x16_swizzle(table.raw, places)};
}

template <typename T>
HWY_INLINE Register<T, 4> Compress(Register<T, 4> lanes, LanesMask<T, 4> mask) {
  constexpr std::uint32_t kLane[4] = {0x03020100, 0x07060504, 0x0B0A0908, 0x0F0E0D0C};
  alignas(16) static constexpr std::uint32_t kPlaces[16][4] = {{},
                                                               {kLane[0]},
                                                               {kLane[1]},
                                                               {kLane[0], kLane[1]},
                                                               {kLane[2]},
                                                               {kLane[0], kLane[2]},
                                                               {kLane[1], kLane[2]},
                                                               {kLane[0], kLane[1], kLane[2]},
                                                               {kLane[3]},
                                                               {kLane[0], kLane[3]},
                                                               {kLane[1], kLane[3]},
                                                               {kLane[0], kLane[1], kLane[3]},
                                                               {kLane[2], kLane[3]},
                                                               {kLane[0], kLane[2], kLane[3]},
                                                               {kLane[1], kLane[2], kLane[3]},
                                                               {kLane[0], kLane[1], kLane[2], kLane[3]}};
  return {wasm_i8x16_swizzle(lanes.raw, wasm_v128_load(kPlaces[bits_of_mask(mask)]))};
}

// Sixteen times three bytes.
template <class D>
HWY_INLINE void LoadInterleaved3(D, const std::uint8_t* from, Register<std::uint8_t, 16>& a,
                                 Register<std::uint8_t, 16>& b, Register<std::uint8_t, 16>& c) {
  const v128_t x = wasm_v128_load(from), y = wasm_v128_load(from + 16), z = wasm_v128_load(from + 32);
  const v128_t a_xy = wasm_i8x16_shuffle(x, y, 0, 3, 6, 9, 12, 15, 18, 21, 24, 27, 30, 0, 0, 0, 0, 0);
  const v128_t b_xy = wasm_i8x16_shuffle(x, y, 1, 4, 7, 10, 13, 16, 19, 22, 25, 28, 31, 0, 0, 0, 0, 0);
  const v128_t c_xy = wasm_i8x16_shuffle(x, y, 2, 5, 8, 11, 14, 17, 20, 23, 26, 29, 0, 0, 0, 0, 0, 0);
  a.raw = wasm_i8x16_shuffle(a_xy, z, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 17, 20, 23, 26, 29);
  b.raw = wasm_i8x16_shuffle(b_xy, z, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 18, 21, 24, 27, 30);
  c.raw = wasm_i8x16_shuffle(c_xy, z, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 16, 19, 22, 25, 28, 31);
}

}  // namespace hn
}  // namespace HWY_NAMESPACE
}  // namespace spherechain

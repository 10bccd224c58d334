// SPDX-License-Identifier: MIT
// The pairs of a character of one tile, out of lists that a DetectTable has: straight to a list, which is short in most
// poses.
#pragma once

#include <cstddef>
#include <cstdint>

#include "asset/span.h"
#include "pairs/overlap.h"
#include "spherechain/types.h"

namespace spherechain {

// Spheres a < b, by the bytes from the first sphere to them: that spares a shift a load. As one number of 32 bits,
// which vectors take it for, pairs are in order: the runtime knows machines of that byte order only, as the asset does.
struct ListedPair {
  std::uint16_t b, a;
};
constexpr ListedPair listed_pair(std::size_t a, std::size_t b) {
  return {static_cast<std::uint16_t>(b * sizeof(Sphere)), static_cast<std::uint16_t>(a * sizeof(Sphere))};
}

// A strip: a sphere, and kBlock spheres of which some are before it.
constexpr std::size_t strips_of(std::size_t sphere_count) {
  const std::size_t blocks = sphere_count < 2 ? 0 : (sphere_count - 1 + kBlock - 1) / kBlock;
  return blocks == 0 ? 0 : blocks * (sphere_count - 1) - blocks * (blocks - 1) / 2 * kBlock;
}
// Calls use(row, first) for each, in order: by two blocks, row and block.
template <typename Use>
void for_each_strip(std::size_t sphere_count, const Use& use) {
  for (std::size_t first = 0; first < sphere_count; first += 2 * kBlock) {
    for (std::size_t row = first + 1; row < sphere_count; ++row) {
      use(row, first);
      if (row > first + kBlock) {
        use(row, first + kBlock);
      }
    }
  }
}
inline constexpr std::size_t kStripGroup = 64;
constexpr std::size_t padded_strips(std::size_t sphere_count) {
  return (strips_of(sphere_count) + kStripGroup - 1) / kStripGroup * kStripGroup;
}

// What to look at.
struct PairLists {
  const std::uint16_t* wanted;   // by strip, a bit a sphere: pairs but rest pairs; 0 in the padding
  const ListedPair* strips;      // the block's first sphere as a, the sphere as b
  const ListedPair* rest_pairs;  // rest_count is a multiple of kBlock, filled up by pairs that never touch
  const float* rest_scales;
  std::size_t rest_count;
};

inline constexpr std::size_t kMaxPairs = 128;
struct alignas(64) FoundPairs {
  ListedPair pairs[kMaxPairs + kBlock];  // in any order
  std::size_t count = 0;
};

// False where there are more than fit, or a sphere is not finite or too large: then `found` holds nothing of use.
bool find_listed(Target resolved, const Sphere* spheres, std::size_t count, const PairLists& lists, FoundPairs& found);

// Into the list, in order, as many as it holds.
void list_in_order(Target resolved, const FoundPairs& found, Span<Pair> list);

}  // namespace spherechain

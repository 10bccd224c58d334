// SPDX-License-Identifier: MIT
// The pairs of a character of one tile, out of lists that a DetectTable has: straight to a list, which is short in most
// poses.
#pragma once

#include <cstddef>
#include <cstdint>

#include "overlap.h"
#include "spherechain/simd.h"
#include "spherechain/types.h"

namespace spherechain {

// Spheres a < b. As one number of 32 bits, which vectors take it for, pairs are in order: the runtime knows machines of
// that byte order only, as the asset does.
struct ListedPair {
  std::uint16_t b, a;
};

// A strip: a sphere, and kBlock spheres of which some are before it.
constexpr std::size_t strips_of(std::size_t sphere_count) {
  const std::size_t blocks = sphere_count < 2 ? 0 : (sphere_count - 1 + kBlock - 1) / kBlock;
  return blocks == 0 ? 0 : blocks * (sphere_count - 1) - blocks * (blocks - 1) / 2 * kBlock;
}
inline constexpr std::size_t kStripGroup = 64;
constexpr std::size_t padded_strips(std::size_t sphere_count) {
  return (strips_of(sphere_count) + kStripGroup - 1) / kStripGroup * kStripGroup;
}

// What to look at. Strips by block, then sphere.
struct PairLists {
  const std::uint16_t* wanted = nullptr;  // by strip, a bit a sphere: pairs but near ones; 0 in the padding
  const ListedPair* strips = nullptr;     // the block's first sphere as a, the sphere as b
  const ListedPair* near = nullptr;       // near_count is a multiple of kBlock, filled up by pairs that never touch
  const float* reaches = nullptr;
  std::size_t near_count = 0;
};

inline constexpr std::size_t kMostPairs = 64;
struct alignas(64) FoundPairs {
  ListedPair pairs[kMostPairs + kBlock];  // in any order
  std::size_t count = 0;
};

// False where there are more than fit, or a sphere is not finite or too large: then `found` holds nothing of use.
bool find_listed(Target resolved, const Sphere* spheres, std::size_t count, const PairLists& lists, FoundPairs& found);

// Into the list, in order, as many as it holds. Overwrites what is past found.count.
void list_in_order(Target resolved, FoundPairs& found, Span<Pair> list);

}  // namespace spherechain

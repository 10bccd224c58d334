// SPDX-License-Identifier: MIT
// M1 and M2 with a DetectTable, where few pairs touch: they come as a list.
#include "arithmetic.h"
#include "detect_steps.h"

namespace spherechain {
namespace {

// The chains that hold both spheres, pair by pair.
std::size_t count_in_chains(const PairRows& rows, const FoundPairs& found) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < found.count; ++i) {
    const std::uint64_t* const of_a = rows.members + found.pairs[i].a / sizeof(Sphere) * rows.member_words;
    const std::uint64_t* const of_b = rows.members + found.pairs[i].b / sizeof(Sphere) * rows.member_words;
    for (std::size_t w = 0; w < rows.member_words; ++w) {
      count += count_bits(of_a[w] & of_b[w]);
    }
  }
  return count;
}

}  // namespace

bool detect_listed(const Scene& scene, bool in_chains, Result& result) {
  const PairRows& rows = *scene.rows;
  Sphere padded[kTileSize];
  FoundPairs found;
  if (!find_listed(scene.target, scene.block(0, scene.size(), padded), scene.size(),
                   in_chains ? rows.chain_lists : rows.lists, found)) {
    return false;
  }
  result.tests = in_chains ? rows.chain_test_count : rows.test_count;
  result.pairs.count = found.count;
  if (in_chains) {
    result.chain_pairs.count = count_in_chains(rows, found);
  }
  if (result.bits.size > 0 && !result.first_only) {
    for (std::size_t i = 0; i < found.count; ++i) {
      set_bit(result.bits, ignored_bit(found.pairs[i].a / sizeof(Sphere), found.pairs[i].b / sizeof(Sphere)));
    }
  }
  if (result.pairs.buffer.size > 0) {
    list_in_order(scene.target, found, result.pairs.buffer);
  }
  return true;
}

}  // namespace spherechain

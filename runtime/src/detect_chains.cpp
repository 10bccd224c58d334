// SPDX-License-Identifier: MIT
// M1: chain by chain. A pair that several chains hold is counted in each, and tested once: a character's pairs are one
// tile of M2, and a chain is a mask over it.
#include <algorithm>
#include <cfloat>
#include <cstring>

#include "arithmetic.h"
#include "detect_steps.h"

namespace spherechain {
namespace {

// Calls use(a, b) for the pairs of bits in the order of sorted pairs, upwards.
template <typename Use>
void for_each_pair(Span<const std::uint64_t> seen, std::size_t n, const Use& use) {
  std::size_t a = 0;
  for (std::size_t w = 0; w < seen.size; ++w) {
    for (std::uint64_t word = seen[w]; word != 0; word &= word - 1) {
      const std::size_t bit = w * 64 + lowest_bit(word);
      while (bit >= row_begin(a + 1, n)) {
        ++a;
      }
      use(a, a + 1 + (bit - row_begin(a, n)));
    }
  }
}

bool overlap(const Scene& scene, const Pair& pair) {
  const Sphere p = scene.sphere(pair.a);
  const Sphere q = scene.sphere(pair.b);
  const float s = p.radius + q.radius;
  const float squared_reach = s * s;
  if (!((squared_distance(p, q) < squared_reach) & (squared_reach <= FLT_MAX))) {
    return false;
  }
  const NearPair* const found =
      std::lower_bound(scene.near.begin(), scene.near.end(), pair, [](const NearPair& n, const Pair& wanted) {
        return Pair{n.a, n.b} < wanted;
      });
  const bool is_near = found != scene.near.end() && found->a == pair.a && found->b == pair.b;
  return !is_near || within_reach(p, q, found->reach);
}

// Of the tile's pairs, how many have both spheres in the mask.
std::size_t count_masked(const TestedTile& tile, const TileWords& mask) {
  std::size_t count = 0;
  for (const std::size_t hit : tile.hits()) {
    const std::size_t r = hit / kTileWords, w = hit % kTileWords;
    const std::uint64_t row = 0 - ((mask.words[r / 64] >> (r % 64)) & 1U);
    count += count_bits(tile.bits()[r].words[w] & mask.words[w] & row);
  }
  return count;
}

// The raw list of one chain: by its first sphere's place in the chain, then the second's.
void list_chain(const TestedTile& tile, std::uint32_t chain, Span<const std::uint32_t> members, const TileWords& mask,
                Output<ChainPair>& pairs) {
  std::uint8_t place_of[kTileSize];
  for (std::size_t i = 0; i < members.size; ++i) {
    place_of[members[i]] = static_cast<std::uint8_t>(i);
  }
  TileWords by_place[kTileSize] = {};
  for (const std::uint32_t row : members) {
    for (std::size_t w = 0; w < kTileWords; ++w) {
      for (std::uint64_t word = tile.bits()[row].words[w] & mask.words[w]; word != 0; word &= word - 1) {
        const std::uint8_t p = place_of[64 * w + lowest_bit(word)];
        const std::uint8_t q = place_of[row];
        by_place[std::max(p, q)].words[std::min(p, q) / 64] |= std::uint64_t{1} << (std::min(p, q) % 64);
      }
    }
  }
  ColumnOrder order;
  order.count(by_place, members.size);
  order.begin_at(pairs.count);
  order.place(by_place, members.size, [&](std::size_t at, std::size_t i, std::size_t j) {
    pairs.put(at, {chain, {std::min(members[i], members[j]), std::max(members[i], members[j])}});
  });
}

void detect_in_one_tile(const Scene& scene, Result& result) {
  TestedTile tile(scene);
  tile.set_columns(0);
  tile.set_rows(0);
  TileWords wanted[kTileSize], plain[kTileSize];
  if (scene.rows != nullptr) {
    tile.choose(scene.rows->chain_wanted, scene.rows->chain_plain);
    result.tests = scene.rows->chain_test_count;
  } else {
    tile.choose_all();
    result.tests = fill_chain_rows(scene.target, *scene.asset, tile.wanted(), tile.plain(), wanted, plain, nullptr);
    tile.choose(wanted, plain);
  }
  tile.run();
  const bool lists = result.chain_pairs.buffer.size > 0;
  const std::size_t chain_count = tile.hits().size == 0 ? 0 : scene.asset->chain_count();
  for (std::size_t c = 0; c < chain_count; ++c) {
    const Span<const std::uint32_t> members =
        scene.rows == nullptr || lists ? scene.asset->chain(c).spheres : Span<const std::uint32_t>{};
    const TileWords mask = scene.rows == nullptr ? chain_mask(members) : scene.rows->chains[c];
    const std::size_t touching = count_masked(tile, mask);
    if (lists && touching > 0) {
      list_chain(tile, static_cast<std::uint32_t>(c), members, mask, result.chain_pairs);
    }
    result.chain_pairs.count += touching;
  }
  report(tile, result);
}

// Assets of more than a tile, pair by pair; `seen` has a bit a pair, in the order of sorted pairs.
void detect_pair_by_pair(const Scene& scene, Span<std::uint64_t> seen, Result& result) {
  const std::size_t n = scene.size();
  std::fill(seen.begin(), seen.end(), std::uint64_t{0});
  for (std::size_t c = 0; c < scene.asset->chain_count(); ++c) {
    const Span<const std::uint32_t> members = scene.asset->chain(c).spheres;
    for (std::size_t i = 0; i < members.size; ++i) {
      for (std::size_t j = i + 1; j < members.size; ++j) {
        const Pair pair{std::min(members[i], members[j]), std::max(members[i], members[j])};
        if (test_bit(scene.ignored, ignored_bit(pair.a, pair.b)) || !scene.is_enabled(pair.a) ||
            !scene.is_enabled(pair.b)) {
          continue;
        }
        ++result.tests;
        if (overlap(scene, pair)) {
          result.chain_pairs.add({static_cast<std::uint32_t>(c), pair});
          set_bit(seen, sorted_bit(pair.a, pair.b, n));
        }
      }
    }
  }
}

}  // namespace

void detect_chains(const Scene& scene, Span<std::uint64_t> seen, Result& result) {
  if (scene.rows != nullptr && result.chain_pairs.buffer.size == 0 && detect_listed(scene, true, result)) {
    return;
  }
  if (scene.size() <= kTileSize) {
    return detect_in_one_tile(scene, result);
  }
  detect_pair_by_pair(scene, seen, result);
  for_each_pair({seen.data, seen.size}, scene.size(), [&](std::size_t a, std::size_t b) {
    result.pairs.add({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b)});
    if (result.bits.size > 0) {
      set_bit(result.bits, ignored_bit(a, b));
    }
  });
}

}  // namespace spherechain

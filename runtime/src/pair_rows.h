// SPDX-License-Identifier: MIT
// Which pairs of a tile are looked at, by rows: what asset, filter and chains leave of them, whatever the spheres are.
#pragma once

#include <cstddef>
#include <cstdint>

#include "listed_pairs.h"
#include "overlap.h"
#include "spherechain/asset.h"
#include "spherechain/detect_table.h"

namespace spherechain {

// What an asset and a filter leave out.
struct PairChoice {
  Span<const std::uint64_t> ignored;   // in the order of Asset::ignored()
  Span<const std::uint64_t> disabled;  // may be empty
  Span<const NearPair> near;
};

// Fills rows [0, padded_rows(place.row_count)). Returns how many pairs are wanted.
std::size_t fill_rows(Target resolved, const PairChoice& choice, const TilePlace& place, TileWords* wanted,
                      TileWords* plain);

// Spheres of a chain as bits.
TileWords chain_mask(Span<const std::uint32_t> members);

// Of the rows of a whole character, the pairs of two spheres that some chain holds both of. `masks`, where it is not
// null: a chain each. Returns how many pairs of `wanted` the chains hold, one after the other.
std::size_t fill_chain_rows(Target resolved, const Asset& asset, const TileWords* wanted, const TileWords* plain,
                            TileWords* chain_wanted, TileWords* chain_plain, TileWords* masks);

// A DetectTable's content, of a character of one tile. No default values: setting them would be a good part of a job.
struct PairRows {
  std::size_t test_count, chain_test_count;
  const TileWords *wanted, *plain;
  const TileWords *chain_wanted, *chain_plain;
  const TileWords* chains;
  PairLists lists, chain_lists;
  const std::uint64_t* members;  // by sphere, member_words each: a bit a chain that has it
  std::size_t member_words;
};

// kOk; kNullArgument, kMisaligned, kContextTooSmall; kBadArgument where it was not prepared for this.
Status read_table(const Asset& asset, RadiusKind radius, const DetectTable& table, PairRows& out);

}  // namespace spherechain

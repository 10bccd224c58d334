// SPDX-License-Identifier: MIT
#include "spherechain/detect_table.h"

#include <algorithm>
#include <type_traits>

#include "memory.h"
#include "pair_rows.h"
#include "simd.h"
#include "triangle_bits.h"

namespace spherechain {
namespace {

// Where in a table's words what is kept: first what it is of, whose sizes say where the rest lies; then that.
enum Place : std::size_t {
  kAsset,
  kRadius,
  kSpheres,
  kChains,
  kNearRoom,
  kTests,
  kChainTests,
  kNear,
  kChainNear,
  kHeaderWords
};

constexpr std::size_t kRowSets = 4;   // wanted and plain, of all and of the chains'
constexpr std::size_t kListSets = 2;  // of all and of the chains'

bool is_one_tile(const Asset& asset) { return asset.spheres().size <= kTileSize; }

std::uint64_t key_of(const Asset& asset) { return reinterpret_cast<std::uintptr_t>(asset.spheres().data); }

std::size_t padded_near(const Asset& asset) {
  const std::size_t most =
      std::max(asset.near_pairs(RadiusKind::kFit).size, asset.near_pairs(RadiusKind::kDetect).size);
  return (most + kBlock - 1) / kBlock * kBlock;
}

// Where what lies in a table's words, and how many there are; of a null table only how many.
struct Content {
  Content(std::uint64_t* words, const Asset& asset) : size(kHeaderWords), member_words(words_for(asset.chain_count())) {
    if (!is_one_tile(asset)) {
      return;
    }
    const auto take = [&](auto*& content, std::size_t count) {
      content = words == nullptr ? nullptr : reinterpret_cast<std::remove_reference_t<decltype(content)>>(words + size);
      size += (count * sizeof *content + sizeof *words - 1) / sizeof *words;
    };
    const std::size_t n = asset.spheres().size, strip_count = padded_strips(n), near_count = padded_near(asset);
    for (TileWords*& rows : sets) {
      take(rows, padded_rows(n));
    }
    take(chains, asset.chain_count());
    take(members, n * member_words);
    take(strips, strip_count);
    for (std::size_t i = 0; i < kListSets; ++i) {
      take(wanted[i], strip_count);
      take(near[i], near_count);
      take(reaches[i], near_count);
    }
  }

  std::size_t size, member_words;
  TileWords *sets[kRowSets] = {}, *chains = nullptr;
  std::uint64_t* members = nullptr;
  ListedPair *strips = nullptr, *near[kListSets] = {};
  std::uint16_t* wanted[kListSets] = {};
  float* reaches[kListSets] = {};
};

void fill_members(const Asset& asset, const Content& content) {
  std::fill(content.members, content.members + asset.spheres().size * content.member_words, std::uint64_t{0});
  for (std::size_t c = 0; c < asset.chain_count(); ++c) {
    for (const std::uint32_t sphere : asset.chain(c).spheres) {
      content.members[sphere * content.member_words + c / 64] |= std::uint64_t{1} << (c % 64);
    }
  }
}

void fill_strips(std::size_t n, const Content& content) {
  const std::size_t padded = padded_strips(n);
  std::fill(content.strips, content.strips + padded, ListedPair{});
  std::size_t strip = 0;
  for_each_strip(n, [&](std::size_t row, std::size_t first) {
    content.strips[strip] = listed_pair(first, row);
    for (std::size_t i = 0; i < kListSets; ++i) {
      content.wanted[i][strip] =
          static_cast<std::uint16_t>(content.sets[2 * i + 1][row].words[first / 64] >> (first % 64));
    }
    ++strip;
  });
  for (std::size_t i = 0; i < kListSets; ++i) {
    std::fill(content.wanted[i] + strip, content.wanted[i] + padded, std::uint16_t{0});
  }
}

// The near pairs that rows hold. Returns how many, filled up.
std::size_t fill_near(Span<const NearPair> near, const TileWords* rows, ListedPair* pairs, float* reaches) {
  std::size_t count = 0;
  for (const NearPair& pair : near) {
    if (((rows[pair.b].words[pair.a / 64] >> (pair.a % 64)) & 1U) != 0) {
      pairs[count] = listed_pair(pair.a, pair.b);
      reaches[count++] = pair.reach;
    }
  }
  for (; count % kBlock != 0; ++count) {
    pairs[count] = {};
    reaches[count] = 0;
  }
  return count;
}

Status check(const Asset& asset, RadiusKind radius, const Filter* filter, const DetectTable& table) {
  if (!asset.is_open()) {
    return Status::kNotOpen;
  }
  if (table.words.data == nullptr) {
    return Status::kNullArgument;
  }
  if (any_misaligned(table.words.data)) {
    return Status::kMisaligned;
  }
  if (radius != RadiusKind::kFit && radius != RadiusKind::kDetect) {
    return Status::kBadArgument;
  }
  if (table.words.size < DetectTable::words_needed(asset)) {
    return Status::kContextTooSmall;
  }
  const Status status = filter == nullptr ? Status::kOk : check_filter(asset, *filter);
  if (status != Status::kOk) {
    return status;
  }
  const MemoryRange written[] = {range_of(Span<std::uint64_t>{table.words.data, DetectTable::words_needed(asset)})};
  const MemoryRange read[] = {range_of(asset.ignored()), filter == nullptr ? MemoryRange{} : range_of(filter->ignored),
                              filter == nullptr ? MemoryRange{} : range_of(filter->disabled)};
  return any_shared(written, read) ? Status::kSharedMemory : Status::kOk;
}

}  // namespace

std::size_t DetectTable::words_needed(const Asset& asset) noexcept {
  return asset.is_open() ? Content(nullptr, asset).size : 0;
}

Status prepare_detect(const Asset& asset, RadiusKind radius, const Filter* filter, DetectTable& table) noexcept {
  const Status status = check(asset, radius, filter, table);
  if (status != Status::kOk) {
    return status;
  }
  std::uint64_t* const words = table.words.data;
  words[kAsset] = key_of(asset);
  words[kRadius] = static_cast<std::uint64_t>(radius);
  words[kSpheres] = asset.spheres().size;
  words[kChains] = asset.chain_count();
  words[kNearRoom] = padded_near(asset);
  words[kTests] = words[kChainTests] = words[kNear] = words[kChainNear] = 0;
  if (is_one_tile(asset)) {
    Target target{};
    resolve_target(Target::kBest, target);
    PairChoice choice{asset.ignored(), {}, asset.near_pairs(radius)};
    if (filter != nullptr) {
      choice.ignored = {filter->ignored.data, filter->ignored.size};
      choice.disabled = {filter->disabled.data, filter->disabled.size};
    }
    const std::size_t n = asset.spheres().size;
    const Content content(words, asset);
    const auto& sets = content.sets;
    words[kTests] = fill_rows(target, choice, {0, n, 0, n}, sets[0], sets[1]);
    words[kChainTests] = fill_chain_rows(target, asset, sets[0], sets[1], sets[2], sets[3], content.chains);
    fill_members(asset, content);
    fill_strips(n, content);
    words[kNear] = fill_near(choice.near, sets[0], content.near[0], content.reaches[0]);
    words[kChainNear] = fill_near(choice.near, sets[2], content.near[1], content.reaches[1]);
  }
  return Status::kOk;
}

Status read_table(const Asset& asset, RadiusKind radius, const DetectTable& table, PairRows& out) {
  const Span<std::uint64_t> words = table.words;
  if (words.data == nullptr) {
    return Status::kNullArgument;
  }
  if (any_misaligned(words.data)) {
    return Status::kMisaligned;
  }
  if (words.size < kHeaderWords) {
    return Status::kContextTooSmall;
  }
  // The bytes of another asset may have come to lie at the same address.
  if (words[kAsset] != key_of(asset) || words[kRadius] != static_cast<std::uint64_t>(radius) ||
      words[kSpheres] != asset.spheres().size || words[kChains] != asset.chain_count() ||
      words[kNearRoom] != padded_near(asset)) {
    return Status::kBadArgument;
  }
  const Content content(words.data, asset);
  if (words.size < content.size) {
    return Status::kContextTooSmall;
  }
  const auto& sets = content.sets;
  const auto lists = [&](std::size_t set, std::uint64_t near_count) {
    return PairLists{content.wanted[set], content.strips, content.near[set], content.reaches[set], near_count};
  };
  out = {words[kTests],
         words[kChainTests],
         sets[0],
         sets[1],
         sets[2],
         sets[3],
         content.chains,
         lists(0, words[kNear]),
         lists(1, words[kChainNear]),
         content.members,
         content.member_words};
  return Status::kOk;
}

}  // namespace spherechain

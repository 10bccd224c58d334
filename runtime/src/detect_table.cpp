// SPDX-License-Identifier: MIT
#include "spherechain/detect_table.h"

#include <algorithm>

#include "memory.h"
#include "pair_rows.h"
#include "simd.h"

namespace spherechain {
namespace {

// Where in a table's words what is kept: first what it is of, then rows and chains.
enum Place : std::size_t { kAsset, kRadius, kSpheres, kWords, kTests, kChainTests, kHeaderWords };

constexpr std::size_t kRowSets = 4;  // wanted and plain, of all and of the chains'

bool is_one_tile(const Asset& asset) { return asset.spheres().size <= kTileSize; }

std::size_t row_words(const Asset& asset) {
  return is_one_tile(asset) ? padded_rows(asset.spheres().size) * kTileWords : 0;
}

std::uint64_t key_of(const Asset& asset) { return reinterpret_cast<std::uintptr_t>(asset.spheres().data); }

struct Rows {
  TileWords* sets[kRowSets];
  TileWords* chains;
};

Rows rows_in(std::uint64_t* words, const Asset& asset) {
  Rows rows;
  for (std::size_t i = 0; i < kRowSets; ++i) {
    rows.sets[i] = reinterpret_cast<TileWords*>(words + kHeaderWords + i * row_words(asset));
  }
  rows.chains = reinterpret_cast<TileWords*>(words + kHeaderWords + kRowSets * row_words(asset));
  return rows;
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
  return kHeaderWords + kRowSets * row_words(asset) + (is_one_tile(asset) ? kTileWords * asset.chain_count() : 0);
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
  words[kWords] = DetectTable::words_needed(asset);
  words[kTests] = words[kChainTests] = 0;
  if (is_one_tile(asset)) {
    Target target{};
    resolve_target(Target::kBest, target);
    PairChoice choice{asset.ignored(), {}, asset.near_pairs(radius)};
    if (filter != nullptr) {
      choice.ignored = {filter->ignored.data, filter->ignored.size};
      choice.disabled = {filter->disabled.data, filter->disabled.size};
    }
    const std::size_t n = asset.spheres().size;
    const Rows rows = rows_in(words, asset);
    words[kTests] = fill_rows(target, choice, {0, n, 0, n}, rows.sets[0], rows.sets[1]);
    words[kChainTests] =
        fill_chain_rows(target, asset, rows.sets[0], rows.sets[1], rows.sets[2], rows.sets[3], rows.chains);
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
      words[kSpheres] != asset.spheres().size || words[kWords] != DetectTable::words_needed(asset)) {
    return Status::kBadArgument;
  }
  if (words.size < words[kWords]) {
    return Status::kContextTooSmall;
  }
  const Rows rows = rows_in(words.data, asset);
  out = {words[kTests], words[kChainTests], rows.sets[0], rows.sets[1], rows.sets[2], rows.sets[3], rows.chains};
  return Status::kOk;
}

}  // namespace spherechain

// SPDX-License-Identifier: MIT
#include <algorithm>
#include <type_traits>

#include "runtime/src/base/memory.h"
#include "runtime/src/base/pair_bits.h"
#include "runtime/src/base/status.h"
#include "runtime/src/pairs/filter.h"
#include "runtime/src/pairs/spheres_to_pair.h"
#include "runtime/src/pose/pose.h"
#include "runtime/src/simd/simd.h"

namespace spherechain {
namespace {

constexpr std::uint64_t kMagic = 0x6361747465646373;  // says that the words are a table
enum Place : std::size_t { kIsTable, kAsset, kRadius, kSpheres, kRestRoom, kRestPairs, kHeaderWords };

bool is_one_tile(const AssetView& asset) { return asset.spheres().size <= kTileSize; }

std::uint64_t key_of(const AssetView& asset) { return reinterpret_cast<std::uintptr_t>(asset.spheres().data); }

std::size_t padded_rest_pairs(const AssetView& asset) {
  const std::size_t most = std::max(asset.rest_pairs(SC_RADIUS_FIT).size, asset.rest_pairs(SC_RADIUS_DETECT).size);
  return (most + kBlock - 1) / kBlock * kBlock;
}

// Where in a table's words what lies, and how many there are; of null words only how many. An asset of one tile has
// lists; a larger one, for which they would save nothing, its filter's bits.
struct Content {
  Content(std::uint64_t* words, const AssetView& asset) : size(kHeaderWords) {
    const auto take = [&](auto*& content, std::size_t count) {
      content = words == nullptr ? nullptr : reinterpret_cast<std::remove_reference_t<decltype(content)>>(words + size);
      size += (count * sizeof *content + sizeof *words - 1) / sizeof *words;
    };
    const std::size_t n = asset.spheres().size;
    if (is_one_tile(asset)) {
      lists.rest_room = padded_rest_pairs(asset);
      take(lists.wanted, padded_strips(n));
      take(lists.strips, padded_strips(n));
      take(lists.rest_pairs, lists.rest_room);
      take(lists.rest_scales, lists.rest_room);
    } else {
      take(ignored, words_for(pairs_of(n)));
    }
  }

  std::size_t size;
  PairListBuffers lists = {};
  std::uint64_t* ignored = nullptr;
};

Status check(const AssetView& asset, Radius radius, const Filter* filter, Span<std::uint64_t> words) {
  if (words.data == nullptr || any_misaligned(words.data)) {
    return refuse(words.data == nullptr ? SC_NULL : SC_MISALIGNED, SC_FIELD_TABLE);
  }
  if (!is_radius(radius)) {
    return refuse(SC_BAD_VALUE, SC_FIELD_RADIUS);
  }
  const std::size_t needed = Content(nullptr, asset).size;
  if (words.size < needed) {
    return refuse(SC_TOO_SMALL, SC_FIELD_TABLE);
  }
  const Status status = filter == nullptr ? done() : check_filter(asset, *filter);
  if (status != SC_OK) {
    return status;
  }
  return any_shared({range_of(Span<std::uint64_t>{words.data, needed})}, {range_of(asset.ignored()), range_of(filter)})
             ? refuse(SC_ALIASED, SC_FIELD_TABLE)
             : done();
}

void fill(const AssetView& asset, Radius radius, const Filter* filter, std::uint64_t* words) {
  const std::size_t n = asset.spheres().size;
  PairChoice choice = choice_of(asset, radius, filter);
  const Content content(words, asset);
  words[kIsTable] = kMagic;
  words[kAsset] = key_of(asset);
  words[kRadius] = static_cast<std::uint64_t>(radius);
  words[kSpheres] = n;
  words[kRestRoom] = padded_rest_pairs(asset);
  words[kRestPairs] = 0;
  if (is_one_tile(asset)) {
    Target target{};
    resolve_target(SC_TARGET_BEST, target);
    const TilePlace place{0, n, 0, n};
    fill_strips(target, choice, place, content.lists);
    words[kRestPairs] = move_rest_pairs(choice.rest_pairs, place, content.lists);
  } else {
    std::copy(choice.ignored.begin(), choice.ignored.end(), content.ignored);
  }
}

}  // namespace

Status read_detect_table(const AssetView& asset, Radius radius, const std::uint64_t* words, SpheresToPair& set) {
  if (any_misaligned(words)) {
    return refuse(SC_MISALIGNED, SC_FIELD_TABLE);
  }
  // The bytes of another asset may have come to lie at the same address.
  if (words[kIsTable] != kMagic || words[kAsset] != key_of(asset) ||
      words[kRadius] != static_cast<std::uint64_t>(radius) || words[kSpheres] != asset.spheres().size ||
      words[kRestRoom] != padded_rest_pairs(asset)) {
    return refuse(SC_BAD_VALUE, SC_FIELD_TABLE);
  }
  const Content content(const_cast<std::uint64_t*>(words), asset);
  const std::size_t n = asset.spheres().size;
  const PairListBuffers& lists = content.lists;
  set.table_words = content.size;
  set.has_lists = is_one_tile(asset);
  if (set.has_lists) {
    set.lists = {lists.wanted,     lists.strips,      strips_of(n),
                 lists.rest_pairs, lists.rest_scales, static_cast<std::size_t>(words[kRestPairs])};
  } else {
    set.choice.rest_pairs = asset.rest_pairs(radius);
    set.choice.ignored = {content.ignored, words_for(pairs_of(n))};
  }
  return done();
}

std::size_t detect_table_words(const Asset* asset) noexcept {
  return is_open(asset) ? Content(nullptr, view_of(*asset)).size : 0;
}

Status prepare_detect(const Asset* asset, Radius radius, const Filter* filter, uint64_t* words,
                      size_t word_count) noexcept {
  if (!is_open(asset)) {
    return refuse(asset == nullptr ? SC_NULL : SC_NOT_OPEN, SC_FIELD_ASSET);
  }
  const Status status = check(view_of(*asset), radius, filter, {words, word_count});
  if (status == SC_OK) {
    fill(view_of(*asset), radius, filter, words);
  }
  return status;
}

}  // namespace spherechain

// SPDX-License-Identifier: MIT
#include "runtime/src/pairs/filter.h"

using namespace spherechain;

extern "C" {

size_t sc_pair_words(const sc_asset* asset) noexcept {
  return is_open(asset) ? words_for(pairs_of(view_of(*asset).spheres().size)) : 0;
}

size_t sc_part_words(const sc_asset* asset) noexcept {
  return is_open(asset) ? words_for(view_of(*asset).part_count()) : 0;
}

sc_status sc_ignore_parts(const sc_asset* asset, uint64_t* ignored_pairs, size_t part, size_t other,
                          int ignored) noexcept {
  if (asset == nullptr || ignored_pairs == nullptr) {
    return refuse(SC_NULL, asset == nullptr ? SC_FIELD_ASSET : SC_FIELD_IGNORED_PAIRS);
  }
  const AssetView& view = view_of(*asset);
  const Filter filter = filter_of(view, ignored_pairs);
  const Status status = check_filter(view, filter);
  if (status != SC_OK) {
    return status;
  }
  if (any_shared({range_of(&filter)}, {range_of(view.ignored())})) {
    return refuse(SC_ALIASED, SC_FIELD_IGNORED_PAIRS);
  }
  if (part >= view.part_count() || other >= view.part_count()) {
    return refuse(SC_BAD_VALUE, SC_FIELD_INDEX);
  }
  const Span<const RestSphere> spheres = view.spheres();
  std::size_t bit = 0;
  for (std::size_t b = 1; b < spheres.size; ++b) {
    for (std::size_t a = 0; a < b; ++a, ++bit) {
      const std::size_t p = spheres[a].part, q = spheres[b].part;
      if ((p == part && q == other) || (p == other && q == part)) {
        assign_bit({ignored_pairs, filter.ignored_words}, bit, ignored != 0);
      }
    }
  }
  return done();
}

}  // extern "C"

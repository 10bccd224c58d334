// SPDX-License-Identifier: MIT
#include "runtime/src/pairs/filter.h"

#include <algorithm>

namespace spherechain {
namespace {

// Checks the arguments of every function that writes to a filter.
Status check_edit(const sc_asset* asset, const Filter* filter) {
  if (asset == nullptr || filter == nullptr) {
    return refuse(SC_NULL, asset == nullptr ? SC_FIELD_ASSET : SC_FIELD_FILTER);
  }
  const AssetView& view = view_of(*asset);
  const Status status = check_filter(view, *filter);
  if (status != SC_OK) {
    return status;
  }
  return any_shared({range_of(filter)}, {range_of(view.ignored())}) ? refuse(SC_ALIASED, SC_FIELD_FILTER) : done();
}

}  // namespace

}  // namespace spherechain

using namespace spherechain;

extern "C" {

size_t sc_pair_words(const sc_asset* asset) noexcept {
  return sc_asset_is_open(asset) != 0 ? words_for(pairs_of(view_of(*asset).spheres().size)) : 0;
}

size_t sc_part_words(const sc_asset* asset) noexcept {
  return sc_asset_is_open(asset) != 0 ? words_for(view_of(*asset).part_count()) : 0;
}

sc_status sc_reset_filter(const sc_asset* asset, sc_filter* filter) noexcept {
  const Status status = check_edit(asset, filter);
  if (status != SC_OK) {
    return status;
  }
  const Span<const std::uint64_t> own = view_of(*asset).ignored();
  std::copy(own.begin(), own.end(), filter->ignored);
  return done();
}

sc_status sc_ignore_pair(const sc_asset* asset, sc_filter* filter, uint32_t a, uint32_t b, int ignored) noexcept {
  const Status status = check_edit(asset, filter);
  if (status != SC_OK) {
    return status;
  }
  const std::size_t n = view_of(*asset).spheres().size;
  if (a == b || a >= n || b >= n) {
    return refuse(SC_BAD_VALUE, SC_FIELD_INDEX);
  }
  assign_bit({filter->ignored, filter->ignored_words}, ignored_bit(std::min(a, b), std::max(a, b)), ignored != 0);
  return done();
}

sc_status sc_ignore_parts(const sc_asset* asset, sc_filter* filter, size_t part, size_t other, int ignored) noexcept {
  const Status status = check_edit(asset, filter);
  if (status != SC_OK) {
    return status;
  }
  const AssetView& view = view_of(*asset);
  if (part >= view.part_count() || other >= view.part_count()) {
    return refuse(SC_BAD_VALUE, SC_FIELD_INDEX);
  }
  const Span<const RestSphere> spheres = view.spheres();
  std::size_t bit = 0;
  for (std::size_t b = 1; b < spheres.size; ++b) {
    for (std::size_t a = 0; a < b; ++a, ++bit) {
      const std::size_t p = spheres[a].part, q = spheres[b].part;
      if ((p == part && q == other) || (p == other && q == part)) {
        assign_bit({filter->ignored, filter->ignored_words}, bit, ignored != 0);
      }
    }
  }
  return done();
}

}  // extern "C"

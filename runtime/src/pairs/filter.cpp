// SPDX-License-Identifier: MIT
#include "pairs/filter.h"

#include <algorithm>
#include <cmath>

namespace spherechain {
namespace {

// What each function that writes asks first.
Status check_edit(const sc_asset* asset, const Filter* filter) {
  if (asset == nullptr || filter == nullptr) {
    return refuse(SC_NULL, asset == nullptr ? SC_FIELD_ASSET : SC_FIELD_FILTER);
  }
  const AssetView& view = view_of(*asset);
  const Status status = check_filter(view, *filter);
  if (status != SC_OK) {
    return status;
  }
  const FilterRanges ranges = ranges_of(filter);
  return any_shared({ranges.ignored, ranges.disabled, ranges.padding}, {range_of(view.ignored())})
             ? refuse(SC_ALIASED, SC_FIELD_FILTER)
             : done();
}

}  // namespace

FilterRanges ranges_of(const Filter* filter) {
  if (filter == nullptr) {
    return {};
  }
  return {range_of(span_of(filter->ignored, filter->ignored_words)),
          range_of(span_of(filter->disabled, filter->disabled_words)),
          range_of(span_of(filter->padding, filter->padding_count))};
}

}  // namespace spherechain

using namespace spherechain;

extern "C" {

sc_status sc_reset_filter(const sc_asset* asset, sc_filter* filter) noexcept {
  const Status status = check_edit(asset, filter);
  if (status != SC_OK) {
    return status;
  }
  const Span<const std::uint64_t> own = view_of(*asset).ignored();
  std::copy(own.begin(), own.end(), filter->ignored);
  std::fill(filter->disabled, filter->disabled + filter->disabled_words, std::uint64_t{0});
  std::fill(filter->padding, filter->padding + filter->padding_count, 0.0F);
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

sc_status sc_ignore_regions(const sc_asset* asset, sc_filter* filter, size_t region, size_t other,
                            int ignored) noexcept {
  const Status status = check_edit(asset, filter);
  if (status != SC_OK) {
    return status;
  }
  const AssetView& view = view_of(*asset);
  if (region >= view.region_count() || other >= view.region_count()) {
    return refuse(SC_BAD_VALUE, SC_FIELD_INDEX);
  }
  const Span<const RestSphere> spheres = view.spheres();
  std::size_t bit = 0;
  for (std::size_t b = 1; b < spheres.size; ++b) {
    for (std::size_t a = 0; a < b; ++a, ++bit) {
      const std::size_t p = spheres[a].region, q = spheres[b].region;
      if ((p == region && q == other) || (p == other && q == region)) {
        assign_bit({filter->ignored, filter->ignored_words}, bit, ignored != 0);
      }
    }
  }
  return done();
}

sc_status sc_disable_sphere(const sc_asset* asset, sc_filter* filter, uint32_t sphere, int disabled) noexcept {
  const Status status = check_edit(asset, filter);
  if (status != SC_OK) {
    return status;
  }
  if (filter->disabled_words == 0) {
    return refuse(SC_NULL, SC_FIELD_FILTER);
  }
  if (sphere >= view_of(*asset).spheres().size) {
    return refuse(SC_BAD_VALUE, SC_FIELD_INDEX);
  }
  assign_bit({filter->disabled, filter->disabled_words}, sphere, disabled != 0);
  return done();
}

sc_status sc_pad_sphere(const sc_asset* asset, sc_filter* filter, uint32_t sphere, float padding) noexcept {
  const Status status = check_edit(asset, filter);
  if (status != SC_OK) {
    return status;
  }
  if (filter->padding_count == 0) {
    return refuse(SC_NULL, SC_FIELD_FILTER);
  }
  if (sphere >= view_of(*asset).spheres().size || !std::isfinite(padding)) {
    return refuse(SC_BAD_VALUE, SC_FIELD_INDEX);
  }
  filter->padding[sphere] = padding;
  return done();
}

}  // extern "C"

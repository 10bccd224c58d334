// SPDX-License-Identifier: MIT
// A caller's lists and filter, checked.
#pragma once

#include "runtime/src/asset/asset_view.h"
#include "runtime/src/base/filter.h"
#include "runtime/src/base/memory.h"
#include "runtime/src/base/pair_bits.h"
#include "runtime/src/base/status.h"

namespace spherechain {

template <typename T>
Span<T> span_of(T* data, std::size_t size) {
  return {data, size};
}

template <typename T>
Status check_list(const T* data, std::size_t size, sc_field field) {
  return data == nullptr && size > 0 ? refuse(SC_NULL, field)
         : any_misaligned(data)      ? refuse(SC_MISALIGNED, field)
                                     : done();
}

// The filter that has a caller's words.
inline Filter filter_of(const AssetView& asset, const std::uint64_t* ignored_pairs) {
  return {ignored_pairs, asset.is_open() ? words_for(pairs_of(asset.spheres().size)) : 0};
}

// Inline, for the CUDA library, which sees only what a shared runtime exports.
inline Status check_filter(const AssetView& asset, const Filter& filter) {
  if (!asset.is_open()) {
    return refuse(SC_NOT_OPEN, SC_FIELD_ASSET);
  }
  if (is_missing(span_of(filter.ignored, filter.ignored_words))) {
    return refuse(SC_NULL, SC_FIELD_IGNORED_PAIRS);
  }
  if (any_misaligned(filter.ignored)) {
    return refuse(SC_MISALIGNED, SC_FIELD_IGNORED_PAIRS);
  }
  return filter.ignored_words == words_for(pairs_of(asset.spheres().size))
             ? done()
             : refuse(SC_TOO_SMALL, SC_FIELD_IGNORED_PAIRS);
}

// The filter's memory; none of a null filter.
inline MemoryRange range_of(const Filter* filter) {
  return filter == nullptr ? MemoryRange{} : range_of(span_of(filter->ignored, filter->ignored_words));
}

}  // namespace spherechain

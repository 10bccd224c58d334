// SPDX-License-Identifier: MIT
#include "spherechain/filter.h"

#include <algorithm>
#include <cmath>

#include "memory.h"
#include "triangle_bits.h"

namespace spherechain {
namespace {

// What each function that writes asks first.
Status check_edit(const Asset& asset, const Filter& filter) {
  const Status status = check_filter(asset, filter);
  if (status != Status::kOk) {
    return status;
  }
  const MemoryRange written[] = {range_of(filter.ignored), range_of(filter.disabled), range_of(filter.padding)};
  const MemoryRange read[] = {range_of(asset.ignored())};
  return any_shared(written, read) ? Status::kSharedMemory : Status::kOk;
}

void assign_pair(Filter& filter, std::uint32_t p, std::uint32_t q, bool ignored) {
  assign_bit(filter.ignored, ignored_bit(std::min(p, q), std::max(p, q)), ignored);
}

}  // namespace

std::size_t Filter::ignored_words(const Asset& asset) noexcept { return words_for(pairs_of(asset.spheres().size)); }

std::size_t Filter::disabled_words(const Asset& asset) noexcept { return words_for(asset.spheres().size); }

Status check_filter(const Asset& asset, const Filter& filter) noexcept {
  if (!asset.is_open()) {
    return Status::kNotOpen;
  }
  if (is_missing(filter.ignored) || is_missing(filter.disabled) || is_missing(filter.padding)) {
    return Status::kNullArgument;
  }
  if (any_misaligned(filter.ignored.data, filter.disabled.data, filter.padding.data)) {
    return Status::kMisaligned;
  }
  const bool fits = filter.ignored.size == Filter::ignored_words(asset) &&
                    (filter.disabled.size == 0 || filter.disabled.size == Filter::disabled_words(asset)) &&
                    (filter.padding.size == 0 || filter.padding.size == asset.spheres().size);
  return fits ? Status::kOk : Status::kBadFilter;
}

Status reset_filter(const Asset& asset, Filter& filter) noexcept {
  const Status status = check_edit(asset, filter);
  if (status != Status::kOk) {
    return status;
  }
  std::copy(asset.ignored().begin(), asset.ignored().end(), filter.ignored.begin());
  std::fill(filter.disabled.begin(), filter.disabled.end(), std::uint64_t{0});
  std::fill(filter.padding.begin(), filter.padding.end(), 0.0F);
  return Status::kOk;
}

Status ignore_pair(const Asset& asset, Filter& filter, std::uint32_t a, std::uint32_t b, bool ignored) noexcept {
  const Status status = check_edit(asset, filter);
  if (status != Status::kOk) {
    return status;
  }
  if (a == b || a >= asset.spheres().size || b >= asset.spheres().size) {
    return Status::kBadArgument;
  }
  assign_pair(filter, a, b, ignored);
  return Status::kOk;
}

Status ignore_regions(const Asset& asset, Filter& filter, std::size_t region, std::size_t other,
                      bool ignored) noexcept {
  const Status status = check_edit(asset, filter);
  if (status != Status::kOk) {
    return status;
  }
  if (region >= asset.region_count() || other >= asset.region_count()) {
    return Status::kBadArgument;
  }
  const Span<const RestSphere> spheres = asset.spheres();
  std::size_t bit = 0;
  for (std::size_t b = 1; b < spheres.size; ++b) {
    for (std::size_t a = 0; a < b; ++a, ++bit) {
      const std::size_t p = spheres[a].region;
      const std::size_t q = spheres[b].region;
      if ((p == region && q == other) || (p == other && q == region)) {
        assign_bit(filter.ignored, bit, ignored);
      }
    }
  }
  return Status::kOk;
}

Status ignore_hops(const Asset& asset, Filter& filter, std::size_t hops, bool ignored) noexcept {
  const Status status = check_edit(asset, filter);
  if (status != Status::kOk) {
    return status;
  }
  for (std::size_t c = 0; c < asset.chain_count(); ++c) {
    const Span<const std::uint32_t> members = asset.chain(c).spheres;
    for (std::size_t i = 0; i < members.size; ++i) {
      const std::size_t last = std::min(hops, members.size - 1 - i);
      for (std::size_t step = 1; step <= last; ++step) {
        assign_pair(filter, members[i], members[i + step], ignored);
      }
    }
  }
  return Status::kOk;
}

Status disable_sphere(const Asset& asset, Filter& filter, std::uint32_t sphere, bool disabled) noexcept {
  const Status status = check_edit(asset, filter);
  if (status != Status::kOk) {
    return status;
  }
  if (filter.disabled.size == 0) {
    return Status::kBadFilter;
  }
  if (sphere >= asset.spheres().size) {
    return Status::kBadArgument;
  }
  assign_bit(filter.disabled, sphere, disabled);
  return Status::kOk;
}

Status pad_sphere(const Asset& asset, Filter& filter, std::uint32_t sphere, float padding) noexcept {
  const Status status = check_edit(asset, filter);
  if (status != Status::kOk) {
    return status;
  }
  if (filter.padding.size == 0) {
    return Status::kBadFilter;
  }
  if (sphere >= asset.spheres().size || !std::isfinite(padding)) {
    return Status::kBadArgument;
  }
  filter.padding[sphere] = padding;
  return Status::kOk;
}

}  // namespace spherechain

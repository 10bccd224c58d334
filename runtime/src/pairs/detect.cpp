// SPDX-License-Identifier: MIT
#include "spherechain/detect.h"

#include <algorithm>

#include "asset/memory.h"
#include "asset/status.h"
#include "pairs/detect_steps.h"
#include "pairs/filter.h"
#include "pose/pose.h"
#include "simd/arithmetic.h"
#include "simd/simd.h"

namespace spherechain {
namespace {

Status check(const DetectJob& job, Target& resolved, DetectTable& table) {
  if (job.asset == nullptr) {
    return refuse(SC_NULL, SC_FIELD_ASSET);
  }
  const AssetView& asset = view_of(*job.asset);
  if (!asset.is_open()) {
    return refuse(SC_NOT_OPEN, SC_FIELD_ASSET);
  }
  if (job.spheres == nullptr) {
    return refuse(SC_NULL, SC_FIELD_SPHERES);
  }
  if (any_misaligned(job.spheres)) {
    return refuse(SC_MISALIGNED, SC_FIELD_SPHERES);
  }
  const Span<const Sphere> spheres{job.spheres, asset.spheres().size};
  if (job.sphere_count < spheres.size) {
    return refuse(SC_TOO_SMALL, SC_FIELD_SPHERES);
  }
  fetch(range_of(spheres));
  const Span<Pair> pairs{job.pairs, job.pair_capacity};
  if (is_missing(pairs) || any_misaligned(job.pairs)) {
    return refuse(is_missing(pairs) ? SC_NULL : SC_MISALIGNED, SC_FIELD_PAIRS);
  }
  const Span<std::uint64_t> bits{job.bits, job.bit_words};
  if (is_missing(bits) || any_misaligned(job.bits)) {
    return refuse(is_missing(bits) ? SC_NULL : SC_MISALIGNED, SC_FIELD_BITS);
  }
  if (bits.size > 0 && bits.size != words_for(pairs_of(spheres.size))) {
    return refuse(SC_BAD_VALUE, SC_FIELD_BITS);
  }
  if (!is_radius(job.radius)) {
    return refuse(SC_BAD_VALUE, SC_FIELD_RADIUS);
  }
  if (job.filter != nullptr) {
    // A table holds the filter that it was made with: another beside it would be ignored in silence.
    const Status status =
        job.table != nullptr ? refuse(SC_BAD_VALUE, SC_FIELD_FILTER) : check_filter(asset, *job.filter);
    if (status != SC_OK) {
      return status;
    }
  }
  if (job.table != nullptr) {
    const Status status = read_detect_table(asset, job.radius, job.table, table);
    if (status != SC_OK) {
      return status;
    }
  }
  if (!resolve_target(job.target, resolved)) {
    return refuse(SC_UNSUPPORTED_TARGET, SC_FIELD_TARGET);
  }
  const FilterRanges filter = ranges_of(job.filter);
  const bool is_aliased =
      any_shared({range_of(pairs), range_of(bits)}, {range_of(spheres), range_of(asset.ignored()),
                                                     range_of(Span<const std::uint64_t>{job.table, table.size}),
                                                     filter.ignored, filter.disabled, filter.padding});
  return is_aliased ? refuse(SC_ALIASED, pairs.size > 0 ? SC_FIELD_PAIRS : SC_FIELD_BITS) : done();
}

}  // namespace
}  // namespace spherechain

using namespace spherechain;

extern "C" {

size_t sc_pair_words(const sc_asset* asset) noexcept {
  return sc_asset_is_open(asset) != 0 ? words_for(pairs_of(view_of(*asset).spheres().size)) : 0;
}

size_t sc_sphere_words(const sc_asset* asset) noexcept {
  return sc_asset_is_open(asset) != 0 ? words_for(view_of(*asset).spheres().size) : 0;
}

sc_status sc_detect(sc_detect_job* job) noexcept {
  if (job == nullptr) {
    return refuse(SC_NULL, SC_FIELD_NONE);
  }
  Target resolved{};
  DetectTable table;
  const Status status = check(*job, resolved, table);
  if (status != SC_OK) {
    return status;
  }
  const AssetView& asset = view_of(*job->asset);
  Scene scene{&asset, job->spheres, asset.rest_pairs(job->radius), asset.ignored(), {}, {}, resolved, nullptr};
  if (job->table != nullptr) {
    scene.padding = table.padding;
    if (table.has_rows) {
      scene.rows = &table.rows;
    } else {
      scene.ignored = table.ignored;
      scene.disabled = table.disabled;
    }
  } else if (job->filter != nullptr) {
    scene.ignored = {job->filter->ignored, job->filter->ignored_words};
    scene.disabled = {job->filter->disabled, job->filter->disabled_words};
    scene.padding = {job->filter->padding, job->filter->padding_count};
  }
  Result result{{{job->pairs, job->pair_capacity}}, {job->bits, job->bit_words}};
  std::fill(result.bits.begin(), result.bits.end(), std::uint64_t{0});
  detect_all(scene, result);
  job->pair_count = result.pairs.count;
  return result.pairs.overflowed() ? refuse(SC_OVERFLOW, SC_FIELD_PAIRS) : done();
}

}  // extern "C"

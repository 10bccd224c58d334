// SPDX-License-Identifier: MIT
#include "spherechain/detect.h"

#include <algorithm>

#include "arithmetic.h"
#include "detect_steps.h"
#include "memory.h"
#include "simd.h"

namespace spherechain {
namespace {

// Does what is written share memory with anything else?
bool shares_memory(const DetectJob& job) {
  const std::size_t n = job.asset->spheres().size;
  const bool is_m1 = job.method == Method::kM1;
  const MemoryRange written[] = {
      range_of(job.pairs), range_of(job.bits), is_m1 ? range_of(job.chain_pairs) : MemoryRange{},
      is_m1 ? range_of(Span<std::uint64_t>{job.context->words.data, DetectContext::words_needed(*job.asset)})
            : MemoryRange{}};
  const MemoryRange read[] = {range_of(Span<const Sphere>{job.spheres.data, n}),
                              range_of(job.asset->ignored()),
                              job.table == nullptr ? MemoryRange{} : range_of(job.table->words),
                              job.filter == nullptr ? MemoryRange{} : range_of(job.filter->ignored),
                              job.filter == nullptr ? MemoryRange{} : range_of(job.filter->disabled),
                              job.filter == nullptr ? MemoryRange{} : range_of(job.filter->padding)};
  return any_shared(written, read);
}

Status check(const DetectJob& job, Target& resolved, PairRows& rows) {
  if (job.asset == nullptr || job.spheres.data == nullptr || is_missing(job.pairs) || is_missing(job.bits)) {
    return Status::kNullArgument;
  }
  if (!job.asset->is_open()) {
    return Status::kNotOpen;
  }
  if (any_misaligned(job.spheres.data, job.pairs.data, job.bits.data)) {
    return Status::kMisaligned;
  }
  if ((job.radius != RadiusKind::kFit && job.radius != RadiusKind::kDetect) ||
      (job.method != Method::kM1 && job.method != Method::kM2) || (job.first_only && job.method == Method::kM1) ||
      (job.bits.size > 0 && job.bits.size != DetectJob::bit_words(*job.asset))) {
    return Status::kBadArgument;
  }
  if (job.spheres.size < job.asset->spheres().size) {
    return Status::kTooFewSpheres;
  }
  fetch(range_of(Span<const Sphere>{job.spheres.data, job.asset->spheres().size}));
  if (job.method == Method::kM1) {
    if (job.context == nullptr || is_missing(job.context->words) || is_missing(job.chain_pairs)) {
      return Status::kNullArgument;
    }
    if (any_misaligned(job.context->words.data, job.chain_pairs.data)) {
      return Status::kMisaligned;
    }
    if (job.context->words.size < DetectContext::words_needed(*job.asset)) {
      return Status::kContextTooSmall;
    }
  }
  if (job.filter != nullptr) {
    const Status status = check_filter(*job.asset, *job.filter);
    if (status != Status::kOk) {
      return status;
    }
  }
  if (job.table != nullptr) {
    const Status status = read_table(*job.asset, job.radius, *job.table, rows);
    if (status != Status::kOk) {
      return status;
    }
  }
  if (!resolve_target(job.target, resolved)) {
    return Status::kUnsupportedTarget;
  }
  return shares_memory(job) ? Status::kSharedMemory : Status::kOk;
}

Scene scene_of(const DetectJob& job, Target resolved, const PairRows& rows) {
  Scene scene{job.asset, job.spheres.data, job.asset->near_pairs(job.radius), job.asset->ignored(), {}, {},
              resolved,  nullptr};
  if (job.table != nullptr && scene.size() <= kTileSize) {
    scene.rows = &rows;
  }
  if (job.filter != nullptr) {
    scene.ignored = {job.filter->ignored.data, job.filter->ignored.size};
    scene.disabled = {job.filter->disabled.data, job.filter->disabled.size};
    scene.padding = {job.filter->padding.data, job.filter->padding.size};
  }
  return scene;
}

// The least pair, into the buffers that may hold more.
void detect_first(const Scene& scene, Result& result) {
  Pair first{};
  Result found{{{&first, 1}, 0}, {}, {}, true, 0};
  detect_all(scene, found);
  result.tests = found.tests;
  if (found.pairs.count > 0) {
    result.pairs.add(first);
    if (result.bits.size > 0) {
      set_bit(result.bits, ignored_bit(first.a, first.b));
    }
  }
}

}  // namespace

std::size_t DetectContext::words_needed(const Asset& asset) noexcept {
  return words_for(pairs_of(asset.spheres().size));
}

std::size_t DetectJob::bit_words(const Asset& asset) noexcept { return words_for(pairs_of(asset.spheres().size)); }

Status DetectJob::run() noexcept {
  Target resolved{};
  PairRows rows;
  const Status status = check(*this, resolved, rows);
  if (status != Status::kOk) {
    return status;
  }
  const Scene scene = scene_of(*this, resolved, rows);
  Result result{{pairs}, {chain_pairs}, bits, first_only, 0};
  std::fill(bits.begin(), bits.end(), std::uint64_t{0});
  if (method == Method::kM1) {
    detect_chains(scene, {context->words.data, DetectContext::words_needed(*asset)}, result);
    chain_pair_count = result.chain_pairs.count;
  } else {
    if (first_only) {
      detect_first(scene, result);
    } else {
      detect_all(scene, result);
    }
    chain_pair_count = result.pairs.count;
  }
  pair_count = result.pairs.count;
  test_count = result.tests;
  return result.pairs.overflowed() || result.chain_pairs.overflowed() ? Status::kOverflow : Status::kOk;
}

}  // namespace spherechain

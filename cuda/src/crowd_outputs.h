// SPDX-License-Identifier: MIT
// The crowd's kernel: what it leaves in global memory.
#pragma once

#include "crowd_pairs.h"
#include "crowd_refit.h"

namespace spherechain::cuda {

// The words of the ordered bits that a warp lists.
struct Part {
  std::uint32_t first, last;
};

SPHERECHAIN_HD Part part_of(const GroupView& v, const Place& at, std::uint32_t warp) {
  const std::uint32_t each = (half_words(v) + at.warps() - 1) / at.warps(), first = warp * each;
  return {first, first + each < half_words(v) ? first + each : half_words(v)};
}

// Step 7: what an instance alone knows; the block's place in the list, and each warp's part of it.
SPHERECHAIN_HD void write_instances(const GroupView& v, const Shared& shared, const Place& at) {
  const std::uint32_t lane = at.lane(), first = at.block * kLanes, count = instances_in(v, at);
  if (at.thread < count && v.counts != nullptr) {
    v.counts[first + lane] = shared.counts[lane];
  }
  if (at.thread < count && v.bounds != nullptr) {
    const Vec3 middle = middle_of(shared, at);
    float radius = 0;
    std::memcpy(&radius, &shared.radii[lane], sizeof radius);
    v.bounds[first + lane] = {middle.x, middle.y, middle.z, radius};
  }
  if (v.bits != nullptr) {
    for (std::uint32_t from = at.warp(); from < count; from += at.warps()) {
      std::uint64_t* const to = v.bits + std::size_t{first + from} * v.bit_words;
      for (std::uint32_t i = lane; i < v.bit_words; i += kLanes) {
        const std::uint32_t* own = shared.bits + 2 * i * kPitch + from;
        to[i] = own[0] | std::uint64_t{own[kPitch]} << 32;
      }
    }
  }
  if (v.pairs != nullptr) {
    if (at.thread == 0) {
      std::uint64_t total = 0;
      for (std::uint32_t i = 0; i < count; ++i) {
        total += shared.counts[i];
      }
      *shared.start = reserve(v.pair_count, total);
    }
    const Part part = part_of(v, at, at.warp());
    std::uint32_t own = 0;
    for (std::uint32_t w = part.first; w < part.last; ++w) {
      own += count_bits(shared.ordered_bits[w * kPitch + lane]);
    }
    shared.parts[at.warp() * kLanes + lane] = own;
  }
}

// Step 8: the list, a lane an instance and a warp a part.
SPHERECHAIN_HD void write_pairs(const GroupView& v, const Shared& shared, const Place& at) {
  const std::uint32_t lane = at.lane(), instance = at.block * kLanes + lane;
  if (lane >= instances_in(v, at)) {
    return;
  }
  std::uint64_t place = *shared.start;
  for (std::uint32_t i = 0; i < lane; ++i) {
    place += shared.counts[i];
  }
  if (at.warp() == 0) {
    v.starts[instance] = place;
  }
  for (std::uint32_t warp = 0; warp < at.warp(); ++warp) {
    place += shared.parts[warp * kLanes + lane];
  }
  const Part part = part_of(v, at, at.warp());
  std::uint32_t a = 0, row = 0, row_end = v.sphere_count - 1;  // of a's bits
  for (std::uint32_t w = part.first; w < part.last; ++w) {
    for (std::uint32_t word = shared.ordered_bits[w * kPitch + lane]; word != 0; word &= word - 1, ++place) {
      const std::uint32_t bit = 32 * w + lowest_bit(word);
      while (bit >= row_end) {
        ++a;
        row = row_end;
        row_end += v.sphere_count - 1 - a;
      }
      if (place < v.pair_capacity) {
        v.pairs[place] = {instance, {a, a + 1 + (bit - row)}};
      }
    }
  }
}

}  // namespace spherechain::cuda

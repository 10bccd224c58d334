// SPDX-License-Identifier: MIT
// The kernel for bones: which spheres touch, by sc_detect()'s rule, and its outputs. A lane is an instance.
#pragma once

#include "crowd_bones.h"

namespace spherechain::cuda {

// A quick test that leaves no touching pair out. With p and q relative to a sphere of the instance, and
//   power(p) = rp^2 - |p|^2 / 2,
// (rp + rq)^2 / 2 <= rp^2 + rq^2 gives
//   power(p) + power(q) + p.q >= ((rp + rq)^2 - |p - q|^2) / 2,
// which is above 0 for spheres that touch. So that the computed sum is above 0 too, each power is raised by `margin`
// times |p|^2 + rp^2, which must be more than all roundings, and by 2^-120 for underflow. Where a figure is too large
// for that, or not finite, the power is infinite and the sum infinite or NaN, which is not below 0 either.
SPHERECHAIN_HD float power_of(const Vec3& p, float radius, float margin) {
  constexpr float kUnderflow = 0x1p-120F, kExtentMax = 1e36F;
  const float squared_length = fused(p.z, p.z, fused(p.y, p.y, p.x * p.x)), squared_radius = radius * radius;
  const float power = fused(1.0F + margin, squared_radius, fused(margin - 0.5F, squared_length, kUnderflow));
  return squared_length + squared_radius <= kExtentMax ? power : INFINITY;
}

// For multiply-adds. With G = |p|^2 + rp^2 + |q|^2 + rq^2, runtime/src/pairs/sphere_columns.h shows that a sum much
// like this one is off by at most 33 * 2^-24 G; the powers add 4 * 2^-24 G here, and the margin is 64 * 2^-24.
inline constexpr float kPowerMargin = 0x1p-18F;

// Step 6, a warp a sphere: powers. Also clears the outputs' bits, which lie where the matrices were.
SPHERECHAIN_HD void prepare_pairs(const GroupView& v, const Shared& shared, const Place& at) {
  const std::uint32_t lane = at.lane();
  const Float4& first = shared.spheres[lane];
  const Vec3 origin{first.x, first.y, first.z};
  for (std::uint32_t i = at.warp(); i < v.sphere_count; i += at.warps()) {
    const Float4 sphere = shared.spheres[i * kPitch + lane];
    const Vec3 seen{sphere.x - origin.x, sphere.y - origin.y, sphere.z - origin.z};
    shared.powers[i * kPitch + lane] = power_of(seen, sphere.w, kPowerMargin);
  }
  const std::uint32_t words = half_words(v) * kPitch;
  for (std::uint32_t i = at.thread; v.bits != nullptr && i < words; i += at.threads) {
    shared.bits[i] = 0;
  }
  for (std::uint32_t i = at.thread; v.pairs != nullptr && i < words; i += at.threads) {
    shared.ordered_bits[i] = 0;
  }
  if (at.thread < kLanes) {
    shared.counts[lane] = 0;
  }
}

// sc_detect()'s rule. `scale`: a rest pair's, else 1.
SPHERECHAIN_HD bool touch(const Float4& p, const Float4& q, float scale) {
  const float dx = p.x - q.x, dy = p.y - q.y, dz = p.z - q.z;
  const float s = p.w + q.w, squared = s * s, t = scale * s;
  return ((dx * dx + dy * dy) + dz * dz) < t * t && squared <= FLT_MAX;
}

// Sets the bits of the pairs a < b. `pitch` is the distance from one half word to the next.
SPHERECHAIN_HD void set_pair_bits(const GroupView& v, const Shared& shared, std::uint32_t a, std::uint32_t b,
                                  std::uint32_t pitch, std::uint32_t column) {
  if (v.bits != nullptr) {
    const std::uint32_t bit = b * (b - 1) / 2 + a;
    set_bits(&shared.bits[bit / 32 * pitch + column], 1U << (bit % 32));
  }
  if (v.pairs != nullptr) {
    const std::uint32_t bit = a * (2 * v.sphere_count - a - 1) / 2 + (b - a - 1);
    set_bits(&shared.ordered_bits[bit / 32 * pitch + column], 1U << (bit % 32));
  }
}

SPHERECHAIN_HD void decide(const GroupView& v, const Shared& shared, std::uint32_t lane, const Pair& pair,
                           float scale) {
  const Float4 p = shared.spheres[pair.a * kPitch + lane], q = shared.spheres[pair.b * kPitch + lane];
  if (touch(p, q, scale)) {
    add_to(&shared.counts[lane], 1U);
    set_pair_bits(v, shared, pair.a, pair.b, kPitch, lane);
  }
}

// The first of eight rows and of eight columns.
struct Corner {
  std::uint32_t row, column;
};

// The pair that a bit of PairColumns::wanted[half] stands for.
SPHERECHAIN_HD Pair pair_of_bit(const Corner& corner, std::uint32_t half, std::uint32_t bit) {
  const std::uint32_t at = kHalfItem - 1 - bit;
  return {corner.row + at % kRows, corner.column + at / kRows + half * kHalfColumns};
}

// Puts a lane's candidates into the queue, for a few lanes have most of them and all lanes share the queue. Decides at
// once about those that find no room.
SPHERECHAIN_HD void queue_candidates(const GroupView& v, const Shared& shared, std::uint32_t lane, const Corner& corner,
                                     std::uint32_t (&candidates)[2]) {
  const std::uint32_t count = count_bits(candidates[0]) + count_bits(candidates[1]);
  if (count == 0) {
    return;
  }
  std::uint32_t place = has_queue(v.sphere_count) ? add_to(&shared.dealt[2], count) : kBlockQueued;
  SPHERECHAIN_UNROLL
  for (std::uint32_t half = 0; half < 2; ++half) {
    SPHERECHAIN_ONE_BY_ONE
    for (std::uint32_t& left = candidates[half]; left != 0; left &= left - 1, ++place) {
      const Pair pair = pair_of_bit(corner, half, lowest_bit(left));
      if (place < kBlockQueued) {
        shared.queue[place] = (pair.b * kQueuedSpheresMax + pair.a) * kLanes + lane;
      } else {
        decide(v, shared, lane, pair, 1.0F);
      }
    }
  }
}

// A sphere relative to the origin, with its power.
SPHERECHAIN_HD Float4 seen_from(const Float4& origin, const Shared& shared, std::uint32_t place) {
  const Float4 s = shared.spheres[place];
  return {s.x - origin.x, s.y - origin.y, s.z - origin.z, shared.powers[place]};
}

SPHERECHAIN_HD void test_item(const GroupView& v, const Shared& shared, std::uint32_t lane, const PairItem& item) {
  const Float4 origin = shared.spheres[lane];
  const std::uint32_t first_row = item.first_row, count = item.count;
  Float4 rows[kRows];
  SPHERECHAIN_UNROLL
  for (std::uint32_t r = 0; r < kRows; ++r) {
    rows[r] = seen_from(origin, shared, first_row * kPitch + lane + r * kPitch);
  }
  SPHERECHAIN_ONE_BY_ONE
  for (std::uint32_t i = 0; i < count; ++i) {
    const PairColumns columns = item.columns[i];
    std::uint32_t apart[2] = {0, 0};
    SPHERECHAIN_UNROLL
    for (std::uint32_t c = 0; c < kColumns; ++c) {
      const Float4 column = seen_from(origin, shared, columns.first * kPitch + lane + c * kPitch);
      SPHERECHAIN_UNROLL
      for (std::uint32_t r = 0; r < kRows; ++r) {
        float sum = fused(rows[r].x, column.x, rows[r].w + column.w);
        sum = fused(rows[r].y, column.y, sum);
        sum = fused(rows[r].z, column.z, sum);
        apart[c / kHalfColumns] = shift_in_sign(apart[c / kHalfColumns], sum);
      }
    }
    // The pairs that the quick test leaves.
    std::uint32_t candidates[2] = {~apart[0] & columns.wanted[0], ~apart[1] & columns.wanted[1]};
    if (any_lane((candidates[0] | candidates[1]) != 0)) {
      queue_candidates(v, shared, lane, {first_row, columns.first}, candidates);
      rejoin();
    }
  }
}

// Step 7: a warp an item, then a warp some rest pairs.
SPHERECHAIN_HD void test_pairs(const GroupView& v, const Shared& shared, const Place& at) {
  constexpr std::uint32_t kRestPairsAtOnce = 8;
  const std::uint32_t lane = at.lane();
  std::uint32_t place = deal(&shared.dealt[1], at, 0), round = 1;
  for (; place < v.item_count; ++round) {
    const PairItem& item = v.items[place];
    place = deal(&shared.dealt[1], at, round);
    test_item(v, shared, lane, item);
  }
  for (; (place - v.item_count) * kRestPairsAtOnce < v.rest_pair_count; ++round) {
    const std::uint32_t first = (place - v.item_count) * kRestPairsAtOnce;
    const std::uint32_t end =
        first + kRestPairsAtOnce < v.rest_pair_count ? first + kRestPairsAtOnce : v.rest_pair_count;
    place = deal(&shared.dealt[1], at, round);
    for (std::uint32_t i = first; i < end; ++i) {
      const RestPairItem& pair = v.rest_pairs[i];
      decide(v, shared, lane, {pair.a, pair.b}, pair.rest_scale);
    }
  }
}

// Step 8: the queue.
SPHERECHAIN_HD void decide_queued(const GroupView& v, const Shared& shared, const Place& at) {
  const std::uint32_t taken = shared.dealt[2], count = taken < kBlockQueued ? taken : kBlockQueued;
  SPHERECHAIN_ONE_BY_ONE
  for (std::uint32_t i = at.thread; i < count; i += at.threads) {
    const std::uint32_t entry = shared.queue[i], pair = entry / kLanes;
    decide(v, shared, entry % kLanes, {pair % kQueuedSpheresMax, pair / kQueuedSpheresMax}, 1.0F);
  }
}

// The part of the ordered bits that one of several workers lists, in half words.
struct Part {
  std::uint32_t first, last;
};

SPHERECHAIN_HD Part part_of(const GroupView& v, std::uint32_t worker, std::uint32_t workers) {
  const std::uint32_t each = (half_words(v) + workers - 1) / workers, first = worker * each;
  return {first, first + each < half_words(v) ? first + each : half_words(v)};
}

// The pairs in a part. `pitch`: from one half word to the next.
SPHERECHAIN_HD std::uint32_t count_pairs(const std::uint32_t* ordered_bits, std::uint32_t pitch, const Part& part) {
  std::uint32_t out = 0;
  for (std::uint32_t i = part.first; i < part.last; ++i) {
    out += count_bits(ordered_bits[i * pitch]);
  }
  return out;
}

// Lists the pairs in a part from `place` on.
SPHERECHAIN_HD void list_pairs(const GroupView& v, const std::uint32_t* ordered_bits, std::uint32_t pitch,
                               const Part& part, std::uint32_t instance, std::uint64_t place) {
  std::uint32_t a = 0, row = 0, row_end = v.sphere_count - 1;  // the bits of a's pairs
  for (std::uint32_t i = part.first; i < part.last; ++i) {
    for (std::uint32_t word = ordered_bits[i * pitch]; word != 0; word &= word - 1, ++place) {
      const std::uint32_t bit = 32 * i + lowest_bit(word);
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

// Step 9: counts and bits, the block's place in the list, and the pairs in each warp's part of it.
SPHERECHAIN_HD void write_instances(const GroupView& v, const Shared& shared, const Place& at) {
  const std::uint32_t lane = at.lane(), first = at.block * kLanes, count = instances_in(v, at);
  if (at.thread < count && v.counts != nullptr) {
    v.counts[first + lane] = shared.counts[lane];
  }
  if (v.bits != nullptr) {
    for (std::uint32_t from = at.warp(); from < count; from += at.warps()) {
      std::uint64_t* const to = v.bits + std::size_t{first + from} * v.bit_words;
      for (std::uint32_t i = lane; i < v.bit_words; i += kLanes) {
        const std::uint32_t* halves = shared.bits + 2 * i * kPitch + from;
        to[i] = halves[0] | std::uint64_t{halves[kPitch]} << 32;
      }
    }
  }
  if (v.pairs != nullptr) {
    if (at.thread == 0) {
      std::uint64_t total = 0;
      for (std::uint32_t i = 0; i < count; ++i) {
        total += shared.counts[i];
      }
      *shared.start = add_to(v.pair_count, total);
    }
    shared.parts[at.warp() * kLanes + lane] =
        count_pairs(shared.ordered_bits + lane, kPitch, part_of(v, at.warp(), at.warps()));
  }
}

// Step 10: the list, a lane an instance and a warp a part.
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
  list_pairs(v, shared.ordered_bits + lane, kPitch, part_of(v, at.warp(), at.warps()), instance, place);
}

}  // namespace spherechain::cuda

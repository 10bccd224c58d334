// SPDX-License-Identifier: MIT
// The crowd's kernel: which spheres touch, by the rule of detect.h.
#pragma once

#include "crowd_primitives.h"

namespace spherechain::cuda {

// Half of what radii r add to the squared reach of two spheres is at most rp^2 + rq^2. So with p and q seen from the
// instance's first sphere, and power(p) = rp^2 - |p|^2 / 2,
//   power(p) + power(q) + p.q >= ((rp + rq)^2 - |p - q|^2) / 2,
// which is above 0 where they touch. With G = |p|^2 + rp^2 of both, runtime/src/sphere_columns.h shows of a sum much as
// this one that it is off by 33 * 2^-24 G at most; here each power adds 2 more. Each is larger by 64 * 2^-24 of its own
// sphere's share of G, and by 2^-120 for what underflows: so the computed sum is above 0 too. For what is too large for
// that, or not finite, it is infinite or no number, and not below 0 either.
SPHERECHAIN_HD float power_of(const Float4& s, const Float4& origin) {
  constexpr float kMargin = 0x1p-18F, kLeast = 0x1p-120F, kMostExtent = 1e36F;
  const float x = s.x - origin.x, y = s.y - origin.y, z = s.z - origin.z;
  const float squared_length = fused(z, z, fused(y, y, x * x)), squared_radius = s.w * s.w;
  const float power = fused(1.0F + kMargin, squared_radius, fused(kMargin - 0.5F, squared_length, kLeast));
  return squared_length + squared_radius <= kMostExtent ? power : INFINITY;
}

// Covers are so much larger in the test that what it rounds parts no two that touch: the squared distance is off by 5
// roundings at most, the squared sum of radii by 5 with this one.
inline constexpr float kCoverShare = 1.0F + 0x1p-20F;

// The box around the centres of the warp's own spheres.
SPHERECHAIN_HD void box_spheres(const GroupView& v, const Shared& shared, const Place& at) {
  const std::uint32_t lane = at.lane();
  float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (std::uint32_t i = at.warp(); i < v.sphere_count; i += at.warps()) {
    const Float4 sphere = shared.spheres[i * kPitch + lane];
    const float center[] = {sphere.x, sphere.y, sphere.z};
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = fminf(low[axis], center[axis]);
      high[axis] = fmaxf(high[axis], center[axis]);
    }
  }
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    shared.boxes[(2 * axis * kMostWarps + at.warp()) * kLanes + lane] = low[axis];
    shared.boxes[((2 * axis + 1) * kMostWarps + at.warp()) * kLanes + lane] = high[axis];
  }
}

// Step 4: a warp a sphere; and the outputs' bits, which lie where the matrices were.
template <bool kCovers>
SPHERECHAIN_HD void prepare_pairs(const GroupView& v, const Shared& shared, const Place& at) {
  const std::uint32_t lane = at.lane();
  const Float4 origin = shared.spheres[lane];
  for (std::uint32_t i = at.warp(); i < v.sphere_count; i += at.warps()) {
    Float4 sphere = shared.spheres[i * kPitch + lane];
    if (kCovers) {
      sphere.w *= kCoverShare;
    }
    if (v.has_padding) {
      sphere.w += v.paddings[i];
      if (!kCovers && sphere.w < 0) {
        sphere.w = NAN;  // touches nothing; a cover that is no number might touch anything, see may_touch
      }
    }
    if (kCovers || v.has_padding) {
      shared.spheres[i * kPitch + lane].w = sphere.w;
    }
    shared.powers[i * kPitch + lane] = power_of(sphere, origin);
  }
  if (v.bounds != nullptr) {
    box_spheres(v, shared, at);
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
    if (v.bounds != nullptr) {
      shared.radii[lane] = 0;
    }
  }
}

// detect.h's rule; `reach` 1 for pairs that are not near ones.
SPHERECHAIN_HD bool touch(const Float4& p, const Float4& q, float reach) {
  const float dx = p.x - q.x, dy = p.y - q.y, dz = p.z - q.z;
  const float s = p.w + q.w, squared = s * s, t = reach * s;
  return ((dx * dx + dy * dy) + dz * dz) < t * t && squared <= FLT_MAX;
}

// Covers: unless they are surely apart, which those that are not finite never are, or padded to below 0.
SPHERECHAIN_HD bool may_touch(const Float4& p, const Float4& q) {
  const float dx = p.x - q.x, dy = p.y - q.y, dz = p.z - q.z, s = p.w + q.w;
  return !((dx * dx + dy * dy) + dz * dz > s * s) && !(p.w < 0) && !(q.w < 0);
}

SPHERECHAIN_HD void report(const GroupView& v, const Shared& shared, std::uint32_t lane, std::uint32_t a,
                           std::uint32_t b) {
  add_to(&shared.counts[lane], 1);
  if (v.bits != nullptr) {
    const std::uint32_t bit = b * (b - 1) / 2 + a;
    set_bits(&shared.bits[bit / 32 * kPitch + lane], 1U << (bit % 32));
  }
  if (v.pairs != nullptr) {
    const std::uint32_t bit = a * (2 * v.sphere_count - a - 1) / 2 + (b - a - 1);
    set_bits(&shared.ordered_bits[bit / 32 * kPitch + lane], 1U << (bit % 32));
  }
}

// Eight rows and columns, by their first ones.
struct Corner {
  std::uint32_t row, column;
};

// The pair of a bit of PairColumns::wanted[half].
SPHERECHAIN_HD Pair pair_of_bit(const Corner& corner, std::uint32_t half, std::uint32_t bit) {
  const std::uint32_t at = kHalfItem - 1 - bit;
  return {corner.row + at % kRows, corner.column + at / kRows + half * kHalfColumns};
}

template <bool kCovers>
SPHERECHAIN_HD void decide(const GroupView& v, const Shared& shared, std::uint32_t lane, const Pair& pair) {
  const Float4 p = shared.spheres[pair.a * kPitch + lane], q = shared.spheres[pair.b * kPitch + lane];
  if (kCovers ? may_touch(p, q) : touch(p, q, 1.0F)) {
    report(v, shared, lane, pair.a, pair.b);
  }
}

// Each lane about its own.
template <bool kCovers>
SPHERECHAIN_HD void decide_at_once(const GroupView& v, const Shared& shared, std::uint32_t lane, const Corner& corner,
                                   std::uint32_t (&candidates)[2]) {
  while (any_lane((candidates[0] | candidates[1]) != 0)) {
    if ((candidates[0] | candidates[1]) != 0) {
      const std::uint32_t half = candidates[0] != 0 ? 0 : 1, word = candidates[0] != 0 ? candidates[0] : candidates[1];
      candidates[0] = half == 0 ? word & (word - 1) : 0;
      candidates[1] = half == 0 ? candidates[1] : word & (word - 1);
      decide<kCovers>(v, shared, lane, pair_of_bit(corner, half, lowest_bit(word)));
    }
  }
}

SPHERECHAIN_HD std::uint32_t queue_entry(std::uint32_t lane, const Pair& pair) {
  return (pair.b * kMostQueuedSpheres + pair.a) * kLanes + lane;
}

inline constexpr std::uint32_t kNoEntry = ~0U;  // of a sphere with itself

// Few lanes have many candidates: all lanes decide about all of them later. Those of a lane for which there is no room
// stay with it.
SPHERECHAIN_HD void queue_candidates(const Shared& shared, std::uint32_t lane, const Corner& corner,
                                     std::uint32_t (&candidates)[2]) {
  const std::uint32_t count = count_bits(candidates[0]) + count_bits(candidates[1]);
  if (count == 0) {
    return;
  }
  std::uint32_t place = take_places(&shared.dealt[2], count);
  if (place + count > kBlockQueued) {
    for (; place < kBlockQueued; ++place) {
      shared.queue[place] = kNoEntry;
    }
    return;
  }
  SPHERECHAIN_UNROLL
  for (std::uint32_t half = 0; half < 2; ++half) {
    SPHERECHAIN_ONE_BY_ONE
    for (std::uint32_t& left = candidates[half]; left != 0; left &= left - 1) {
      shared.queue[place++] = queue_entry(lane, pair_of_bit(corner, half, lowest_bit(left)));
    }
  }
}

// A sphere as it is seen from the origin, with its power.
SPHERECHAIN_HD Float4 seen_from(const Float4& origin, const Shared& shared, std::uint32_t place) {
  const Float4 s = shared.spheres[place];
  return {s.x - origin.x, s.y - origin.y, s.z - origin.z, shared.powers[place]};
}

template <bool kCovers>
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
    // What multiply-adds cannot tell apart from touching.
    std::uint32_t candidates[2] = {~apart[0] & columns.wanted[0], ~apart[1] & columns.wanted[1]};
    if (any_lane((candidates[0] | candidates[1]) != 0)) {
      const Corner corner{first_row, columns.first};
      if (has_queue(v.sphere_count, kCovers)) {
        queue_candidates(shared, lane, corner, candidates);
      }
      decide_at_once<kCovers>(v, shared, lane, corner, candidates);
    }
  }
}

SPHERECHAIN_HD void test_near(const GroupView& v, const Shared& shared, std::uint32_t lane, const NearEntry& near) {
  if (touch(shared.spheres[near.a * kPitch + lane], shared.spheres[near.b * kPitch + lane], near.reach)) {
    report(v, shared, lane, near.a, near.b);
  }
}

// The middle of the box around all centres, and how far the warp's own spheres reach from there.
SPHERECHAIN_HD Vec3 middle_of(const Shared& shared, const Place& at) {
  float middle[3];
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    float low = INFINITY, high = -INFINITY;
    for (std::uint32_t warp = 0; warp < at.warps(); ++warp) {
      low = fminf(low, shared.boxes[(2 * axis * kMostWarps + warp) * kLanes + at.lane()]);
      high = fmaxf(high, shared.boxes[((2 * axis + 1) * kMostWarps + warp) * kLanes + at.lane()]);
    }
    middle[axis] = 0.5F * low + 0.5F * high;
  }
  return {middle[0], middle[1], middle[2]};
}

SPHERECHAIN_HD void reach_spheres(const GroupView& v, const Shared& shared, const Place& at) {
  const Vec3 middle = middle_of(shared, at);
  float most = 0;
  for (std::uint32_t i = at.warp(); i < v.sphere_count; i += at.warps()) {
    const Float4 s = shared.spheres[i * kPitch + at.lane()];
    const float dx = s.x - middle.x, dy = s.y - middle.y, dz = s.z - middle.z;
    most = fmaxf(most, sqrtf((dx * dx + dy * dy) + dz * dz) + s.w);
  }
  raise_to(&shared.radii[at.lane()], most * (1.0F + 0x1p-20F));  // for what was rounded
}

// Step 5: a warp an item, then a warp some near pairs.
template <bool kCovers>
SPHERECHAIN_HD void test_pairs(const GroupView& v, const Shared& shared, const Place& at) {
  constexpr std::uint32_t kNearAtATime = 8;
  const std::uint32_t lane = at.lane();
  std::uint32_t place = deal(&shared.dealt[1], at, 0), round = 1;
  for (; place < v.item_count; ++round) {
    const PairItem& item = v.items[place];
    place = deal(&shared.dealt[1], at, round);
    test_item<kCovers>(v, shared, lane, item);
  }
  for (; (place - v.item_count) * kNearAtATime < v.near_count; ++round) {
    const std::uint32_t first = (place - v.item_count) * kNearAtATime;
    const std::uint32_t end = first + kNearAtATime < v.near_count ? first + kNearAtATime : v.near_count;
    place = deal(&shared.dealt[1], at, round);
    for (std::uint32_t i = first; i < end; ++i) {
      test_near(v, shared, lane, v.near[i]);
    }
  }
  if (v.bounds != nullptr) {
    reach_spheres(v, shared, at);
  }
}

// Step 6: what was queued.
SPHERECHAIN_HD void decide_queued(const GroupView& v, const Shared& shared, const Place& at) {
  const std::uint32_t taken = shared.dealt[2], count = taken < kBlockQueued ? taken : kBlockQueued;
  SPHERECHAIN_ONE_BY_ONE
  for (std::uint32_t i = at.thread; i < count; i += at.threads) {
    const std::uint32_t entry = shared.queue[i];
    if (entry != kNoEntry) {
      const std::uint32_t pair = entry / kLanes;
      decide<false>(v, shared, entry % kLanes, {pair % kMostQueuedSpheres, pair / kMostQueuedSpheres});
    }
  }
}

}  // namespace spherechain::cuda

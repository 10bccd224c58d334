// SPDX-License-Identifier: MIT
// The crowd's kernel where the instances come as spheres: a warp takes one, its lanes share the pairs. By the rule of
// detect.h.
#pragma once

#include "crowd_pairs.h"
#include "crowd_units.h"

namespace spherechain::cuda {

// What each lane does with its share of `count` things. All lanes go round as often, and so stay together.
template <typename Visit>
SPHERECHAIN_HD void for_each_of(std::uint32_t count, std::uint32_t lane, const Visit& visit) {
  SPHERECHAIN_ONE_BY_ONE
  for (std::uint32_t first = 0; first < count; first += kLanes) {
    if (first + lane < count) {
      visit(first + lane);
    }
  }
}

template <std::uint32_t kTurns, typename Visit>
SPHERECHAIN_HD void take_turns(std::uint32_t lane, const Visit& visit) {
  SPHERECHAIN_UNROLL
  for (std::uint32_t turn = 0; turn < kTurns; ++turn) {
    visit(turn * kLanes + lane);
  }
}

// The same of as many as lanes_of() says: no lane asks whether there is that many. The usual numbers without a loop, so
// that places are worked out once.
template <typename Visit>
SPHERECHAIN_HD void for_all_lanes_of(std::uint32_t count, std::uint32_t lane, const Visit& visit) {
  const std::uint32_t turns = lanes_of(count) / kLanes;
  if (turns == 2) {
    take_turns<2>(lane, visit);
  } else if (turns == 3) {
    take_turns<3>(lane, visit);
  } else {
    SPHERECHAIN_ONE_BY_ONE
    for (std::uint32_t turn = 0; turn < turns; ++turn) {
      visit(turn * kLanes + lane);
    }
  }
}

// The instance's spheres, where they come as such. Past the last sphere it is the last once more.
SPHERECHAIN_HD void load_spheres(const GroupView& v, const Own& own) {
  const Sphere* const from = v.spheres + own.instance * v.sphere_stride;
  const std::uint32_t last = v.sphere_count - 1;
  if (v.wide_spheres) {
    for_all_lanes_of(v.sphere_count, own.lane,
                     [&](std::uint32_t i) { copy_past_cache(own.spheres + i, &from[i < last ? i : last].x); });
    arrive();
  } else {
    for_all_lanes_of(v.sphere_count, own.lane, [&](std::uint32_t i) {
      const Sphere& sphere = from[i < last ? i : last];
      own.spheres[i] = {sphere.x, sphere.y, sphere.z, sphere.radius};
    });
  }
}

// The filter's padding. What is padded to below 0 touches nothing.
SPHERECHAIN_HD void pad_spheres(const GroupView& v, const Own& own) {
  for_each_of(v.sphere_count, own.lane, [&](std::uint32_t i) {
    const float radius = own.spheres[i].w + v.paddings[i];
    own.spheres[i].w = radius < 0 ? NAN : radius;
  });
}

// The spheres as the units are tested by them, and nothing found yet. Past the last sphere anything will do.
SPHERECHAIN_HD void see_spheres(const GroupView& v, const Own& own) {
  const std::uint32_t pitch = seen_pitch(v);
  const Float4 origin = own.spheres[v.origin_sphere];
  float* const seen_by_lane = own.seen + place_of(own.lane);
  float* const powers_by_lane = own.powers + own.lane / 2 * 4 + own.lane % 2;
  for_all_lanes_of(v.sphere_count, own.lane, [&](std::uint32_t i) {
    const Float4 seen = see_sphere(own.spheres[i], origin);
    float *to = seen_by_lane + (i - own.lane), *powers = powers_by_lane + 2 * (i - own.lane);
    to[0] = seen.x;
    to[pitch] = seen.y;
    to[2 * pitch] = seen.z;
    to[3 * pitch] = powers[0] = powers[2] = seen.w;
  });
  if (v.bits != nullptr) {
    for_each_of(v.bit_words, own.lane, [&](std::uint32_t i) { own.bits[i] = 0; });
  }
  if (v.pairs != nullptr) {
    for_each_of(v.bit_words, own.lane, [&](std::uint32_t i) { own.ordered_bits[i] = 0; });
  }
  set_alike(own.state->found, Found{});
}

SPHERECHAIN_HD void set_bit(std::uint64_t* words, std::uint32_t bit) {
  set_bits(reinterpret_cast<std::uint32_t*>(words) + bit / 32, 1U << (bit % 32));
}

// Whether two touch, 1 or 0; its bits are set then.
SPHERECHAIN_HD std::uint32_t decide(const GroupView& v, const Own& own, std::uint32_t a, std::uint32_t b, float reach) {
  const Float4 p = own.spheres[a], q = own.spheres[b];
  if (!touch(p, q, reach)) {
    return 0;
  }
  if (v.bits != nullptr) {
    set_bit(own.bits, b * (b - 1) / 2 + a);
  }
  if (v.pairs != nullptr) {
    set_bit(own.ordered_bits, a * (2 * v.sphere_count - a - 1) / 2 + (b - a - 1));
  }
  return 1;
}

// Of OwnState::queue.
SPHERECHAIN_HD std::uint32_t decide_queued(const GroupView& v, const Own& own, std::uint32_t entry) {
  const std::uint32_t place = v.unit_places[entry / (kLanes * kLanePairs)];
  const std::uint32_t pair = entry / kLanes % kLanePairs, lane = entry % kLanes;
  return decide(v, own, (place & 0xFFFFU) * kUnit + row_of(lane, pair), (place >> 16) * kUnit + column_of(lane, pair),
                1.0F);
}

SPHERECHAIN_HD std::uint32_t entry_of(const Own& own, std::uint32_t word, std::uint32_t pair) {
  return (word * kWordUnits * kLanePairs + pair) * kLanes + own.lane;
}

// Queues the pairs that some words' sums cannot tell apart from touching ones; where the queue has no room for all of
// the lane's, it says that it is full.
template <std::uint32_t kWords>
SPHERECHAIN_HD void queue_pairs(const Own& own, std::uint32_t (&found)[kWords]) {
  std::uint32_t count = 0;
  SPHERECHAIN_UNROLL
  for (const std::uint32_t word : found) {
    count += count_bits(word);
  }
  if (count == 0) {
    return;
  }
  std::uint32_t place = take_places(&own.state->found.queued, count);
  if (place + count > kQueued) {
    set_alike(own.state->found.is_full, 1U);
    return;
  }
  SPHERECHAIN_UNROLL
  for (std::uint32_t word = 0; word < kWords; ++word) {
    SPHERECHAIN_ONE_BY_ONE
    for (std::uint32_t& left = found[word]; left != 0; ++place) {
      const std::uint32_t pair = leading_zeros(left);
      left ^= 0x80000000U >> pair;
      own.state->queue[place] = entry_of(own, word, pair);
    }
  }
}

// The same of one word; what finds no room is decided at once.
SPHERECHAIN_HD void queue_or_decide(const GroupView& v, const Own& own, std::uint32_t word, std::uint32_t found) {
  while (any_lane(found != 0)) {
    if (found != 0) {
      const std::uint32_t pair = leading_zeros(found), place = take_place(&own.state->found.queued);
      const std::uint32_t entry = entry_of(own, word, pair);
      found ^= 0x80000000U >> pair;
      if (place < kQueued) {
        own.state->queue[place] = entry;
      } else {
        add_to(&own.state->found.count, decide_queued(v, own, entry));
      }
    }
  }
}

SPHERECHAIN_HD void shift_in(const float (&sums)[kLanePairs], std::uint32_t& apart) {
  SPHERECHAIN_UNROLL
  for (const float sum : sums) {
    apart = shift_in_sign(apart, sum);
  }
}

// The usual number of units, all in registers.
template <std::uint32_t kUnits>
SPHERECHAIN_HD void find_pairs_of(const GroupView& v, const Own& own) {
  constexpr std::uint32_t kAll = kUnits * (kUnits + 1) / 2, kWords = (kAll + kWordUnits - 1) / kWordUnits;
  const Units units(v, own);
  std::uint32_t found[kWords], apart = 0, unit = 0;
  Units::Rows rows[kUnits];
  SPHERECHAIN_UNROLL
  for (std::uint32_t word = 0; word < kWords; ++word) {
    found[word] = v.wanted[word * kLanes + own.lane];
  }
  SPHERECHAIN_UNROLL
  for (std::uint32_t r = 0; r < kUnits; ++r) {
    rows[r] = units.rows(r);
  }
  SPHERECHAIN_UNROLL
  for (std::uint32_t c = 0; c < kUnits; ++c) {
    const Units::Columns columns = units.columns(c, rows[c]);
    SPHERECHAIN_UNROLL
    for (std::uint32_t r = 0; r <= c; ++r, ++unit) {
      float sums[kLanePairs];
      Units::sum(rows[r], columns, sums);
      shift_in(sums, apart);
      if (unit % kWordUnits == kWordUnits - 1 || unit == kAll - 1) {
        const std::uint32_t word = unit / kWordUnits, missing = kWordUnits - 1 - unit % kWordUnits;
        found[word] &= ~(apart << missing * kLanePairs);
      }
    }
  }
  queue_pairs(own, found);
}

SPHERECHAIN_HD void find_pairs_of_any(const GroupView& v, const Own& own) {
  const Units units(v, own);
  const std::uint32_t words = words_of_units(units_of(v.sphere_count));
  for (std::uint32_t word = 0; word < words; ++word) {
    const std::uint32_t wanted = v.wanted[word * kLanes + own.lane];
    std::uint32_t apart = 0;
    SPHERECHAIN_UNROLL
    for (std::uint32_t unit = 0; unit < kWordUnits; ++unit) {
      const std::uint32_t place = v.unit_places[word * kWordUnits + unit], column = place >> 16;
      float sums[kLanePairs];
      Units::sum(units.rows(place & 0xFFFFU), units.columns(column, units.rows(column)), sums);
      shift_in(sums, apart);
    }
    queue_or_decide(v, own, word, ~apart & wanted);
  }
}

SPHERECHAIN_HD void find_pairs(const GroupView& v, const Own& own) {
  switch (units_of(v.sphere_count)) {
    case 4:
      return find_pairs_of<4>(v, own);
    case 5:
      return find_pairs_of<5>(v, own);
    default:
      return find_pairs_of_any(v, own);
  }
}

// What was queued, and the near pairs, past the last of which those are that never touch.
SPHERECHAIN_HD void decide_pairs(const GroupView& v, const Own& own) {
  std::uint32_t touching = 0;
  for_all_lanes_of(v.near_count, own.lane, [&](std::uint32_t i) {
    const NearEntry near = v.near[i];
    touching += decide(v, own, near.a, near.b, near.reach);
  });
  if (own.state->found.is_full == 0) {
    const std::uint32_t queued = own.state->found.queued < kQueued ? own.state->found.queued : kQueued;
    for_each_of(queued, own.lane, [&](std::uint32_t i) { touching += decide_queued(v, own, own.state->queue[i]); });
  } else {  // those that were not queued are not known
    const std::uint32_t words = words_of_units(units_of(v.sphere_count));
    SPHERECHAIN_ONE_BY_ONE
    for (std::uint32_t word = 0; word < words; ++word) {
      SPHERECHAIN_ONE_BY_ONE
      for (std::uint32_t left = v.wanted[word * kLanes + own.lane]; left != 0; left &= left - 1) {
        touching += decide_queued(v, own, (word * 32 + 31 - lowest_bit(left)) * kLanes + own.lane);
      }
    }
  }
  add_to(&own.state->found.count, touching);
}

// Of the box around all centres, what the lane sees of it.
SPHERECHAIN_HD void box_spheres(const GroupView& v, const Own& own) {
  float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (std::uint32_t i = own.lane; i < v.sphere_count; i += kLanes) {
    const Float4 sphere = own.spheres[i];
    const float center[] = {sphere.x, sphere.y, sphere.z};
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = fminf(low[axis], center[axis]);
      high[axis] = fmaxf(high[axis], center[axis]);
    }
  }
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    own.boxes[axis * kLanes + own.lane] = low[axis];
    own.boxes[(3 + axis) * kLanes + own.lane] = high[axis];
  }
}

SPHERECHAIN_HD void join_boxes(const Own& own) {
  const std::uint32_t lane = own.lane;
  if (lane < kBoxFigures) {
    const float* const figures = own.boxes + lane * kLanes;
    float joined = figures[0];
    for (std::uint32_t i = 1; i < kLanes; ++i) {
      joined = lane < 3 ? fminf(joined, figures[i]) : fmaxf(joined, figures[i]);
    }
    own.state->box[lane] = joined;
  }
}

SPHERECHAIN_HD Vec3 middle_of(const float (&box)[kBoxFigures]) {
  return {0.5F * box[0] + 0.5F * box[3], 0.5F * box[1] + 0.5F * box[4], 0.5F * box[2] + 0.5F * box[5]};
}

// How far the lane's spheres reach from the middle of the box around all centres.
SPHERECHAIN_HD void reach_spheres(const GroupView& v, const Own& own) {
  const Vec3 middle = middle_of(own.state->box);
  float most = 0;
  for (std::uint32_t i = own.lane; i < v.sphere_count; i += kLanes) {
    const Float4 s = own.spheres[i];
    const float dx = s.x - middle.x, dy = s.y - middle.y, dz = s.z - middle.z;
    most = fmaxf(most, sqrtf((dx * dx + dy * dy) + dz * dz) + s.w);
  }
  raise_to(&own.state->found.radius, most * (1.0F + 0x1p-20F));  // for what was rounded
}

// The words of the ordered bits that a lane lists.
struct WordPart {
  std::uint32_t first, last;
};

SPHERECHAIN_HD WordPart word_part(const GroupView& v, std::uint32_t lane) {
  const std::uint32_t each = (v.bit_words + kLanes - 1) / kLanes, first = lane * each;
  return {first, first + each < v.bit_words ? first + each : v.bit_words};
}

// The instance's place in the list too, and each lane's part of it.
SPHERECHAIN_HD void write_instance(const GroupView& v, const Own& own) {
  if (v.bounds != nullptr) {
    const Vec3 middle = middle_of(own.state->box);
    float radius = 0;
    std::memcpy(&radius, &own.state->found.radius, sizeof radius);
    set_alike(v.bounds[own.instance], Sphere{middle.x, middle.y, middle.z, radius});
  }
  if (v.bits != nullptr) {
    std::uint64_t* const to = v.bits + std::size_t{own.instance} * v.bit_words;
    for_each_of(v.bit_words, own.lane, [&](std::uint32_t i) { to[i] = own.bits[i]; });
  }
  if (v.counts != nullptr) {
    set_alike(v.counts[own.instance], own.state->found.count);
  }
  if (v.pairs != nullptr) {
    if (own.lane == 0) {
      v.starts[own.instance] = own.state->start = reserve(v.pair_count, own.state->found.count);
    }
    const WordPart part = word_part(v, own.lane);
    std::uint32_t pairs = 0;
    for (std::uint32_t w = part.first; w < part.last; ++w) {
      pairs += count_bits(own.ordered_bits[w]);
    }
    own.parts[own.lane] = pairs;
  }
}

// The pair that an ordered bit is for: those of sphere a are from a (2 n - a - 1) / 2 on.
SPHERECHAIN_HD Pair pair_at(std::uint32_t n, std::uint32_t bit) {
  const auto first = [n](std::uint32_t a) { return a * (2 * n - a - 1) / 2; };
  const float side = static_cast<float>(2 * n - 1);
  const float guess = 0.5F * (side - sqrtf(fmaxf(0.0F, side * side - 8.0F * static_cast<float>(bit))));
  auto a = static_cast<std::uint32_t>(fminf(fmaxf(guess, 0.0F), static_cast<float>(n - 2)));
  while (first(a) > bit) {
    --a;
  }
  while (first(a + 1) <= bit) {
    ++a;
  }
  return {a, a + 1 + (bit - first(a))};
}

SPHERECHAIN_HD void write_pairs(const GroupView& v, const Own& own) {
  if (own.parts[own.lane] == 0) {
    return;
  }
  std::uint64_t place = own.state->start;
  for (std::uint32_t i = 0; i < own.lane; ++i) {
    place += own.parts[i];
  }
  const WordPart part = word_part(v, own.lane);
  for (std::uint32_t w = part.first; w < part.last; ++w) {
    for (std::uint64_t word = own.ordered_bits[w]; word != 0; word &= word - 1, ++place) {
      if (place < v.pair_capacity) {
        v.pairs[place] = {own.instance, pair_at(v.sphere_count, 64 * w + lowest_bit(word))};
      }
    }
  }
}

}  // namespace spherechain::cuda

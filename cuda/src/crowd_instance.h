// SPDX-License-Identifier: MIT
// The kernel for spheres: a warp takes an instance and its lanes share the pairs. By sc_detect()'s rule.
#pragma once

#include "crowd_units.h"

namespace spherechain::cuda {

// Calls visit(i) for the lane's share of i < count. All lanes go round equally often and so stay together.
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

// The same for i < lanes_of(count): no lane asks whether i exists. The usual counts go without a loop, so that
// addresses are computed once.
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

// Places past the last sphere get the last sphere once more.
SPHERECHAIN_HD void load_spheres(const GroupView& v, const WarpInstance& w) {
  const auto* const from = reinterpret_cast<const Float4*>(v.spheres + w.instance * v.instance_stride);
  const std::uint32_t last = v.sphere_count - 1;
  for_all_lanes_of(v.sphere_count, w.lane, [&](std::uint32_t i) {
    const Float4* const sphere = from + (i < last ? i : last);
    if (v.in_scratch) {
      w.spheres[i] = *sphere;
    } else {
      copy_past_cache(w.spheres + i, &sphere->x);
    }
  });
  wait_for_copies();
}

// Fills in what the quick test reads; past the last sphere any figures will do. Clears what is found.
SPHERECHAIN_HD void see_spheres(const GroupView& v, const WarpInstance& w) {
  const std::uint32_t pitch = seen_pitch(v);
  const Float4 origin = w.spheres[v.origin_sphere];
  float* const seen_by_lane = w.seen + place_of(w.lane);
  float* const powers_by_lane = w.powers + w.lane / 2 * 4 + w.lane % 2;
  for_all_lanes_of(v.sphere_count, w.lane, [&](std::uint32_t i) {
    const Float4 seen = see_sphere(w.spheres[i], origin);
    float *to = seen_by_lane + (i - w.lane), *powers = powers_by_lane + 2 * (i - w.lane);
    to[0] = seen.x;
    to[pitch] = seen.y;
    to[2 * pitch] = seen.z;
    to[3 * pitch] = powers[0] = powers[2] = seen.w;
  });
  if (v.bits != nullptr) {
    for_each_of(half_words(v), w.lane, [&](std::uint32_t i) { w.bits[i] = 0; });
  }
  if (v.pairs != nullptr) {
    for_each_of(half_words(v), w.lane, [&](std::uint32_t i) { w.ordered_bits[i] = 0; });
  }
  set_alike(w.state->count, 0);
  set_alike(w.state->queued, 0);
}

// Returns 1 and sets the pair's bits if it touches, else 0.
SPHERECHAIN_HD std::uint32_t decide(const GroupView& v, const WarpInstance& w, std::uint32_t a, std::uint32_t b,
                                    float scale) {
  const Float4 p = w.spheres[a], q = w.spheres[b];
  if (!touch(p, q, scale)) {
    return 0;
  }
  set_pair_bits(v, w, a, b, 1, 0);
  return 1;
}

// `entry`: of WarpState::queue.
SPHERECHAIN_HD std::uint32_t decide_queued(const GroupView& v, const WarpInstance& w, std::uint32_t entry) {
  const std::uint32_t place = v.unit_places[entry / (kLanes * kLanePairs)];
  const std::uint32_t pair = entry / kLanes % kLanePairs, lane = entry % kLanes;
  return decide(v, w, (place & 0xFFFFU) * kUnit + row_of(lane, pair), (place >> 16) * kUnit + column_of(lane, pair),
                1.0F);
}

// Puts the pairs that the quick test leaves in the lane's words, from `first` on, into the queue. Decides at once about
// those that find no room.
template <std::uint32_t kWords>
SPHERECHAIN_HD void queue_pairs(const GroupView& v, const WarpInstance& w, std::uint32_t first,
                                std::uint32_t (&found)[kWords]) {
  std::uint32_t count = 0, touching = 0;
  SPHERECHAIN_UNROLL
  for (const std::uint32_t word : found) {
    count += count_bits(word);
  }
  if (count == 0) {
    return;
  }
  std::uint32_t place = add_to(&w.state->queued, count);
  SPHERECHAIN_UNROLL
  for (std::uint32_t word = 0; word < kWords; ++word) {
    SPHERECHAIN_ONE_BY_ONE
    for (std::uint32_t& left = found[word]; left != 0; ++place) {
      const std::uint32_t pair = 31 - lowest_bit(left);
      const std::uint32_t entry = ((first + word) * kWordUnits * kLanePairs + pair) * kLanes + w.lane;
      left &= left - 1;
      if (place < kWarpQueued) {
        w.state->queue[place] = entry;
      } else {
        touching += decide_queued(v, w, entry);
      }
    }
  }
  if (touching > 0) {
    add_to(&w.state->count, touching);
  }
}

SPHERECHAIN_HD void shift_in(const float (&sums)[kLanePairs], std::uint32_t& apart) {
  SPHERECHAIN_UNROLL
  for (const float sum : sums) {
    apart = shift_in_sign(apart, sum);
  }
}

// For the usual numbers of units, all in registers.
template <std::uint32_t kUnits>
SPHERECHAIN_HD void find_pairs_of(const GroupView& v, const WarpInstance& w) {
  constexpr std::uint32_t kAll = kUnits * (kUnits + 1) / 2, kWords = (kAll + kWordUnits - 1) / kWordUnits;
  const Units units(v, w);
  std::uint32_t found[kWords], apart = 0, unit = 0;
  Units::Rows rows[kUnits];
  SPHERECHAIN_UNROLL
  for (std::uint32_t word = 0; word < kWords; ++word) {
    found[word] = v.wanted[word * kLanes + w.lane];
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
  queue_pairs(v, w, 0, found);
}

SPHERECHAIN_HD void find_pairs_of_any(const GroupView& v, const WarpInstance& w) {
  const Units units(v, w);
  const std::uint32_t words = words_of_units(units_of(v.sphere_count));
  for (std::uint32_t word = 0; word < words; ++word) {
    std::uint32_t apart = 0;
    SPHERECHAIN_UNROLL
    for (std::uint32_t unit = 0; unit < kWordUnits; ++unit) {
      const std::uint32_t place = v.unit_places[word * kWordUnits + unit], column = place >> 16;
      float sums[kLanePairs];
      Units::sum(units.rows(place & 0xFFFFU), units.columns(column, units.rows(column)), sums);
      shift_in(sums, apart);
    }
    std::uint32_t found[] = {~apart & v.wanted[word * kLanes + w.lane]};
    queue_pairs(v, w, word, found);
    rejoin();
  }
}

SPHERECHAIN_HD void find_pairs(const GroupView& v, const WarpInstance& w) {
  switch (units_of(v.sphere_count)) {
    case 4:
      return find_pairs_of<4>(v, w);
    case 5:
      return find_pairs_of<5>(v, w);
    default:
      return find_pairs_of_any(v, w);
  }
}

// Decides about rest pairs and queued pairs.
SPHERECHAIN_HD void decide_pairs(const GroupView& v, const WarpInstance& w) {
  std::uint32_t touching = 0;
  for_all_lanes_of(v.rest_pair_count, w.lane, [&](std::uint32_t i) {
    const RestPairItem& pair = v.rest_pairs[i];
    touching += decide(v, w, pair.a, pair.b, pair.rest_scale);
  });
  const std::uint32_t queued = w.state->queued < kWarpQueued ? w.state->queued : kWarpQueued;
  for_each_of(queued, w.lane, [&](std::uint32_t i) { touching += decide_queued(v, w, w.state->queue[i]); });
  add_to(&w.state->count, touching);
}

// Writes counts and bits, reserves the instance's place in the list, and counts the pairs in each lane's part of it.
SPHERECHAIN_HD void write_instance(const GroupView& v, const WarpInstance& w) {
  if (v.bits != nullptr) {
    std::uint64_t* const to = v.bits + std::size_t{w.instance} * v.bit_words;
    for_each_of(v.bit_words, w.lane,
                [&](std::uint32_t i) { to[i] = w.bits[2 * i] | std::uint64_t{w.bits[2 * i + 1]} << 32; });
  }
  if (v.counts != nullptr) {
    set_alike(v.counts[w.instance], w.state->count);
  }
  if (v.pairs != nullptr) {
    if (w.lane == 0) {
      v.starts[w.instance] = w.state->start = add_to(v.pair_count, std::uint64_t{w.state->count});
    }
    w.parts[w.lane] = count_pairs(w.ordered_bits, 1, part_of(v, w.lane, kLanes));
  }
}

SPHERECHAIN_HD void write_pairs(const GroupView& v, const WarpInstance& w) {
  if (v.pairs == nullptr || w.parts[w.lane] == 0) {
    return;
  }
  std::uint64_t place = w.state->start;
  for (std::uint32_t i = 0; i < w.lane; ++i) {
    place += w.parts[i];
  }
  list_pairs(v, w.ordered_bits, 1, part_of(v, w.lane, kLanes), w.instance, place);
}

}  // namespace spherechain::cuda

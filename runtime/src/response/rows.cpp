// SPDX-License-Identifier: MIT
#include "runtime/src/response/rows.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <utility>

#include "runtime/src/base/pair_bits.h"
#include "runtime/src/base/status.h"
#include "runtime/src/penetrations/rule.h"
#include "runtime/src/simd/simd.h"

namespace spherechain {
namespace {

// Lengths are shares of the character's height.
constexpr double kEase = 0.0015;                       // around what is allowed, the correction sets in gradually
constexpr double kSlop = 0.0006;                       // so much shallower than what is allowed
constexpr double kPatch = 0.024;                       // spots that are farther apart are two patches
constexpr double kBend = 0.035;                        // a skin's radius: it bends away from a row's plane
constexpr double kGapMost = 0.008, kSlideMost = 0.05;  // of a row that is kept
constexpr float kUnseenMost = 0.5F;                    // seconds
constexpr double kLoosen = 0.15;                       // heights a second, by which a row that is not found gives way
constexpr double kAgesBeside = 0.5;                    // how fast a row ages while another one of its parts is found
constexpr double kForget = 0.07;                       // seconds, in which a larger depth is allowed again
constexpr double kMargin = 0.0046;                     // wider gaps are no rows: 8 mm on a human
constexpr double kAnyDepth = 10;                       // where pieces slide in each other as they like

// The spaces of a row's two spots, in a pose of the joints.
struct Spaces {
  Affine part, other;
};

Affine space_of_other(const sc_response& response, const Affine* world, const sc_response_frame& frame,
                      const KeptRow& row) {
  if (row.body == 0) {
    const std::uint32_t joint = response.joint_of_part[row.other];
    return joint == SC_NO_JOINT ? kUnmoved : world[joint];
  }
  if (row.body > frame.other_count) {
    return kUnmoved;  // the ground
  }
  const sc_body& other = *frame.others[row.body - 1];
  const std::int32_t bone = asset_of(other).part(row.other).bone;
  return bone < 0 || other.now.pose.bones == nullptr
             ? kUnmoved
             : affine_of_rows(other.now.bones + 12 * static_cast<std::size_t>(bone));
}

Spaces spaces_of(const sc_response& response, const Affine* world, const sc_response_frame& frame, const KeptRow& row) {
  const std::uint32_t joint = response.joint_of_part[row.part];
  return {joint == SC_NO_JOINT ? kUnmoved : world[joint], space_of_other(response, world, frame, row)};
}

// Puts a kept row into a pose of the joints.
void carry(const Spaces& spaces, double height, Row& row) {
  row.at = move(spaces.part, load(row.kept.at));
  row.at_other = move(spaces.other, load(row.kept.at_other));
  row.normal = turn(spaces.other, load(row.kept.normal));
  if (!normalize(row.normal)) {
    row.normal = {0, 1, 0};
  }
  const Double3 apart = row.at - row.at_other;
  row.gap = dot(row.normal, apart);
  row.slide = length(apart - row.gap * row.normal);
  row.gap += row.slide * row.slide / (2 * kBend * height);
}

// The way back. False where a space has no inverse.
bool keep(const Spaces& spaces, Row& row) {
  Affine part, other;
  if (!invert(spaces.part, part) || !invert(spaces.other, other)) {
    return false;
  }
  Double3 normal = turn(other, row.normal);
  if (!normalize(normal)) {
    return false;
  }
  store(move(part, row.at), row.kept.at);
  store(move(other, row.at_other), row.kept.at_other);
  store(normal, row.kept.normal);
  return true;
}

Row* find_patch(sc_response& response, const Row& like) {
  for (std::size_t i = 0; i < response.row_count; ++i) {
    Row& row = response.rows[i];
    if (row.kept.is_clear == like.kept.is_clear && row.kept.part == like.kept.part &&
        row.kept.other == like.kept.other && row.kept.body == like.kept.body &&
        length(row.at - like.at) < kPatch * response.height) {
      return &row;
    }
  }
  return nullptr;
}

// A new row, or one of parts that do not meet. Null: all rows are of contacts.
Row* free_row(sc_response& response) {
  if (response.row_count < kRowsMost) {
    return &response.rows[response.row_count++];
  }
  Row* const end = response.rows + response.row_count;
  Row* const clear = std::find_if(response.rows, end, [](const Row& row) { return row.kept.is_clear != 0; });
  return clear == end ? nullptr : clear;
}

void take(sc_response& response, const sc_response_frame& frame, const Penetration& found, std::size_t body,
          double seconds) {
  Row row{};
  row.kept.part = static_cast<std::uint16_t>(found.part);
  row.kept.other = static_cast<std::uint16_t>(found.other);
  row.kept.body = static_cast<std::uint16_t>(body);
  row.normal = to_double(found.direction);
  row.at = to_double(found.deepest.position);
  double depth = double{found.distance},
         allowed = std::min(stays_allowed(response.rule, found.measures), kAnyDepth * response.height);
  Row* place = find_patch(response, row);
  if (place != nullptr) {
    Double3 mean = place->normal + row.normal;
    if (dot(place->normal, row.normal) > 0.5 && normalize(mean)) {
      depth *= dot(mean, row.normal);
      row.normal = mean;
    }
    const double before = double{place->kept.allowed};
    allowed = std::min(allowed, before + (allowed - before) * std::min(seconds / kForget, 1.0));
  } else if (place = free_row(response); place != nullptr) {
    *place = row;
  } else {
    return;
  }
  row.gap = -depth;
  row.at_other = row.at + depth * row.normal;
  row.kept.allowed = static_cast<float>(allowed);
  if (keep(spaces_of(response, response.world.data, frame, row.kept), row)) {
    *place = row;
  }
}

void take_all(sc_response& response, const sc_response_frame& frame, const sc_penetrations& found, std::size_t body,
              double seconds) {
  for (std::size_t i = 0; i < found.count; ++i) {
    if (response.turning_of_part[found.items[i].part] != 0 ||
        (body == 0 && response.turning_of_part[found.items[i].other] != 0)) {
      response.fault_depth += double{found.items[i].fault_depth};
      take(response, frame, found.items[i], body, seconds);
    }
  }
}

// Are the two parts of this bit kept apart, of one body or of two?
bool is_asked(const sc_response& response, std::size_t body, std::size_t part, std::size_t bit) {
  return body == 0 ? (response.part_pairs[bit / 64] >> bit % 64 & 1) != 0 : response.turning_of_part[part] != 0;
}

// Adds the gaps of parts that are near each other and have no contact.
Status take_gaps(sc_response& response, const sc_response_frame& frame, std::size_t body) {
  const sc_body &own = *response.body, &other = body == 0 ? own : *frame.others[body - 1];
  const std::size_t parts = response.joint_of_part.size, count = asset_of(other).part_count();
  Span<std::uint64_t>& pairs = response.apart_pairs;
  std::fill(pairs.begin(), pairs.end(), std::uint64_t{0});
  for (std::size_t bit = 0; bit < parts * count; ++bit) {
    pairs[bit / 64] |= std::uint64_t{is_asked(response, body, bit / count, bit)} << bit % 64;
  }
  for (std::size_t i = 0; i < response.row_count; ++i) {
    const KeptRow& row = response.rows[i].kept;
    if (row.body == body) {
      // A pair of one body has its bit where the lesser part comes first.
      const std::size_t part = body == 0 ? std::min(row.part, row.other) : row.part,
                        met = body == 0 ? std::max(row.part, row.other) : row.other, bit = part * count + met;
      pairs[bit / 64] &= ~(std::uint64_t{1} << bit % 64);
    }
  }
  Gap gaps[kGapsMost];
  GapJob job;
  job.a = side_of(own, nullptr);
  job.b = side_of(other, nullptr);
  job.are_one = body == 0;
  job.part_pairs = pairs.data;
  job.margin = kMargin * response.height;
  job.patch = kPatch * response.height;
  job.gaps = {gaps, kGapsMost};
  job.scratch = own.scratch;
  if (gap_scratch_words(asset_of(own), asset_of(other)) > own.scratch_words) {
    return refuse(SC_TOO_SMALL, SC_FIELD_BODIES);
  }
  if (!resolve_target(frame.target, job.target)) {
    return refuse(SC_UNSUPPORTED_TARGET, SC_FIELD_TARGET);
  }
  job.run();
  for (std::size_t i = 0; i < job.count && response.row_count < kRowsMost; ++i) {
    Row row{};
    // As in a penetration, the more mobile part comes first.
    const auto mobility = [&](std::uint32_t part) { return asset_of(own).part(part).mobility; };
    if (body == 0 && mobility(gaps[i].other) > mobility(gaps[i].part)) {
      std::swap(gaps[i].part, gaps[i].other);
      std::swap(gaps[i].at, gaps[i].at_other);
    }
    row.kept.part = static_cast<std::uint16_t>(gaps[i].part);
    row.kept.other = static_cast<std::uint16_t>(gaps[i].other);
    row.kept.body = static_cast<std::uint16_t>(body);
    row.kept.is_clear = 1;
    row.at = gaps[i].at;
    row.at_other = gaps[i].at_other;
    row.gap = gaps[i].distance;
    row.normal = (1 / row.gap) * (row.at - row.at_other);
    if (keep(spaces_of(response, response.world.data, frame, row.kept), row)) {
      response.rows[response.row_count++] = row;
    }
  }
  return done();
}

// The last rows as the detector takes them: it measures along their normals where that is no detour.
std::size_t list_previous(sc_response& response, std::size_t body) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < response.row_count; ++i) {
    const Row& row = response.rows[i];
    if (row.kept.body == body && row.kept.is_clear == 0) {
      sc_penetration& last = response.previous[count++];
      last = {};
      last.part = row.kept.part;
      last.other = row.kept.other;
      last.direction = to_float(row.normal);
      last.kind = SC_CLASS_PENETRATION;
    }
  }
  return count;
}

// Is another spot of the same two parts found in this round?
bool is_pair_found(const sc_response& response, const Row& of) {
  return std::any_of(response.rows, response.rows + response.row_count, [&](const Row& row) {
    return row.kept.part == of.kept.part && row.kept.other == of.kept.other && row.kept.body == of.kept.body &&
           row.kept.is_clear == 0 && !(row.kept.unseen > 0) && dot(row.normal, of.normal) > 0;
  });
}

// Drops what is out of reach. A row that was not found does not intersect, whatever its plane says.
void drop_rows(sc_response& response, const sc_response_frame& frame, double seconds) {
  std::uint32_t left = 0;
  for (std::size_t i = 0; i < response.row_count; ++i) {
    Row row = response.rows[i];
    if (row.kept.unseen > 0 && is_pair_found(response, row)) {
      // A pair has one spot that is found, now here, now there: the other one gives way more slowly.
      row.kept.unseen = std::max(row.kept.unseen - static_cast<float>((1 - kAgesBeside) * seconds), FLT_MIN);
    } else if ((row.kept.unseen > 0 || row.kept.is_clear != 0) && row.gap < 0) {
      row.at_other = row.at_other + row.gap * row.normal;
      row.gap = 0;
      if (!keep(spaces_of(response, response.world.data, frame, row.kept), row)) {
        continue;
      }
    }
    if (row.kept.unseen < kUnseenMost && row.gap < kGapMost * response.height &&
        row.slide < kSlideMost * response.height) {
      response.rows[left++] = row;
    }
  }
  response.row_count = left;
}

// The number of parts of a row's other body; 0: there is no such body.
std::size_t parts_of_other(const sc_response& response, const sc_response_frame& frame, std::size_t body) {
  if (body == 0) {
    return response.joint_of_part.size;
  }
  return body <= frame.other_count ? asset_of(*frame.others[body - 1]).part_count() : 0;
}

// Can a row of a state be carried on? The bodies may have changed, and a caller may put any bits into a state.
bool is_sound(const sc_response& response, const sc_response_frame& frame, const KeptRow& row) {
  const bool is_of_ground = frame.ground != nullptr && row.body == frame.other_count + 1;
  return row.part < response.joint_of_part.size &&
         (is_of_ground || row.other < parts_of_other(response, frame, row.body)) && is_finite(row.at) &&
         is_finite(row.at_other) && is_finite(row.normal) && std::isfinite(row.allowed) && row.unseen >= 0 &&
         row.unseen <= kUnseenMost;
}

}  // namespace

void carry_rows(sc_response& response, const State& state, const sc_response_frame& frame, double seconds) {
  response.row_count = 0;
  for (std::size_t i = 0; i < std::min<std::size_t>(state.row_count, kRowsMost); ++i) {
    Row& row = response.rows[response.row_count];
    row = Row{};
    row.kept = state.rows[i];
    if (is_sound(response, frame, row.kept)) {
      row.kept.unseen += static_cast<float>(seconds);
      carry(spaces_of(response, response.world.data, frame, row.kept), response.height, row);
      ++response.row_count;
    }
  }
}

Status find_rows(sc_response& response, const sc_response_frame& frame, double seconds) {
  for (std::size_t i = 0; i < response.row_count; ++i) {
    carry(spaces_of(response, response.world.data, frame, response.rows[i].kept), response.height, response.rows[i]);
  }
  response.fault_depth = 0;
  sc_query query{};
  query.rule = &response.rule;
  query.classes = ((1U << (SC_CLASS_INSIDE + 1)) - 1) & ~(1U << SC_CLASS_REST);
  query.target = frame.target;
  query.previous = response.previous;
  query.ignored_parts = response.resting_parts.data;
  const std::size_t bodies = 1 + frame.other_count + (frame.ground != nullptr ? 1 : 0);
  for (std::size_t body = 0; body < bodies; ++body) {
    sc_penetrations found{};
    query.part_pairs = body == 0 ? response.part_pairs.data : nullptr;
    query.previous_count = list_previous(response, body);
    const Status status = body <= frame.other_count
                              ? find_along(*response.body, body == 0 ? nullptr : frame.others[body - 1], query, found)
                              : sc_find_in_ground(response.body, frame.ground, &query, &found);
    if (status != SC_OK) {
      return status;
    }
    take_all(response, frame, found, body, seconds);
  }
  drop_rows(response, frame, seconds);
  return done();
}

void forget_gaps(sc_response& response) {
  Row* const end = std::remove_if(response.rows, response.rows + response.row_count,
                                  [](const Row& row) { return row.kept.is_clear != 0; });
  response.row_count = static_cast<std::uint32_t>(end - response.rows);
}

Status find_gaps(sc_response& response, const sc_response_frame& frame) {
  for (std::size_t body = 0; body <= frame.other_count; ++body) {
    const Status status = take_gaps(response, frame, body);
    if (status != SC_OK) {
      return status;
    }
  }
  return done();
}

void set_wanted(sc_response& response, const sc_response_frame& frame) {
  const double ease = kEase * response.height;
  for (std::size_t i = 0; i < response.row_count; ++i) {
    Row& row = response.rows[i];
    Row animated = row;
    carry(spaces_of(response, response.animated.data, frame, row.kept), response.height, animated);
    // A parabola leads from nothing, where the animation is clear by `ease`, to all that it lacks.
    if (row.kept.is_clear != 0) {
      row.wanted = std::min(animated.gap, kSlop * response.height);  // no correction may push the two into each other
      continue;
    }
    const double loose = kLoosen * double{row.kept.unseen},
                 least = (kSlop - loose) * response.height - double{row.kept.allowed}, lacks = least - animated.gap,
                 eased = lacks <= -ease  ? 0
                         : lacks >= ease ? lacks
                                         : (lacks + ease) * (lacks + ease) / (4 * ease);
    row.wanted = std::min(animated.gap + eased, least + ease);
  }
}

double most_lacking(const sc_response& response) {
  double most = 0;
  for (std::size_t i = 0; i < response.row_count; ++i) {
    const Row& row = response.rows[i];
    most = row.kept.is_clear != 0 ? most : std::max(most, row.wanted - row.gap);
  }
  return most;
}

void keep_rows(const sc_response& response, State& state) {
  state.row_count = response.row_count;
  for (std::size_t i = 0; i < response.row_count; ++i) {
    state.rows[i] = response.rows[i].kept;
  }
}

}  // namespace spherechain

// SPDX-License-Identifier: MIT
#include "runtime/src/step/step_collector.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "runtime/src/base/arithmetic.h"
#include "runtime/src/base/pair_bits.h"

namespace spherechain {
namespace {

constexpr double kNever = 2, kNoLast = -1;
constexpr double kShortest = 1.0 / 65536;  // share of the step between two looks
constexpr double kStrayStepsMax =
    1 << 10;  // the way is halved at most six times: each takes three quarters of the stray

SixCorners corners_of(const TriangleCorners& a, const TriangleCorners& b) {
  SixCorners out;
  for (std::size_t k = 0; k < 3; ++k) {
    out.p[k] = to_double(a.p[k]);
    out.p[3 + k] = to_double(b.p[k]);
  }
  return out;
}

// How finely floats tell where the corners are.
double resolution_of(const SixCorners& corners) {
  double most = 0;
  for (const Double3& p : corners.p) {
    most = std::max({most, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  }
  return 0x1p-23 * most;
}

Vec3 middle_of(const Vec3& p, const Vec3& q) { return to_float(0.5 * (to_double(p) + to_double(q))); }

}  // namespace

std::uint16_t StepBody::part_of(std::size_t cluster_index) {
  std::uint16_t& part = parts[cluster_index];
  if (part == kUnknown) {
    const Cluster& cluster = skin.surface->clusters[cluster_index];
    const std::uint8_t* const of = skin.surface->parts.data + cluster.first_triangle;
    part = of[0];
    for (std::size_t i = 1; i < cluster.triangle_count; ++i) {
      part = of[i] == of[0] ? part : kSeveral;
    }
  }
  return part;
}

const StepEntry* StepCollector::known(std::uint32_t part_a, std::uint32_t part_b) const {
  const std::size_t place = table_.place(part_a, part_b, are_one_);
  return (table_.seen[place / 64] >> place % 64 & 1) == 0 ? nullptr : &table_.contacts[place];
}

// Null, too, where a cluster is of several parts.
const StepEntry* StepCollector::known_of_clusters(std::size_t cluster_a, std::size_t cluster_b) {
  const std::uint16_t a = a_.part_of(cluster_a), b = b_.part_of(cluster_b);
  if (a == StepBody::kSeveral || b == StepBody::kSeveral) {
    return nullptr;
  }
  return are_one_ && b < a ? known(b, a) : known(a, b);
}

bool StepCollector::is_settled(std::size_t cluster_a, std::size_t cluster_b) {
  const StepEntry* const of = known_of_clusters(cluster_a, cluster_b);
  return of != nullptr && of->first <= begin_ && of->last >= end_;
}

bool StepCollector::touch_at_end(const Pair& clusters, bool at_start) {
  const StepEntry* const of = known_of_clusters(clusters.a, clusters.b);
  return of != nullptr && (at_start ? of->contact.at_start : of->contact.at_end) != 0;
}

StepEntry& StepCollector::entry(std::uint32_t part_a, std::uint32_t part_b) {
  bool is_new = false;
  StepEntry& out = table_.at(part_a, part_b, are_one_, is_new);
  if (is_new) {
    out = {};
    out.contact.part_a = part_a;
    out.contact.part_b = part_b;
    out.contact.triangle_a = out.contact.triangle_b = SC_NO_TRIANGLE;
    out.first = kNever;
    out.last = kNoLast;
  }
  return out;
}

void StepCollector::note_end(const PartContact& contact, bool at_start) {
  StepEntry& of = entry(contact.part_a, contact.part_b);
  if (at_start) {
    of.contact.at_start = 1;
    of.first = 0;
    of.last = std::max(of.last, 0.0);
  } else {
    of.contact.at_end = 1;
    of.last = 1;
  }
}

SixCorners StepCollector::corners_at(const MovingCandidate& candidate, double time) {
  SixCorners out;
  a_.motion->corners_at(time, candidate.cluster_a, candidate.triangle_a, out.p);
  b_.motion->corners_at(time, candidate.cluster_b, candidate.triangle_b, out.p + 3);
  return out;
}

// The first time, on the way from one time to another, which may be the earlier, at which the two touch, up to `until`;
// kNever: none. `then` is where the corners are at that time.
double StepCollector::search(const MovingCandidate& candidate, const CornerPaths& way, double from, double to,
                             double until, SixCorners& then) {
  const double limit = std::min((until - from) / (to - from), 1.0);
  const Approach found = approach(way, limit);
  if (found.outcome == Outcome::kApart) {
    return kNever;
  }
  if (found.outcome == Outcome::kTouch) {
    then = way.at(found.time);
    return from + found.time * (to - from);
  }
  const double middle = 0.5 * (from + to);
  const SixCorners corners = corners_at(candidate, middle);
  if (found.time < 0.5) {
    const double first = search(candidate, {way.from, corners, way.stray / 4, way.step, 2 * way.shortest}, from, middle,
                                limit < 0.5 ? until : middle, then);
    if (first != kNever || limit <= 0.5) {
      return first;
    }
  }
  return search(candidate, {corners, way.to, way.stray / 4, way.step, 2 * way.shortest}, middle, to, until, then);
}

void StepCollector::decide(const MovingCandidate& candidate) {
  std::uint32_t part_a = a_.skin.surface->parts[candidate.triangle_a],
                part_b = b_.skin.surface->parts[candidate.triangle_b];
  std::uint32_t triangle_a = a_.skin.surface->triangles[candidate.triangle_a],
                triangle_b = b_.skin.surface->triangles[candidate.triangle_b];
  const bool is_swapped = are_one_ && part_b < part_a;
  if (is_swapped) {
    std::swap(part_a, part_b);
    std::swap(triangle_a, triangle_b);
  }
  const StepEntry* const so_far = known(part_a, part_b);
  const double first = so_far == nullptr ? kNever : so_far->first, last = so_far == nullptr ? kNoLast : so_far->last;
  const bool may_begin = first > begin_, may_end = last < end_;
  if (!may_begin && !may_end) {
    return;
  }
  if (are_one_) {
    if (share_a_position(*a_.skin.surface, {candidate.cluster_a, candidate.triangle_a},
                         {candidate.cluster_b, candidate.triangle_b}) ||
        intersect_at_rest(*a_.skin.surface, {std::min(triangle_a, triangle_b), std::max(triangle_a, triangle_b)})) {
      return;
    }
  } else if (a_.skin.ignores(candidate.triangle_a) || b_.skin.ignores(candidate.triangle_b)) {
    return;
  }
  const double share = end_ - begin_;
  const double stray = share * share *
                       (double{a_.motion->strays()[a_.skin.surface->clusters[candidate.cluster_a].sphere]} +
                        double{b_.motion->strays()[b_.skin.surface->clusters[candidate.cluster_b].sphere]});
  const SixCorners from = corners_of(candidate.a[0], candidate.b[0]), to = corners_of(candidate.a[1], candidate.b[1]);
  const double step = std::max({tolerance_ / 2, stray / kStrayStepsMax, resolution_of(from), resolution_of(to)});
  const CornerPaths way{from, to, stray, step, kShortest / share};
  double begins = kNever;
  SixCorners then;
  if (may_begin) {
    begins = search(candidate, way, begin_, end_, std::min(first, end_), then);
    if (begins == kNever && first > end_) {
      return;  // nor does it end
    }
  }
  if (begins != kNever) {
    StepEntry& of = entry(part_a, part_b);
    if (begins < of.first ||
        (begins == of.first && Pair{triangle_a, triangle_b} < Pair{of.contact.triangle_a, of.contact.triangle_b})) {
      of.first = begins;
      of.contact.triangle_a = triangle_a;
      of.contact.triangle_b = triangle_b;
      const Segment segment = crossing_segment(then.triangle(0), then.triangle(3));
      of.contact.at = middle_of(segment.from, segment.to);
    }
  }
  if (may_end) {
    const double ends = search(candidate, {way.to, way.from, stray, way.step, way.shortest}, end_, begin_,
                               std::max(last, begin_), then);
    // If two triangles graze each other, the search forward may find a contact that the search backward misses, or the
    // reverse. The search forward counts, so no time depends on the order in which triangles are looked at.
    if (ends != kNever && ends > last &&
        (begins != kNever || search(candidate, way, begin_, end_, end_, then) != kNever)) {
      entry(part_a, part_b).last = ends;
    }
  }
}

std::size_t StepCollector::list(Span<StepContact> out) const {
  std::size_t count = 0;
  for (std::size_t w = 0; w < table_.word_count; ++w) {
    for (std::uint64_t word = table_.seen[w]; word != 0; word &= word - 1, ++count) {
      if (count < out.size) {
        const StepEntry& of = table_.contacts[64 * w + lowest_bit(word)];
        out[count] = of.contact;
        // A pair in contact at the end, and not seen earlier, is in contact from that time on.
        out[count].begin = static_cast<float>(std::min(of.first, 1.0));
        out[count].end = static_cast<float>(std::max(of.last, std::min(of.first, 1.0)));
      }
    }
  }
  return count;
}

}  // namespace spherechain

// SPDX-License-Identifier: MIT
// Does a way end inside the other part, where no triangles meet either?
#include <algorithm>

#include "runtime/src/depth/sweep.h"

namespace spherechain {
namespace {

constexpr std::size_t kVotes = 8;  // contacts that say what is inside

}  // namespace

void Sweep::vote_by(const Corners& triangle, const Double3* points, std::size_t count, bool up, double handedness,
                    double* nearest, int* inside) const {
  const Corners t = view_.seen(triangle);
  const double turn = turn_of(t), sign = turn > 0 ? 1 : -1;
  for (std::size_t i = 0; i < count && (turn > 0 || turn < 0); ++i) {
    const Double3& from = points[i];
    bool is_over = true;
    for (int k = 0; k < 3 && is_over; ++k) {
      const Double3 &p = t.p[k], &q = t.p[(k + 1) % 3];
      is_over = sign * ((q.x - p.x) * (from.y - p.y) - (q.y - p.y) * (from.x - p.x)) >= 0;
    }
    const double rise = is_over ? Slope(t).at(from.x, from.y) - from.z : 0, distance = up ? rise : -rise;
    if (distance > 0 && distance < nearest[i]) {
      nearest[i] = distance;
      inside[i] = (up ? sign : -sign) * handedness > 0 ? 1 : 0;
    }
  }
}

// For each point: is the next surface of that side above it, or below it, one that is left, not entered?
void Sweep::vote(const Side& side, const Double3* points, std::size_t count, bool up, double outwards,
                 int* inside) const {
  const PosedSkin& skin = side.skin;
  double nearest[kVotes];
  std::fill(nearest, nearest + kVotes, HUGE_VAL);
  for (const TriangleRun& run : side.runs) {
    // The run's box, seen: its middle and how far it reaches along u and v.
    Double3 low{}, high{};
    low = {double{skin.low[0][run.cluster]}, double{skin.low[1][run.cluster]}, double{skin.low[2][run.cluster]}};
    high = {double{skin.high[0][run.cluster]}, double{skin.high[1][run.cluster]}, double{skin.high[2][run.cluster]}};
    const Double3 middle = view_.seen(0.5 * (low + high)), half = 0.5 * (high - low);
    const auto reach = [&](const Double3& axis) {
      return std::abs(axis.x) * half.x + (std::abs(axis.y) * half.y + std::abs(axis.z) * half.z);
    };
    const double reach_u = reach(view_.u), reach_v = reach(view_.v);
    const bool is_over_any = std::any_of(points, points + count, [&](const Double3& p) {
      return std::abs(p.x - middle.x) <= reach_u && std::abs(p.y - middle.y) <= reach_v;
    });
    for (std::uint32_t k = 0; is_over_any && k < run.count; ++k) {
      vote_by(skin.corners(run.first + k), points, count, up, outwards * skin.handedness, nearest, inside);
    }
  }
}

bool Sweep::is_enclosed(const Double3& direction, const WayOut& way, const Contour& contour, double outwards) {
  look_along(direction);
  const auto middle = [&](const Corners& corners) {
    const Corners t = view_.seen(corners);
    return (1.0 / 3) * (t.p[0] + (t.p[1] + t.p[2]));
  };
  const std::size_t step = (contour.segments.size + kVotes - 1) / kVotes;
  Double3 of_a[kVotes] = {}, of_b[kVotes] = {};
  int a_in_b[kVotes] = {}, b_in_a[kVotes] = {};
  std::size_t count = 0;
  for (std::size_t i = 0; i < contour.segments.size; i += step, ++count) {
    of_a[count] = middle(skins_.a.corners(contour.segments[i].a));
    of_b[count] = middle(skins_.b.corners(contour.segments[i].b));
    of_a[count].z -= way.depth;
    of_b[count].z += way.depth;
  }
  vote(side_a(), of_b, count, true, outwards, b_in_a);
  vote(side_b(), of_a, count, false, outwards, a_in_b);
  const auto most = [&](const int* votes) {
    return 2 * std::count_if(votes, votes + count, [](int vote) { return vote == 1; }) > static_cast<long>(count);
  };
  return most(b_in_a) || most(a_in_b);
}

}  // namespace spherechain

// SPDX-License-Identifier: GPL-3.0-or-later
#include "brute_force.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "baker/mesh/even_directions.h"

namespace spherechain::quality {
namespace {

constexpr double kNever = std::numeric_limits<double>::max();

struct Seen {
  Vec3 p[3];  // along two axes and the direction
  Vec3 low, high;
};

std::vector<Seen> see(const std::vector<Corners>& triangles, const Vec3& direction) {
  const Vec3 u = direction.unitOrthogonal(), v = direction.cross(u);
  std::vector<Seen> out;
  for (const Corners& t : triangles) {
    Seen seen;
    for (int k = 0; k < 3; ++k) seen.p[k] = {t.p[k].dot(u), t.p[k].dot(v), t.p[k].dot(direction)};
    seen.low = seen.p[0].cwiseMin(seen.p[1]).cwiseMin(seen.p[2]);
    seen.high = seen.p[0].cwiseMax(seen.p[1]).cwiseMax(seen.p[2]);
    out.push_back(seen);
  }
  return out;
}

double cross2(const Vec3& o, const Vec3& p, const Vec3& q) {
  return (p.x() - o.x()) * (q.y() - o.y()) - (p.y() - o.y()) * (q.x() - o.x());
}

// z of the triangle over a point in it; false where the point is beside it.
bool height(const Seen& t, const Vec3& at, double& z) {
  const double area = cross2(t.p[0], t.p[1], t.p[2]);
  const double w0 = cross2(t.p[1], t.p[2], at) / area, w1 = cross2(t.p[2], t.p[0], at) / area, w2 = 1 - w0 - w1;
  if (!(w0 >= 0 && w1 >= 0 && w2 >= 0)) return false;
  z = w0 * t.p[0].z() + w1 * t.p[1].z() + w2 * t.p[2].z();
  return true;
}

struct Interval {
  double low = kNever, high = -kNever;
  void add(double x) {
    low = std::min(low, x);
    high = std::max(high, x);
  }
};

Interval blocked(const Seen& a, const Seen& b) {
  Interval out;
  double z = 0;
  for (int i = 0; i < 3; ++i) {
    if (height(a, b.p[i], z)) out.add(z - b.p[i].z());
    if (height(b, a.p[i], z)) out.add(a.p[i].z() - z);
    for (int j = 0; j < 3; ++j) {
      const Vec3 &p = a.p[i], &q = a.p[(i + 1) % 3], &r = b.p[j], &s = b.p[(j + 1) % 3];
      const double at_p = cross2(r, s, p), at_q = cross2(r, s, q), at_r = cross2(p, q, r), at_s = cross2(p, q, s);
      if ((at_p > 0) == (at_q > 0) || (at_r > 0) == (at_s > 0)) continue;
      const double t = at_p / (at_p - at_q), w = at_r / (at_r - at_s);
      out.add(p.z() + t * (q.z() - p.z()) - (r.z() + w * (s.z() - r.z())));
    }
  }
  return out;
}

// Solid angle of the triangles, in turns: 1 inside a closed body.
double winding(const std::vector<Corners>& triangles, const Vec3& at) {
  double sum = 0;
  for (const Corners& t : triangles) {
    const Vec3 a = t.p[0] - at, b = t.p[1] - at, c = t.p[2] - at;
    const double x = a.norm(), y = b.norm(), z = c.norm();
    sum += std::atan2(a.dot(b.cross(c)), x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y);
  }
  return sum / (2 * std::numbers::pi);
}

bool is_enclosed(const Parts& parts, const Vec3& move) {
  const auto inside = [](const std::vector<Corners>& body, const std::vector<Corners>& points, const Vec3& by) {
    const std::size_t step = std::max<std::size_t>(1, points.size() / 12);
    std::size_t count = 0, in = 0;
    for (std::size_t i = 0; i < points.size(); i += step, ++count) {
      if (winding(body, (points[i].p[0] + points[i].p[1] + points[i].p[2]) / 3 + by) > 0.5) ++in;
    }
    return 2 * in > count;
  };
  return inside(parts.a, parts.b, move) || inside(parts.b, parts.a, -move);
}

// The first free place, or `bound`.
double free_after(const Parts& parts, const Vec3& direction, double gap, double bound) {
  const std::vector<Seen> a = see(parts.a, direction), b = see(parts.b, direction);
  double top = -kNever;
  for (const Seen& t : a) top = std::max(top, t.high.z());
  std::vector<Interval> intervals;
  for (std::size_t j = 0; j < b.size(); ++j) {
    const Seen& t = b[j];
    if (top < t.low.z()) continue;
    for (std::size_t i = 0; i < a.size(); ++i) {
      const Seen& s = a[i];
      if (s.low.x() > t.high.x() || t.low.x() > s.high.x() || s.low.y() > t.high.y() || t.low.y() > s.high.y() ||
          s.high.z() < t.low.z() || s.low.z() - t.high.z() > bound) {
        continue;
      }
      const Interval interval = blocked(s, t);
      if (interval.high >= 0 && interval.low < bound && parts.counts(i, j)) intervals.push_back(interval);
    }
  }
  std::sort(intervals.begin(), intervals.end(), [](const Interval& l, const Interval& r) { return l.low < r.low; });
  double depth = 0;
  for (const Interval& interval : intervals) {
    if (interval.low > depth + gap) break;
    depth = std::max(depth, interval.high);
  }
  return std::min(depth, bound);
}

}  // namespace

Exit shortest_way(const Parts& parts, int directions, double gap) {
  Exit best{kNever, Vec3::UnitZ()};
  std::vector<Exit> ways;
  const auto attempt = [&](const Vec3& direction, double bound) {
    const double depth = free_after(parts, direction, gap, bound);
    if (depth >= bound || is_enclosed(parts, depth * direction)) return kNever;
    ways.push_back({depth, direction});
    if (depth < best.depth) best = ways.back();
    return depth;
  };
  for (const Vec3& direction : baker::even_directions(directions))
    attempt(direction, best.depth < kNever ? 1.6 * best.depth : 1e9);
  std::sort(ways.begin(), ways.end(), [](const Exit& l, const Exit& r) { return l.depth < r.depth; });
  ways.resize(std::min<std::size_t>(ways.size(), 3));
  const std::vector<Exit> starts = ways;
  for (Exit way : starts) {
    for (double angle = 0.35; angle > 0.01; angle *= 0.6) {
      const Vec3 u = way.direction.unitOrthogonal(), v = way.direction.cross(u), center = way.direction;
      for (int k = 0; k < 6; ++k) {
        const double turn = k * std::numbers::pi / 3;
        const Vec3 direction = (center + std::tan(angle) * (std::cos(turn) * u + std::sin(turn) * v)).normalized();
        const double depth = attempt(direction, way.depth);
        if (depth < way.depth) way = {depth, direction};
      }
    }
  }
  return best;
}

}  // namespace spherechain::quality

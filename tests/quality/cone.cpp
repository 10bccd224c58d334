// SPDX-License-Identifier: GPL-3.0-or-later
#include "cone.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace spherechain::quality {
namespace {

using Eigen::Vector3d;

// A ball of each cone: shares of the way.
struct Place {
  double s, t;
};

double distance(const Cone& a, const Cone& b, const Place& at) {
  return (a.from + at.s * (a.to - a.from) - b.from - at.t * (b.to - b.from)).norm();
}
double radii(const Cone& a, const Cone& b, const Place& at) {
  return a.from_radius + at.s * (a.to_radius - a.from_radius) + b.from_radius + at.t * (b.to_radius - b.from_radius);
}

// Where |w + t v| - growth * t is least for t from 0 to 1.
double least_along(const Vector3d& w, const Vector3d& v, double growth) {
  const double length = v.squaredNorm();
  if (growth * growth >= length) return growth > 0 ? 1 : 0;
  const double along = w.dot(v), height = (w - along / length * v).norm();
  const double x = growth * height / std::sqrt(1 - growth * growth / length);
  return std::clamp((x - along) / length, 0.0, 1.0);
}

// The gap is convex in both places. Where it has no stationary place inside, it is least on an edge.
Place least_place(const Cone& a, const Cone& b, double scale) {
  const Vector3d u = a.to - a.from, v = b.from - b.to, w = a.from - b.from;
  const double p = scale * (a.to_radius - a.from_radius), q = scale * (b.to_radius - b.from_radius);
  std::array<Place, 5> places{{{0, least_along(w, v, q)},
                               {1, least_along(w + u, v, q)},
                               {least_along(w, u, p), 0},
                               {least_along(w + v, u, p), 1},
                               {0, 0}}};
  const double uu = u.dot(u), uv = u.dot(v), vv = v.dot(v), det = uu * vv - uv * uv;
  if (det > 1e-12 * uu * vv) {
    const double alpha = (vv * p - uv * q) / det, beta = (uu * q - uv * p) / det, planar = alpha * p + beta * q;
    const Vector3d e = u.cross(v) / std::sqrt(det);
    if (planar < 1) {
      const double d = std::abs(w.dot(e)) / std::sqrt(1 - planar), x = d * p - w.dot(u), y = d * q - w.dot(v);
      const double s = (vv * x - uv * y) / det, t = (uu * y - uv * x) / det;
      if (s >= 0 && s <= 1 && t >= 0 && t <= 1) places[4] = {s, t};
    }
  }
  const auto gap = [&](const Place& at) { return distance(a, b, at) - scale * radii(a, b, at); };
  return *std::min_element(places.begin(), places.end(),
                           [&](const Place& l, const Place& r) { return gap(l) < gap(r); });
}

}  // namespace

double least_gap(const Cone& a, const Cone& b, double scale) {
  const Place at = least_place(a, b, scale);
  return distance(a, b, at) - scale * radii(a, b, at);
}

double touching_scale(const Cone& a, const Cone& b) {
  double scale = distance(a, b, {0, 0}) / radii(a, b, {0, 0});
  for (int i = 0; i < 30; ++i) {
    const Place at = least_place(a, b, scale);
    const double next = distance(a, b, at) / radii(a, b, at);
    if (!(next < scale * (1 - 1e-9))) break;
    scale = next;
  }
  return scale;
}

}  // namespace spherechain::quality

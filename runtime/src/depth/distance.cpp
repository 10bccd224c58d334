// SPDX-License-Identifier: MIT
#include "runtime/src/depth/distance.h"

#include <algorithm>

namespace spherechain {
namespace {

double clamp01(double x) { return x > 0 ? (x < 1 ? x : 1) : 0; }

// From the point to the triangle's inside; infinite where it is not above it.
Nearest above(const Double3& p, const Corners& t) {
  const Double3 normal = normal_of(t);
  for (int i = 0; i < 3; ++i) {
    if (dot(cross(normal, t.p[(i + 1) % 3] - t.p[i]), p - t.p[i]) < 0) {
      return {HUGE_VAL, p, p};
    }
  }
  const double size = length(normal), along = dot(normal, p - t.p[0]);
  return size > 0 ? Nearest{std::abs(along) / size, p, p - (along / (size * size)) * normal} : Nearest{HUGE_VAL, p, p};
}

// Takes the closest points of two segments by alternating projection from the lines' own (Ericson, Real-Time Collision
// Detection, 5.1.9).
Nearest between(const Double3& p, const Double3& p_end, const Double3& q, const Double3& q_end) {
  const Double3 d = p_end - p, e = q_end - q, r = p - q;
  const double a = dot(d, d), c = dot(e, e), b = dot(d, e), f = dot(e, r), g = dot(d, r);
  const double denominator = a * c - b * b;
  double s = denominator > 0 ? clamp01((b * f - g * c) / denominator) : 0;
  const double t = c > 0 ? clamp01((b * s + f) / c) : 0;
  s = a > 0 ? clamp01((b * t - g) / a) : 0;
  const Double3 on_p = p + s * d, on_q = q + t * e;
  return {length(on_p - on_q), on_p, on_q};
}

}  // namespace

Nearest nearest_of(const Corners& a, const Corners& b) {
  Nearest least{HUGE_VAL, {}, {}};
  const auto offer = [&](const Nearest& found) { least = found.distance < least.distance ? found : least; };
  for (int i = 0; i < 3; ++i) {
    offer(above(a.p[i], b));
    const Nearest from_b = above(b.p[i], a);
    offer({from_b.distance, from_b.b, from_b.a});
    for (int j = 0; j < 3; ++j) {
      offer(between(a.p[i], a.p[(i + 1) % 3], b.p[j], b.p[(j + 1) % 3]));
    }
  }
  return least;
}

}  // namespace spherechain

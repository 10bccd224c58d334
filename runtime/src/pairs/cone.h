// SPDX-License-Identifier: MIT
// The cone of two spheres, and whether two cones touch: docs/arithmetic.md, "Which cones touch". The kernels do the
// same a register at a time (cone_registers.h).
//
// Why two balls decide. With A(s) and B(t) the balls of the two cones, the gap |A(s) - B(t)| - k (rA(s) + rB(t)) is
// convex in s and t. Where its gradient is 0 at (s*, t*) inside the unit square, B touches A first with the ball A(s*).
// Where (s*, t*) is outside, the way there from the least place of the square only goes down, so it leaves the square
// at once: that place is on a side that faces (s*, t*), and these are s = clamp(s*) and t = clamp(t*). Where there is
// no such place, the same holds of a direction in which the gap falls for ever. So the least gap is that of the ball
// A(clamp(s*)) to all of B, or of B(clamp(t*)) to all of A, and for a ball there is a closed form.
//
// Axes within 2^-10 of parallel count as parallel: that moves the least gap by up to 2^-21 |u|^2 / distance.
#pragma once

#include <cmath>

#include "spherechain/types.h"

namespace spherechain {

inline constexpr std::size_t kMaxCones = 256;
inline constexpr float kConeExtent = 0x1p30F;       // what a coordinate or radius may be
inline constexpr float kShortestAxis = 0x1p-100F;   // squared; a shorter one is none
inline constexpr float kNearlyParallel = 0x1p-20F;  // squared sine
inline constexpr float kLargestScale = 4;           // of the radii
inline constexpr float kRestShare = 0.9F;           // of the scale with which two cones start to touch at rest

// A ball, and what it gains on the way to the other end.
struct Cone {
  float x, y, z, radius;
  float ux, uy, uz, growth;  // all 0: a ball alone
  float length;              // |u|^2
};

inline bool is_cone_end(const Sphere& s) {
  return std::abs(s.x) <= kConeExtent && std::abs(s.y) <= kConeExtent && std::abs(s.z) <= kConeExtent &&
         s.radius >= 0 && s.radius <= kConeExtent;
}

// Of two ends. One ball inside the other: the larger one.
inline Cone cone_of(const Sphere& a, const Sphere& b) {
  Cone out{a.x, a.y, a.z, a.radius, b.x - a.x, b.y - a.y, b.z - a.z, b.radius - a.radius, 0};
  out.length = (out.ux * out.ux + out.uy * out.uy) + out.uz * out.uz;
  if (out.growth * out.growth < out.length && out.length >= kShortestAxis) {
    return out;
  }
  const Sphere& larger = out.growth > 0 ? b : a;
  return {larger.x, larger.y, larger.z, larger.radius, 0, 0, 0, 0, 0};
}

// 0 for what is no number.
inline float unit_clamp(float value) {
  const float positive = value > 0 ? value : 0;
  return positive < 1 ? positive : 1;
}

// Where |d - t v| - growth t is least, t from 0 to 1; along = d.v, d2 = |d|^2.
inline float nearest_share(float along, float d2, float length, float growth) {
  const float spread = length - growth * growth;
  const float apart = d2 * length - along * along;
  const float share = (along + growth * std::sqrt((apart > 0 ? apart : 0) / spread)) / length;
  return unit_clamp(spread > 0 ? share : growth > 0 ? 1.0F : 0.0F);
}

struct ConeShares {
  float s, t;
};

// (clamp(s*), clamp(t*)) of above.
inline ConeShares facing_shares(const Cone& a, const Cone& b, float wx, float wy, float wz, float p, float q) {
  const float uv = (a.ux * b.ux + a.uy * b.uy) + a.uz * b.uz;
  const float wu = (wx * a.ux + wy * a.uy) + wz * a.uz, wv = (wx * b.ux + wy * b.uy) + wz * b.uz;
  const float cx = a.uy * b.uz - a.uz * b.uy, cy = a.uz * b.ux - a.ux * b.uz, cz = a.ux * b.uy - a.uy * b.ux;
  const float det = (cx * cx + cy * cy) + cz * cz;
  const float to_s = b.length * p + uv * q, to_t = a.length * q + uv * p;
  if (!(det > kNearlyParallel * (a.length * b.length))) {
    const bool up = to_s > 0;
    return {up ? 1.0F : 0.0F, up == (uv > 0) ? 1.0F : 0.0F};
  }
  const float left = det - (to_s * p + to_t * q);
  if (!(left > 0)) {
    return {to_s > 0 ? 1.0F : 0.0F, to_t > 0 ? 1.0F : 0.0F};
  }
  const float d = std::abs((wx * cx + wy * cy) + wz * cz) / std::sqrt(left);
  const float by_det = 1 / det;
  return {unit_clamp((d * to_s - (b.length * wu - uv * wv)) * by_det),
          unit_clamp((d * to_t + (a.length * wv - uv * wu)) * by_det)};
}

inline bool balls_touch(float dx, float dy, float dz, float radii, float scale) {
  const float d2 = (dx * dx + dy * dy) + dz * dz, reach = scale * radii;
  return d2 < reach * reach;
}

// Whether they touch when all radii are multiplied with `scale`, which is at least 0.
inline bool cones_touch(const Cone& a, const Cone& b, float scale) {
  const float wx = a.x - b.x, wy = a.y - b.y, wz = a.z - b.z;
  const float p = scale * a.growth, q = scale * b.growth;
  const ConeShares facing = facing_shares(a, b, wx, wy, wz, p, q);
  {
    const float x = wx + facing.s * a.ux, y = wy + facing.s * a.uy, z = wz + facing.s * a.uz;
    const float along = (x * b.ux + y * b.uy) + z * b.uz;
    const float t = nearest_share(along, (x * x + y * y) + z * z, b.length, q);
    if (balls_touch(x - t * b.ux, y - t * b.uy, z - t * b.uz,
                    (a.radius + facing.s * a.growth) + (b.radius + t * b.growth), scale)) {
      return true;
    }
  }
  const float x = facing.t * b.ux - wx, y = facing.t * b.uy - wy, z = facing.t * b.uz - wz;
  const float along = (x * a.ux + y * a.uy) + z * a.uz;
  const float s = nearest_share(along, (x * x + y * y) + z * z, a.length, p);
  return balls_touch(x - s * a.ux, y - s * a.uy, z - s * a.uz,
                     (a.radius + s * a.growth) + (b.radius + facing.t * b.growth), scale);
}

// What a job with cones looks at: the words that sc_prepare_cones() fills.
struct ConeTable {
  std::size_t count = 0, stride = 0;  // of links; of a row of scales: a multiple of 16
  const Pair* links = nullptr;        // `stride` of them, the last repeated
  const float* scales = nullptr;      // scales[a * stride + b], a < b; not a number: never, as all others are
};

// The first of the pairs of links that touch, as many as there is room for, and how many there are.
struct FoundCones {
  Pair* pairs;
  std::size_t capacity, count;
};

// Adds them in order.
void find_cones(Target resolved, const ConeTable& table, const Sphere* spheres, FoundCones& found);

}  // namespace spherechain

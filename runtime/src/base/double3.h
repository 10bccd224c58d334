// SPDX-License-Identifier: MIT
// Vectors in double precision, made of positions in single precision. No fused operations: the same bits everywhere.
#pragma once

#include <cmath>

#include "runtime/src/base/arithmetic.h"
#include "spherechain/types.h"

namespace spherechain {

struct Double3 {
  double x, y, z;
};

inline Double3 to_double(const Vec3& a) { return {double{a.x}, double{a.y}, double{a.z}}; }
inline Vec3 to_float(const Double3& a) {
  return {static_cast<float>(a.x), static_cast<float>(a.y), static_cast<float>(a.z)};
}

inline Double3 operator+(const Double3& a, const Double3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Double3 operator-(const Double3& a, const Double3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Double3 operator*(double s, const Double3& a) { return {s * a.x, s * a.y, s * a.z}; }

inline Double3 difference(const Vec3& a, const Vec3& b) { return to_double(a) - to_double(b); }

inline Double3 cross(const Double3& a, const Double3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

inline double dot(const Double3& a, const Double3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

inline double length(const Double3& a) { return std::sqrt(dot(a, a)); }

// False where there is no direction: of zero, or of what is not finite.
inline bool normalize(Double3& a) {
  const double size = length(a);
  if (!(size > 0) || !std::isfinite(size)) {
    return false;
  }
  a = (1 / size) * a;
  return true;
}

}  // namespace spherechain

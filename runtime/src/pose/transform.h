// SPDX-License-Identifier: MIT
// A caller's transforms as matrices.
#pragma once

#include <cmath>

#include "runtime/src/base/double3.h"
#include "spherechain/pose.h"

namespace spherechain {

// A matrix: three rows of four.
struct Affine {
  double m[3][4];
};

struct Quaternion {
  double x, y, z, w;
};

inline double inner(const Quaternion& a, const Quaternion& b) { return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w; }
inline Quaternion scaled(double s, const Quaternion& q) { return {s * q.x, s * q.y, s * q.z, s * q.w}; }
inline Quaternion unit(const Quaternion& q) { return scaled(1 / std::sqrt(inner(q, q)), q); }
inline Quaternion sum(const Quaternion& a, const Quaternion& b) { return {a.x + b.x, a.y + b.y, a.z + b.z, a.w + b.w}; }

inline Quaternion quaternion_of(const sc_transform& transform) {
  const float* const r = transform.rotation;
  return unit({double{r[0]}, double{r[1]}, double{r[2]}, double{r[3]}});
}

// Is it finite, and its rotation one?
bool is_sound(const sc_transform& transform);

Affine affine_of(const Double3& translation, const Quaternion& rotation, const Double3& scale);
Affine affine_of(const sc_transform& transform);
Affine product(const Affine& a, const Affine& b);

}  // namespace spherechain

// SPDX-License-Identifier: MIT
#include "runtime/src/pose/transform.h"

#include "runtime/src/base/memory.h"
#include "runtime/src/base/status.h"

namespace spherechain {

bool is_sound(const sc_transform& transform) {
  const float* const r = transform.rotation;
  const double squared = double{r[0]} * double{r[0]} + double{r[1]} * double{r[1]} + double{r[2]} * double{r[2]} +
                         double{r[3]} * double{r[3]};
  return std::isfinite(length(to_double(transform.translation)) + length(to_double(transform.scale))) &&
         squared > 1e-12 && squared < 1e12;
}

Affine affine_of(const Double3& translation, const Quaternion& q, const Double3& s) {
  const double xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z, xy = q.x * q.y, xz = q.x * q.z, yz = q.y * q.z,
               wx = q.w * q.x, wy = q.w * q.y, wz = q.w * q.z;
  return {{{(1 - 2 * (yy + zz)) * s.x, 2 * (xy - wz) * s.y, 2 * (xz + wy) * s.z, translation.x},
           {2 * (xy + wz) * s.x, (1 - 2 * (xx + zz)) * s.y, 2 * (yz - wx) * s.z, translation.y},
           {2 * (xz - wy) * s.x, 2 * (yz + wx) * s.y, (1 - 2 * (xx + yy)) * s.z, translation.z}}};
}

Affine affine_of(const sc_transform& transform) {
  return affine_of(to_double(transform.translation), quaternion_of(transform), to_double(transform.scale));
}

Affine product(const Affine& a, const Affine& b) {
  Affine out;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      out.m[i][j] = a.m[i][0] * b.m[0][j] + a.m[i][1] * b.m[1][j] + a.m[i][2] * b.m[2][j] + (j == 3 ? a.m[i][3] : 0.0);
    }
  }
  return out;
}

}  // namespace spherechain

using namespace spherechain;

extern "C" sc_status sc_place_bones(const sc_transform* transform, float* bones, size_t bone_count) noexcept {
  if (transform == nullptr || (bones == nullptr && bone_count > 0)) {
    return refuse(SC_NULL, transform == nullptr ? SC_FIELD_TRANSFORM : SC_FIELD_BONES);
  }
  if (any_misaligned(transform) || any_misaligned(bones)) {
    return refuse(SC_MISALIGNED, any_misaligned(transform) ? SC_FIELD_TRANSFORM : SC_FIELD_BONES);
  }
  if (!is_sound(*transform)) {
    return refuse(SC_BAD_VALUE, SC_FIELD_TRANSFORM);
  }
  const Affine place = affine_of(*transform);
  for (float* bone = bones; bone != bones + 12 * bone_count; bone += 12) {
    Affine own;
    for (std::size_t i = 0; i < 12; ++i) {
      own.m[i / 4][i % 4] = double{bone[i]};
    }
    const Affine placed = product(place, own);
    for (std::size_t i = 0; i < 12; ++i) {
      bone[i] = static_cast<float>(placed.m[i / 4][i % 4]);
    }
  }
  return done();
}

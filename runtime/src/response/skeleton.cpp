// SPDX-License-Identifier: MIT
#include "runtime/src/response/skeleton.h"

#include <algorithm>
#include <cmath>

namespace spherechain {

Quaternion turn_of(const Double3& v) { return unit({v.x / 2, v.y / 2, v.z / 2, 1}); }

Double3 vector_of(const Quaternion& q) {
  constexpr double kLeast = 1e-3;  // nearly half a turn
  const double w = std::max(std::abs(q.w), kLeast), sign = q.w < 0 ? -2.0 : 2.0;
  return {sign * q.x / w, sign * q.y / w, sign * q.z / w};
}

Quaternion product(const Quaternion& a, const Quaternion& b) {
  return {a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
          a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}

Double3 turn(const Affine& by, const Double3& v) {
  return {by.m[0][0] * v.x + by.m[0][1] * v.y + by.m[0][2] * v.z,
          by.m[1][0] * v.x + by.m[1][1] * v.y + by.m[1][2] * v.z,
          by.m[2][0] * v.x + by.m[2][1] * v.y + by.m[2][2] * v.z};
}

Double3 move(const Affine& by, const Double3& point) {
  return turn(by, point) + Double3{by.m[0][3], by.m[1][3], by.m[2][3]};
}

bool invert(const Affine& of, Affine& out) {
  const Double3 x{of.m[0][0], of.m[1][0], of.m[2][0]}, y{of.m[0][1], of.m[1][1], of.m[2][1]},
      z{of.m[0][2], of.m[1][2], of.m[2][2]};
  const double determinant = dot(x, cross(y, z)), size = length(x) * length(y) * length(z);
  if (!(std::abs(determinant) > 1e-9 * size) || !std::isfinite(1 / determinant)) {
    return false;
  }
  const Double3 rows[] = {(1 / determinant) * cross(y, z), (1 / determinant) * cross(z, x),
                          (1 / determinant) * cross(x, y)};
  const Double3 from{of.m[0][3], of.m[1][3], of.m[2][3]};
  for (std::size_t i = 0; i < 3; ++i) {
    out.m[i][0] = rows[i].x;
    out.m[i][1] = rows[i].y;
    out.m[i][2] = rows[i].z;
    out.m[i][3] = -dot(rows[i], from);
  }
  return true;
}

Affine axes_of(const Affine& of) {
  Double3 x{of.m[0][0], of.m[1][0], of.m[2][0]}, y{of.m[0][1], of.m[1][1], of.m[2][1]};
  const Double3 z{of.m[0][2], of.m[1][2], of.m[2][2]};
  if (!normalize(x)) {
    x = {1, 0, 0};
  }
  y = y - dot(x, y) * x;
  if (!normalize(y)) {
    y = std::abs(x.y) < 0.5 ? cross(x, {0, 1, 0}) : cross(x, {0, 0, 1});
    normalize(y);
  }
  const Double3 third = cross(x, y), up = dot(third, z) < 0 ? -1.0 * third : third;
  return {{{x.x, y.x, up.x, 0}, {x.y, y.y, up.y, 0}, {x.z, y.z, up.z, 0}}};
}

Double3 into(const Affine& axes, const Double3& v) {
  const auto& m = axes.m;
  return {m[0][0] * v.x + m[1][0] * v.y + m[2][0] * v.z, m[0][1] * v.x + m[1][1] * v.y + m[2][1] * v.z,
          m[0][2] * v.x + m[1][2] * v.y + m[2][2] * v.z};
}

Affine affine_of_rows(const float* rows) {
  Affine out;
  for (std::size_t i = 0; i < 12; ++i) {
    out.m[i / 4][i % 4] = double{rows[i]};
  }
  return out;
}

Double3 load(const float (&from)[3]) { return {double{from[0]}, double{from[1]}, double{from[2]}}; }

void store(const Double3& from, float (&to)[3]) {
  const Vec3 rounded = to_float(from);
  to[0] = rounded.x;
  to[1] = rounded.y;
  to[2] = rounded.z;
}

bool sort_joints(Span<const std::uint32_t> parents, Span<std::uint32_t> order) {
  std::size_t placed = 0;
  const auto place_children = [&](std::uint32_t parent) {
    for (std::uint32_t joint = 0; joint < parents.size; ++joint) {
      if (parents[joint] == parent) {
        if (placed == order.size) {
          return false;
        }
        order[placed++] = joint;
      }
    }
    return true;
  };
  bool fits = place_children(SC_NO_JOINT);
  for (std::size_t next = 0; fits && next < placed; ++next) {
    fits = place_children(order[next]);
  }
  return fits && placed == parents.size;
}

void place_joints(const Skeleton& skeleton, const sc_transform* locals, const Affine& place, Span<Affine> world) {
  for (const std::uint32_t joint : skeleton.order) {
    const std::uint32_t parent = skeleton.parents[joint];
    world[joint] = product(parent == SC_NO_JOINT ? place : world[parent], affine_of(locals[joint]));
  }
}

}  // namespace spherechain

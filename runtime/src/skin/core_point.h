// SPDX-License-Identifier: MIT
// Points below a body part's skin, half as deep as the centres of its spheres: how many of them are inside another part
// says how much of the part is.
#pragma once

#include "runtime/src/base/double3.h"
#include "spherechain/types.h"

namespace spherechain {

// `corners` are those of the point's triangle in the pose, `center` that of the triangle's sphere; `index`: the point's
// place among its part's, by which points spread over a triangle that has many.
inline Vec3 core_point(const float (&corners)[3][3], const Vec3& center, std::size_t index) {
  const auto share = [&](double step) {
    const double steps = step * static_cast<double>(index);
    return steps - static_cast<double>(static_cast<std::size_t>(steps));
  };
  double u = share(0.7548776662466927), v = share(0.5698402910980532);  // no two are near each other
  if (u + v > 1) {
    u = 1 - u;
    v = 1 - v;
  }
  Double3 p[3];
  for (std::size_t k = 0; k < 3; ++k) {
    p[k] = {double{corners[k][0]}, double{corners[k][1]}, double{corners[k][2]}};
  }
  const Double3 edge = p[1] - p[0], other = p[2] - p[0], normal = cross(edge, other);
  const Double3 skin = p[0] + (u * edge + v * other);
  const double size = dot(normal, normal);
  const double deep = size > 0 ? 0.5 * dot(to_double(center) - skin, normal) / size : 0;
  return to_float(skin + deep * normal);
}

}  // namespace spherechain

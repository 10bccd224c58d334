// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/volumes/volume_json.h"

#include <cstddef>

namespace spherechain::baker {

using nlohmann::ordered_json;

ordered_json json_of(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
ordered_json json_of(const Eigen::Quaterniond& q) { return {q.x(), q.y(), q.z(), q.w()}; }

ordered_json json_of(const Volume& volume) {
  ordered_json out{{"type", volume_name(volume)}};
  if (const auto* ball = std::get_if<BallVolume>(&volume)) {
    out["center"] = json_of(ball->center);
    out["radius"] = ball->radius;
  } else if (const auto* cone = std::get_if<ConeVolume>(&volume)) {
    out["a"] = json_of(cone->a);
    out["b"] = json_of(cone->b);
    if (cone->radius_a == cone->radius_b) {
      out["radius"] = cone->radius_a;
    } else {
      out["radius_a"] = cone->radius_a;
      out["radius_b"] = cone->radius_b;
    }
  } else if (const auto* ellipsoid = std::get_if<EllipsoidVolume>(&volume)) {
    out["center"] = json_of(ellipsoid->center);
    out["rotation"] = json_of(ellipsoid->rotation);
    out["radii"] = json_of(ellipsoid->radii);
  } else if (const auto* box = std::get_if<BoxVolume>(&volume)) {
    out["center"] = json_of(box->center);
    out["rotation"] = json_of(box->rotation);
    out["half"] = json_of(box->half);
  }
  return out;
}

const char* reason_name(IgnoredReason reason) {
  constexpr const char* kNames[] = {"adjacent", "rest", "always", "never"};
  return kNames[static_cast<std::size_t>(reason)];
}

}  // namespace spherechain::baker

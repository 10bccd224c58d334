// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <nlohmann/json.hpp>

#include "export/formats.h"
#include "export/volume_json.h"

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

Export export_json(const Colliders& colliders) {
  ordered_json bodies = ordered_json::array();
  for (const ColliderBody& body : colliders.bodies) {
    ordered_json volumes = ordered_json::array();
    for (const Volume& volume : body.volumes) volumes.push_back(json_of(volume));
    ordered_json one{{"part", body.name}};
    one["bone"] = body.bone.empty() ? ordered_json() : ordered_json(body.bone);
    one["parent"] =
        body.parent < 0 ? ordered_json() : ordered_json(colliders.bodies[static_cast<std::size_t>(body.parent)].name);
    one["position"] = json_of(Vec3(body.rest.translation()));
    one["rotation"] = json_of(Eigen::Quaterniond(body.rest.linear()));
    one["volumes"] = volumes;
    bodies.push_back(std::move(one));
  }
  ordered_json ignored = ordered_json::array();
  for (const IgnoredBodies& pair : colliders.ignored) {
    ignored.push_back({{"parts",
                        {colliders.bodies[static_cast<std::size_t>(pair.a)].name,
                         colliders.bodies[static_cast<std::size_t>(pair.b)].name}},
                       {"reason", reason_name(pair.reason)}});
  }
  const ordered_json out{{"writer", "spherechain"},
                         {"character", colliders.source_file},
                         {"unit", "m"},
                         {"height", colliders.height},
                         {"left", json_of(colliders.left)},
                         {"up", json_of(colliders.up)},
                         {"forward", json_of(colliders.forward)},
                         {"bodies", bodies},
                         {"ignored", ignored}};
  return {{{"", out.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n"}}, {}};
}

}  // namespace spherechain::baker

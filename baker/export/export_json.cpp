// SPDX-License-Identifier: GPL-3.0-or-later
#include <nlohmann/json.hpp>

#include "baker/export/formats.h"
#include "baker/volumes/volume_json.h"

namespace spherechain::baker {

using nlohmann::ordered_json;

Export export_json(const Colliders& colliders) {
  ordered_json bodies = ordered_json::array();
  for (const ColliderBody& body : colliders.bodies) {
    ordered_json volumes = ordered_json::array();
    for (const Volume& volume : body.volumes) volumes.push_back(json_of(volume));
    ordered_json one{{"part", body.name}};
    one["bone"] = body.bone.empty() ? ordered_json() : ordered_json(body.bone);
    one["parent"] =
        body.parent < 0 ? ordered_json() : ordered_json(colliders.bodies[static_cast<std::size_t>(body.parent)].name);
    if (body.held_by >= 0) one["held_by"] = colliders.bodies[static_cast<std::size_t>(body.held_by)].name;
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

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "baker/volumes/colliders.h"
#include "baker/volumes/volume_json.h"

// Reference for other engines. Positions in metres, rotations x y z w, in the axes of the rest pose.
namespace spherechain::test {

inline nlohmann::ordered_json json_of(const baker::Colliders& colliders) {
  nlohmann::ordered_json out{{"bodies", nlohmann::ordered_json::array()},
                             {"height", colliders.height},
                             {"metres_per_unit", colliders.metres_per_unit},
                             {"poses", nlohmann::ordered_json::array()}};
  for (const baker::ColliderBody& body : colliders.bodies) {
    nlohmann::ordered_json volumes = nlohmann::ordered_json::array();
    for (const baker::Volume& volume : body.volumes) volumes.push_back(baker::json_of(volume));
    out["bodies"].push_back({{"part", body.name}, {"bone", body.bone}, {"parent", body.parent}, {"volumes", volumes}});
  }
  return out;
}

// Where each body stands and which overlap.
inline void add_pose(nlohmann::ordered_json& out, const baker::Colliders& colliders,
                     const std::vector<Eigen::Isometry3d>& at, nlohmann::ordered_json pose) {
  nlohmann::ordered_json bodies = nlohmann::ordered_json::array();
  for (const Eigen::Isometry3d& body : at) {
    bodies.push_back({{"position", baker::json_of(baker::Vec3(body.translation()))},
                      {"rotation", baker::json_of(Eigen::Quaterniond(body.linear()))}});
  }
  pose["bodies"] = bodies;
  pose["overlaps"] = overlapping(colliders, at);
  out["poses"].push_back(std::move(pose));
}

}  // namespace spherechain::test

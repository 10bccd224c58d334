// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/filter/joint_limits.h"

#include <nlohmann/json.hpp>
#include <numbers>

#include "baker/mesh/error.h"
#include "baker/play/asset_file.h"

namespace spherechain::baker {

void read_joint_limits(const std::string& file, RandomPoses& poses) {
  const auto fail = [&](const std::string& what) { throw Error(ExitCode::kFile, file + ": " + what); };
  const nlohmann::json object = nlohmann::json::parse(read_file(file), nullptr, false);
  if (!object.is_object()) fail(R"(is not a JSON object (give each joint its axes: {"elbow": {"x": [0, 140]}}))");
  for (const auto& [joint, axes] : object.items()) {
    if (!axes.is_object()) fail("joint '" + joint + R"(': is not an object of axes: {"x": [low, high]})");
    Vec3 low = Vec3::Zero(), high = Vec3::Zero();
    for (const auto& [axis, range] : axes.items()) {
      const std::size_t k = axis.size() == 1 ? std::string("xyz").find(axis) : std::string::npos;
      if (k == std::string::npos) fail("joint '" + joint + "': '" + axis + "' is no axis (x, y, z)");
      const bool is_range = range.is_array() && range.size() == 2 && range[0].is_number() && range[1].is_number() &&
                            range[0] >= -180 && range[0] <= range[1] && range[1] <= 180;
      if (!is_range) fail("joint '" + joint + "', " + axis + ": is not [low, high] in degrees from -180 to 180");
      low[static_cast<Eigen::Index>(k)] = range[0].get<double>();
      high[static_cast<Eigen::Index>(k)] = range[1].get<double>();
    }
    constexpr double kRadiansADegree = std::numbers::pi / 180;
    if (!poses.limit(joint, kRadiansADegree * low, kRadiansADegree * high)) {
      fail("joint '" + joint + "': the character has no such joint (spherechain inspect INPUT --roles lists them)");
    }
  }
}

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "baker/import/named_file.h"
#include "baker/mesh/error.h"
#include "baker/motion/poses.h"

namespace spherechain::baker {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

constexpr std::size_t kPosesMax = 1000;  // files that include files multiply
constexpr double kMovementMax = 1e6;     // heights
constexpr double kDegreesMax = 180;      // farther round the interpolation would go the other way

[[noreturn]] void fail(const fs::path& file, const std::string& what) {
  throw Error(ExitCode::kFile, file.string() + ": " + what);
}

// Unlike the library's, without an exception where the name is too long or a folder is locked.
bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

Json read_json(const fs::path& file) {
  std::ifstream stream(file);
  if (!stream) fail(file, "cannot be read (check its permissions)");
  try {
    return Json::parse(stream);
  } catch (const Json::exception& error) {
    std::string what = error.what();
    if (const auto at = what.find("line "); at != std::string::npos) what = what.substr(at);
    fail(file, "is not valid JSON: " + what + " (mend the file there)");
  }
}

bool has_numbers(const Json& value, std::size_t count) {
  return value.is_array() && value.size() == count &&
         std::all_of(value.begin(), value.end(), [](const Json& v) { return v.is_number(); });
}

Eigen::Quaterniond read_rotation(const fs::path& file, const std::string& joint, const Json& value) {
  if (!has_numbers(value, 3)) {
    fail(file, "the rotation of '" + joint + "' is not three numbers, nor twelve (write [x, y, z] in degrees)");
  }
  const Vec3 degrees(value[0].get<double>(), value[1].get<double>(), value[2].get<double>());
  const double angle = degrees.norm();
  if (!std::isfinite(angle) || angle > kDegreesMax) {
    fail(file, "the rotation of '" + joint + "' is more than 180 degrees long (go there in two poses)");
  }
  if (angle == 0) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle * std::numbers::pi / 180, degrees / angle));
}

// Three rows of four.
Affine read_movement(const fs::path& file, const std::string& joint, const Json& value) {
  Affine out;
  for (std::size_t i = 0; i < 12; ++i) {
    out.matrix()(static_cast<Eigen::Index>(i / 4), static_cast<Eigen::Index>(i % 4)) = value[i].get<double>();
  }
  if (!out.matrix().allFinite() || out.matrix().cwiseAbs().maxCoeff() > kMovementMax) {
    fail(file, "the matrix of '" + joint + "' has a number beyond a million (lengths are in heights of the character)");
  }
  return out;
}

template <typename Named>
void check_name(const fs::path& file, const std::vector<Named>& known, const std::string& name, const char* what) {
  if (std::any_of(known.begin(), known.end(), [&](const Named& k) { return k.name == name; })) return;
  std::string names;
  for (const Named& k : known) names += (names.empty() ? "" : ", ") + k.name;
  fail(file, std::string("there is no ") + what + " '" + name + "' (known: " + (names.empty() ? "none" : names) + ")");
}

struct Names {
  const std::vector<Joint>& joints;
  const std::vector<Morph>& morphs;
};

Pose read_pose(const fs::path& file, const Json& value, const Names& names) {
  Pose pose;
  for (const auto& [name, of] : value.items()) {
    if (name == "morphs" && of.is_object()) {
      for (const auto& [morph, weight] : of.items()) {
        check_name(file, names.morphs, morph, "morph target");
        if (!weight.is_number() || std::abs(weight.get<double>()) > kMovementMax) {
          fail(file, "the weight of '" + morph + "' is not a number from -1e6 to 1e6");
        }
        pose.morphs[morph] = weight.get<double>();
      }
      continue;
    }
    check_name(file, names.joints, name, "joint");
    if (has_numbers(of, 12))
      pose.movements[name] = read_movement(file, name, of);
    else
      pose.rotations[name] = read_rotation(file, name, of);
  }
  return pose;
}

PoseRig rig_in(const fs::path& file, const Json& json) {
  const Json rig = json.value("rig", Json("automatic"));
  if (rig != "automatic" && rig != "own") fail(file, "'rig' is neither \"automatic\" nor \"own\"");
  return rig == "own" ? PoseRig::kOwn : PoseRig::kAutomatic;
}

Json read_poses_json(const fs::path& file) {
  Json json = read_json(file);
  if (!json.is_object() || !json.contains("poses") || !json["poses"].is_array() || json["poses"].empty()) {
    fail(file, "is no pose file (it needs an object with a non-empty list 'poses'; see samples/poses/README.md)");
  }
  return json;
}

void read_into(PoseMotion& motion, const fs::path& file, const Names& names, PoseRig rig, std::vector<fs::path>& open) {
  if (!is_file(file)) fail(file, "no such pose file (name an existing JSON file)");
  const fs::path canonical = fs::canonical(file);
  if (std::find(open.begin(), open.end(), canonical) != open.end()) {
    fail(file, "includes itself, directly or through another file (break the circle)");
  }
  open.push_back(canonical);
  const Json json = read_poses_json(file);
  for (const auto& [key, value] : json.items()) {
    if (key != "name" && key != "about" && key != "rig" && key != "poses") {
      fail(file, "the key '" + key + "' is not known (known: name, about, rig, poses)");
    }
    if (key != "poses" && !value.is_string()) fail(file, "'" + key + "' is not a text (write it in quotes)");
  }
  if (rig_in(file, json) != rig) fail(file, "names joints of another rig than the file that takes its poses");
  if (open.size() == 1) motion.name = json.value("name", file.stem().string());
  for (const Json& entry : json["poses"]) {
    if (entry.is_string()) {
      const std::string name = entry.get<std::string>();
      const NamedFile other = named_file(file.parent_path(), name);
      if (!other.is_there) fail(file, "takes poses from " + in_quotes(name) + ", which " + other.what_is_wrong());
      read_into(motion, other.path, names, rig, open);
    } else if (entry.is_object()) {
      motion.poses.push_back(read_pose(file, entry, names));
    } else {
      fail(file,
           "an entry of 'poses' is neither an object of rotations nor the name of a pose file (write one of them)");
    }
    if (motion.poses.size() > kPosesMax) fail(file, "has more than 1000 poses with what it includes (shorten it)");
  }
  open.pop_back();
}

void collect_files(const fs::path& file, std::vector<fs::path>& found) {
  if (!is_file(file) || found.size() > kPosesMax) return;
  std::error_code error;
  const fs::path canonical = fs::canonical(file, error);
  if (error || std::find(found.begin(), found.end(), canonical) != found.end()) return;
  found.push_back(canonical);
  std::ifstream stream(file);
  const Json json = Json::parse(stream, nullptr, false);
  if (!json.is_object() || !json.contains("poses")) return;
  for (const Json& entry : json["poses"]) {
    if (entry.is_string()) collect_files(named_file(file.parent_path(), entry.get<std::string>()).path, found);
  }
}

}  // namespace

std::vector<fs::path> files_of_poses(const fs::path& path) {
  std::vector<fs::path> found;
  collect_files(path, found);
  return found;
}

PoseRig rig_of_poses(const fs::path& path) {
  if (!is_file(path)) fail(path, "no such pose file (name an existing JSON file)");
  return rig_in(path, read_poses_json(path));
}

PoseMotion read_pose_motion(const fs::path& path, const std::vector<Joint>& joints, const std::vector<Morph>& morphs) {
  PoseMotion motion;
  std::vector<fs::path> open;
  read_into(motion, path, {joints, morphs}, rig_of_poses(path), open);
  return motion;
}

}  // namespace spherechain::baker

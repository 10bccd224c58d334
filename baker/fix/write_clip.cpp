// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/write_clip.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "baker/import/glb_file.h"
#include "baker/write/glb_mark.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

constexpr double kUnturned = 1e-7;  // radians: no turn

// A node with a matrix cannot be animated: it gets its parts.
void take_apart(ordered_json& node, const Node& parts) {
  if (!node.contains("matrix")) return;
  node.erase("matrix");
  const Eigen::Quaterniond& q = parts.rotation;
  node["translation"] = {parts.translation.x(), parts.translation.y(), parts.translation.z()};
  node["rotation"] = {q.x(), q.y(), q.z(), q.w()};
  node["scale"] = {parts.scale.x(), parts.scale.y(), parts.scale.z()};
}

const char* path_name(ChannelPath path) {
  return path == ChannelPath::kTranslation ? "translation" : path == ChannelPath::kRotation ? "rotation" : "scale";
}

const char* interpolation_name(Interpolation interpolation) {
  return interpolation == Interpolation::kStep     ? "STEP"
         : interpolation == Interpolation::kLinear ? "LINEAR"
                                                   : "CUBICSPLINE";
}

std::vector<float> to_floats(const std::vector<double>& numbers) { return {numbers.begin(), numbers.end()}; }

}  // namespace

std::vector<Channel> turned_channels(const TurnedClip& clip, const Turns& turns, const std::vector<char>& in_window) {
  std::vector<Channel> out;
  const auto turn_at = [&](std::size_t joint, double frame) {
    const int first = std::clamp(static_cast<int>(frame), 0, clip.frames() - 1);
    const int next = std::min(first + 1, clip.frames() - 1);
    const double share = std::clamp(frame - first, 0.0, 1.0);
    const auto of = [&](int f) -> const Vec3& { return turns[static_cast<std::size_t>(f) * clip.count() + joint]; };
    return Vec3((1 - share) * of(first) + share * of(next));
  };
  for (std::size_t j = 0; j < clip.count(); ++j) {
    bool moves = false;
    for (int f = 0; f < clip.frames(); ++f) moves |= turn_at(j, f).norm() > kUnturned;
    if (!moves) continue;
    const Node& node = clip.rig().nodes[clip.joints()[j].node];
    const Channel* channel = nullptr;
    for (const Channel& one : clip.clip().channels) {
      if (one.path == ChannelPath::kRotation && one.target == clip.joints()[j].node) channel = &one;
    }
    // The clip's own keys, and each frame of the windows; all frames where keys are no lines' ends.
    const bool is_linear = channel != nullptr && channel->interpolation == Interpolation::kLinear;
    std::set<float> times;
    if (is_linear) {
      for (const double time : channel->times) times.insert(static_cast<float>(time));
    }
    for (int f = 0; f < clip.frames(); ++f) {
      const auto time = static_cast<float>(f / clip.fps());
      const bool is_near =
          std::any_of(times.lower_bound(time - 1e-4F), times.upper_bound(time + 1e-4F), [](float) { return true; });
      const auto is_open = [&](int g) {
        return g >= 0 && g < clip.frames() && in_window[static_cast<std::size_t>(g)] != 0;
      };
      // One beside the window, too: there the way to the next key is the clip's own.
      const bool is_wanted = (channel != nullptr && !is_linear) || is_open(f - 1) || is_open(f) || is_open(f + 1);
      if (is_wanted && !is_near) times.insert(time);
    }
    Channel track{ChannelPath::kRotation, clip.joints()[j].node, Interpolation::kLinear, {}, {}};
    Eigen::Quaterniond before(0, 0, 0, 0);
    for (const float time : times) {
      Eigen::Quaterniond rotation =
          channel == nullptr ? node.rotation : Eigen::Quaterniond(sample(*channel, double{time}));
      const Vec3 turn = turn_at(j, double{time} * clip.fps());
      if (turn.norm() > kUnturned) rotation = turned(rotation, turn).normalized();
      if (rotation.dot(before) < 0) rotation.coeffs() = -rotation.coeffs();
      before = rotation;
      track.times.push_back(double{time});
      track.values.insert(track.values.end(), rotation.coeffs().begin(), rotation.coeffs().end());
    }
    out.push_back(std::move(track));
  }
  return out;
}

std::string with_channels(const std::string& bytes, const std::string& file, const SourceRig& rig, int animation,
                          const std::string& clip_name, const std::vector<Channel>& channels) {
  GlbFile glb = glb_of_bytes(bytes, file);
  if (channels.empty()) return bytes;
  ordered_json& animations = glb.json["animations"];
  if (animation < 0) {
    animation = static_cast<int>(animations.size());
    animations.push_back(
        {{"name", clip_name}, {"samplers", ordered_json::array()}, {"channels", ordered_json::array()}});
  }
  ordered_json& target = animations[static_cast<std::size_t>(animation)];
  std::map<std::vector<double>, std::size_t> inputs;  // one for all that have the same times
  for (const Channel& channel : channels) {
    const Node& node = rig.nodes[channel.target];
    const char* const path = path_name(channel.path);
    take_apart(glb.json["nodes"][static_cast<std::size_t>(node.in_file)], node);
    const auto is_it = [&](const ordered_json& one) {
      const ordered_json& to = one["target"];
      return to.value("node", -1) == node.in_file && to.value("path", "") == path;
    };
    const auto [input, is_new] = inputs.try_emplace(channel.times, 0);
    if (is_new) input->second = glb.add_accessor(to_floats(channel.times), "SCALAR", 0, true);
    const bool is_turn = channel.path == ChannelPath::kRotation;
    const std::size_t output = glb.add_accessor(to_floats(channel.values), is_turn ? "VEC4" : "VEC3");
    target["samplers"].push_back(
        {{"input", input->second}, {"output", output}, {"interpolation", interpolation_name(channel.interpolation)}});
    const std::size_t sampler = target["samplers"].size() - 1;
    const auto found = std::find_if(target["channels"].begin(), target["channels"].end(), is_it);
    if (found != target["channels"].end()) {
      (*found)["sampler"] = sampler;
    } else {
      target["channels"].push_back({{"sampler", sampler}, {"target", {{"node", node.in_file}, {"path", path}}}});
    }
  }
  mark_as_own(glb.json);
  return glb.bytes();
}

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/write_clip.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "baker/mesh/error.h"
#include "baker/write/glb_mark.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

constexpr std::uint32_t kMagic = 0x46546C67, kJson = 0x4E4F534A, kBinary = 0x004E4942;
constexpr double kUnturned = 1e-7;  // radians: no turn

struct Glb {
  ordered_json json;
  std::string binary;
};

std::uint32_t word_at(const std::string& bytes, std::size_t at) {
  std::uint32_t out = 0;
  if (at + 4 <= bytes.size()) std::memcpy(&out, bytes.data() + at, 4);
  return out;
}

Glb read_glb(const std::string& bytes, const std::string& file) {
  if (word_at(bytes, 0) != kMagic || word_at(bytes, 4) != 2 || word_at(bytes, 16) != kJson) {
    throw Error(ExitCode::kFile,
                file + ": is no binary glTF 2.0 file, which a mended clip is written to (export it as .glb)");
  }
  const std::size_t json_size = word_at(bytes, 12), end = 20 + json_size;
  Glb out;
  out.json = ordered_json::parse(
      bytes.begin() + 20, bytes.begin() + static_cast<std::ptrdiff_t>(std::min(end, bytes.size())), nullptr, false);
  if (out.json.is_discarded()) throw Error(ExitCode::kFile, file + ": its JSON is broken");
  if (end + 8 <= bytes.size() && word_at(bytes, end + 4) == kBinary) {
    out.binary = bytes.substr(end + 8, word_at(bytes, end));
  }
  return out;
}

void put_word(std::string& out, std::size_t word) {
  const auto value = static_cast<std::uint32_t>(word);
  out.append(reinterpret_cast<const char*>(&value), 4);
}

std::string to_bytes(const Glb& glb) {
  std::string json = glb.json.dump();
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string binary = glb.binary;
  binary.resize((binary.size() + 3) / 4 * 4, '\0');
  std::string out;
  put_word(out, kMagic);
  put_word(out, 2);
  put_word(out, 12 + 8 + json.size() + 8 + binary.size());
  put_word(out, json.size());
  put_word(out, kJson);
  out += json;
  put_word(out, binary.size());
  put_word(out, kBinary);
  return out + binary;
}

int add_accessor(Glb& glb, const std::vector<float>& numbers, const char* type, std::size_t width) {
  glb.binary.resize((glb.binary.size() + 3) / 4 * 4, '\0');
  glb.json["bufferViews"].push_back(
      {{"buffer", 0}, {"byteOffset", glb.binary.size()}, {"byteLength", numbers.size() * sizeof(float)}});
  glb.binary.append(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(float));
  ordered_json accessor{{"bufferView", glb.json["bufferViews"].size() - 1},
                        {"componentType", 5126},
                        {"count", numbers.size() / width},
                        {"type", type}};
  if (width == 1) {
    accessor["min"] = ordered_json::array({numbers.front()});
    accessor["max"] = ordered_json::array({numbers.back()});
  }
  glb.json["accessors"].push_back(std::move(accessor));
  return static_cast<int>(glb.json["accessors"].size()) - 1;
}

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
  Glb glb = read_glb(bytes, file);
  if (channels.empty()) return bytes;
  ordered_json& animations = glb.json["animations"];
  if (animation < 0) {
    animation = static_cast<int>(animations.size());
    animations.push_back(
        {{"name", clip_name}, {"samplers", ordered_json::array()}, {"channels", ordered_json::array()}});
  }
  ordered_json& target = animations[static_cast<std::size_t>(animation)];
  std::map<std::vector<double>, int> inputs;  // one for all that have the same times
  for (const Channel& channel : channels) {
    const Node& node = rig.nodes[channel.target];
    const char* const path = path_name(channel.path);
    take_apart(glb.json["nodes"][static_cast<std::size_t>(node.in_file)], node);
    const auto is_it = [&](const ordered_json& one) {
      const ordered_json& to = one["target"];
      return to.value("node", -1) == node.in_file && to.value("path", "") == path;
    };
    const auto [input, is_new] = inputs.try_emplace(channel.times);
    if (is_new) input->second = add_accessor(glb, to_floats(channel.times), "SCALAR", 1);
    const bool is_turn = channel.path == ChannelPath::kRotation;
    const int output = add_accessor(glb, to_floats(channel.values), is_turn ? "VEC4" : "VEC3", is_turn ? 4 : 3);
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
  if (!glb.json.contains("buffers")) glb.json["buffers"].push_back(ordered_json::object());
  glb.json["buffers"][0]["byteLength"] = glb.binary.size();
  mark_as_own(glb.json);
  return to_bytes(glb);
}

}  // namespace spherechain::baker

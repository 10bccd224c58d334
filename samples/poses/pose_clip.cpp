// SPDX-License-Identifier: MIT
// pose_clip PREVIEW.glb POSES.json OUT.glb: adds the poses to a preview of `spherechain bake` as a clip.
#include <tiny_gltf.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace {

using Quaternion = std::array<float, 4>;              // x, y, z, w
using Rotations = std::map<std::string, Quaternion>;  // by joint, in the character's axes

constexpr float kSecondsPerPose = 1;
constexpr int kMaxDepth = 8;  // of pose files that name pose files

Quaternion product(const Quaternion& l, const Quaternion& r) {
  return {l[3] * r[0] + l[0] * r[3] + l[1] * r[2] - l[2] * r[1], l[3] * r[1] - l[0] * r[2] + l[1] * r[3] + l[2] * r[0],
          l[3] * r[2] + l[0] * r[1] - l[1] * r[0] + l[2] * r[3], l[3] * r[3] - l[0] * r[0] - l[1] * r[1] - l[2] * r[2]};
}

// A rotation vector in degrees: its direction is the axis, its length the angle.
Quaternion rotation_of(const nlohmann::json& degrees) {
  const float x = degrees.at(0), y = degrees.at(1), z = degrees.at(2);
  const float length = std::sqrt(x * x + y * y + z * z), half = length * 0.00872664626F;
  const float s = length > 0 ? std::sin(half) / length : 0;
  return {s * x, s * y, s * z, std::cos(half)};
}

void read_poses(const std::filesystem::path& path, int depth, std::vector<Rotations>& poses) {
  std::ifstream file(path);
  const nlohmann::json json = nlohmann::json::parse(file, nullptr, false);
  if (!json.is_object() || depth > kMaxDepth) throw std::runtime_error(path.string() + ": is no pose file");
  for (const nlohmann::json& pose : json.at("poses")) {
    if (pose.is_string()) {
      read_poses(path.parent_path() / pose.get<std::string>(), depth + 1, poses);
      continue;
    }
    poses.emplace_back();
    for (const auto& [joint, degrees] : pose.items()) poses.back()[joint] = rotation_of(degrees);
  }
}

int add_accessor(tinygltf::Model& model, const std::vector<float>& numbers, int type) {
  std::vector<unsigned char>& bytes = model.buffers.at(0).data;
  bytes.resize((bytes.size() + 3) / 4 * 4);
  tinygltf::BufferView view;
  view.buffer = 0;
  view.byteOffset = bytes.size();
  view.byteLength = numbers.size() * sizeof(float);
  bytes.resize(bytes.size() + view.byteLength);
  std::memcpy(bytes.data() + view.byteOffset, numbers.data(), view.byteLength);
  model.bufferViews.push_back(view);
  tinygltf::Accessor accessor;
  accessor.bufferView = static_cast<int>(model.bufferViews.size() - 1);
  accessor.componentType = TINYGLTF_COMPONENT_TYPE_FLOAT;
  accessor.type = type;
  accessor.count = numbers.size() / (type == TINYGLTF_TYPE_VEC4 ? 4 : 1);
  if (type == TINYGLTF_TYPE_SCALAR) {  // glTF asks for the bounds of times
    accessor.minValues = {double{numbers.front()}};
    accessor.maxValues = {double{numbers.back()}};
  }
  model.accessors.push_back(accessor);
  return static_cast<int>(model.accessors.size() - 1);
}

// From rest through the poses, each a second after the one before. Below the preview's root node no joint is turned at
// rest, and the root turns the file's axes into the character's own.
void add_clip(tinygltf::Model& model, const std::string& name, const std::vector<Rotations>& poses) {
  const tinygltf::Node& root = model.nodes.at(static_cast<std::size_t>(model.scenes.at(0).nodes.at(0)));
  Quaternion turn{0, 0, 0, 1};
  for (std::size_t k = 0; k < root.rotation.size(); ++k) turn.at(k) = static_cast<float>(root.rotation[k]);
  const Quaternion back{-turn[0], -turn[1], -turn[2], turn[3]};

  tinygltf::Animation clip;
  clip.name = name;
  std::vector<float> times;
  for (std::size_t i = 0; i <= poses.size(); ++i) times.push_back(kSecondsPerPose * static_cast<float>(i));
  const int input = add_accessor(model, times, TINYGLTF_TYPE_SCALAR);
  for (const int joint : model.skins.at(0).joints) {
    const std::string& joint_name = model.nodes.at(static_cast<std::size_t>(joint)).name;
    std::vector<float> values{0, 0, 0, 1};
    for (const Rotations& pose : poses) {
      const auto found = pose.find(joint_name);
      const Quaternion q = found == pose.end() ? Quaternion{0, 0, 0, 1} : product(back, product(found->second, turn));
      values.insert(values.end(), q.begin(), q.end());
    }
    tinygltf::AnimationSampler sampler;
    sampler.input = input;
    sampler.output = add_accessor(model, values, TINYGLTF_TYPE_VEC4);
    tinygltf::AnimationChannel channel;
    channel.sampler = static_cast<int>(clip.samplers.size());
    channel.target_node = joint;
    channel.target_path = "rotation";
    clip.samplers.push_back(sampler);
    clip.channels.push_back(channel);
  }
  model.animations.push_back(clip);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fputs("usage: pose_clip PREVIEW.glb POSES.json OUT.glb\n", stderr);
    return 2;
  }
  try {
    tinygltf::TinyGLTF gltf;
    tinygltf::Model model;
    std::string error, warning;
    if (!gltf.LoadBinaryFromFile(&model, &error, &warning, argv[1])) {
      throw std::runtime_error(std::string(argv[1]) + ": is no GLB file");
    }
    std::vector<Rotations> poses;
    read_poses(argv[2], 0, poses);
    add_clip(model, std::filesystem::path(argv[2]).stem().string(), poses);
    if (!gltf.WriteGltfSceneToFile(&model, argv[3], true, true, false, true)) {
      throw std::runtime_error(std::string(argv[3]) + ": cannot be written");
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "pose_clip: error: %s\n", error.what());
    return 3;
  }
  return 0;
}

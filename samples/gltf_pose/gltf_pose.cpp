// SPDX-License-Identifier: MIT
#include "gltf_pose.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "accessor.h"

namespace samples {
namespace {

Matrix product(const Matrix& l, const Matrix& r) {
  Matrix out{};
  for (std::size_t column = 0; column < 4; ++column) {
    for (std::size_t row = 0; row < 4; ++row) {
      for (std::size_t k = 0; k < 4; ++k) {
        out[4 * column + row] += l[4 * k + row] * r[4 * column + k];
      }
    }
  }
  return out;
}

Matrix matrix_of(const std::vector<float>& t, const std::vector<float>& q, const std::vector<float>& s) {
  const float x = q[0], y = q[1], z = q[2], w = q[3];
  return {s[0] * (1 - 2 * (y * y + z * z)),
          s[0] * 2 * (x * y + z * w),
          s[0] * 2 * (x * z - y * w),
          0,  //
          s[1] * 2 * (x * y - z * w),
          s[1] * (1 - 2 * (x * x + z * z)),
          s[1] * 2 * (y * z + x * w),
          0,  //
          s[2] * 2 * (x * z + y * w),
          s[2] * 2 * (y * z - x * w),
          s[2] * (1 - 2 * (x * x + y * y)),
          0,  //
          t[0],
          t[1],
          t[2],
          1};
}

std::vector<float> floats(const std::vector<double>& in, std::vector<float> otherwise) {
  return in.empty() ? otherwise : std::vector<float>(in.begin(), in.end());
}

void normalize(std::vector<float>& q) {
  float square = 0;
  for (const float x : q) square += x * x;
  for (float& x : q) x /= std::sqrt(square);
}

// The value of a channel at this time. Appendix C of the glTF 2.0 specification.
std::vector<float> sample(const std::vector<float>& times, const std::vector<float>& values,
                          const std::string& interpolation, float seconds) {
  const bool is_cubic = interpolation == "CUBICSPLINE";
  const std::size_t width = values.size() / times.size() / (is_cubic ? 3 : 1);
  const auto key = [&](std::size_t i, std::size_t part, std::size_t k) {
    return values[is_cubic ? (3 * i + part) * width + k : i * width + k];
  };
  const auto after = static_cast<std::size_t>(std::upper_bound(times.begin(), times.end(), seconds) - times.begin());
  const std::size_t from = after == 0 ? 0 : after - 1, to = std::min(after, times.size() - 1);
  const float span = times[to] - times[from];
  const float u = span > 0 && interpolation != "STEP" ? (seconds - times[from]) / span : 0;
  float toward = 1;  // the shorter way round, of rotations
  if (width == 4 && !is_cubic) {
    float cosine = 0;
    for (std::size_t k = 0; k < 4; ++k) cosine += key(from, 1, k) * key(to, 1, k);
    toward = cosine < 0 ? -1.0F : 1.0F;
  }
  std::vector<float> out(width);
  for (std::size_t k = 0; k < width; ++k) {
    const float a = key(from, 1, k), b = key(to, 1, k);
    if (is_cubic) {
      const float u2 = u * u, u3 = u2 * u;
      out[k] = (2 * u3 - 3 * u2 + 1) * a + span * (u3 - 2 * u2 + u) * key(from, 2, k) + (3 * u2 - 2 * u3) * b +
               span * (u3 - u2) * key(to, 0, k);
    } else {
      out[k] = (1 - u) * a + u * toward * b;
    }
  }
  if (width == 4) normalize(out);
  return out;
}

// A matrix without shear, taken apart.
spherechain::Transform transform_of(const std::vector<float>& m) {
  const auto column = [&](std::size_t i) { return spherechain::Vec3{m[4 * i], m[4 * i + 1], m[4 * i + 2]}; };
  spherechain::Vec3 x = column(0), y = column(1), z = column(2);
  const auto divide = [](spherechain::Vec3& v, float by) { v = {v.x / by, v.y / by, v.z / by}; };
  const auto length = [](const spherechain::Vec3& v) { return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z); };
  const float volume = x.x * (y.y * z.z - y.z * z.y) + x.y * (y.z * z.x - y.x * z.z) + x.z * (y.x * z.y - y.y * z.x);
  const spherechain::Vec3 scale{std::copysign(length(x), volume), length(y), length(z)};
  divide(x, scale.x), divide(y, scale.y), divide(z, scale.z);
  // The largest of a quaternion's entries, and the others from it.
  std::vector<float> q;
  if (x.x + y.y + z.z > 0) {
    q = {y.z - z.y, z.x - x.z, x.y - y.x, 1 + x.x + y.y + z.z};
  } else if (x.x >= y.y && x.x >= z.z) {
    q = {1 + x.x - y.y - z.z, y.x + x.y, z.x + x.z, y.z - z.y};
  } else if (y.y >= z.z) {
    q = {y.x + x.y, 1 - x.x + y.y - z.z, z.y + y.z, z.x - x.z};
  } else {
    q = {z.x + x.z, z.y + y.z, 1 - x.x - y.y + z.z, x.y - y.x};
  }
  normalize(q);
  return {{m[12], m[13], m[14]}, {q[0], q[1], q[2], q[3]}, scale};
}

tinygltf::Model load(const std::string& path) {
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader([](tinygltf::Image*, int, std::string*, std::string*, int, int, const unsigned char*, int,
                           void*) { return true; },
                        nullptr);
  tinygltf::Model model;
  std::string error, warning;
  const bool is_binary = path.size() >= 4 && path.compare(path.size() - 4, 4, ".glb") == 0;
  if (!(is_binary ? loader.LoadBinaryFromFile(&model, &error, &warning, path)
                  : loader.LoadASCIIFromFile(&model, &error, &warning, path))) {
    throw std::runtime_error("is no glTF file");
  }
  return model;
}

std::size_t at(int index) { return static_cast<std::size_t>(index); }

}  // namespace

std::vector<char> read_file(const char* path) {
  std::ifstream file(path, std::ios::binary);
  std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
  if (bytes.empty()) {
    throw std::runtime_error(std::string(path) + ": cannot be read");
  }
  return bytes;
}

GltfCharacter::GltfCharacter(const char* path) try {
  const tinygltf::Model model = load(path);
  for (const tinygltf::Node& in : model.nodes) {
    nodes_.push_back({in.name, -1, floats(in.translation, {0, 0, 0}), floats(in.rotation, {0, 0, 0, 1}),
                      floats(in.scale, {1, 1, 1}), floats(in.matrix, {})});
  }
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    for (const int child : model.nodes[i].children) nodes_.at(at(child)).parent = static_cast<int>(i);
  }
  std::vector<std::size_t> first_joint;
  for (const tinygltf::Skin& skin : model.skins) {
    first_joint.push_back(joints_.size());
    const std::vector<float> matrices = read_accessor(model, skin.inverseBindMatrices, 16);
    for (std::size_t j = 0; j < skin.joints.size(); ++j) {
      joints_.push_back({at(skin.joints[j]), {}});
      std::copy_n(&matrices.at(16 * j), 16, joints_.back().inverse_bind.begin());
    }
  }
  if (joints_.empty()) {
    throw std::runtime_error("has no skin");
  }
  for (const tinygltf::Animation& in : model.animations) {
    Clip clip{in.name, 0, {}};
    for (const tinygltf::AnimationChannel& channel : in.channels) {
      const bool turns = channel.target_path == "rotation", scales = channel.target_path == "scale";
      if (channel.target_node < 0 || channel.target_path == "weights") continue;
      const tinygltf::AnimationSampler& sampler = in.samplers.at(at(channel.sampler));
      clip.channels.push_back({at(channel.target_node),
                               turns    ? &Node::rotation
                               : scales ? &Node::scale
                                        : &Node::translation,
                               sampler.interpolation, read_accessor(model, sampler.input, 1),
                               read_accessor(model, sampler.output, turns ? 4 : 3)});
      clip.duration = std::max(clip.duration, double{clip.channels.back().times.back()});
    }
    clips_.push_back(clip);
  }
  for (const tinygltf::Node& node : model.nodes) {
    if (node.skin < 0 || node.mesh < 0) continue;
    const std::vector<tinygltf::Primitive>& primitives = model.meshes.at(at(node.mesh)).primitives;
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      const auto& attributes = primitives[i].attributes;
      primitives_.push_back(
          {at(node.mesh), i, first_joint.at(at(node.skin)), read_accessor(model, attributes.at("POSITION"), 3),
           read_accessor(model, attributes.at("JOINTS_0"), 4), read_accessor(model, attributes.at("WEIGHTS_0"), 4)});
    }
  }
} catch (const std::exception& error) {
  throw std::runtime_error(std::string(path) + ": " + error.what());
}

std::vector<spherechain::Bone> GltfCharacter::joints() const {
  std::vector<spherechain::Bone> out;
  for (const Joint& joint : joints_) out.push_back({nodes_[joint.node].name.c_str(), joint.inverse_bind.data()});
  return out;
}

Matrix GltfCharacter::world(const std::vector<Node>& nodes, std::size_t node) const {
  const Node& n = nodes[node];
  Matrix local;
  if (n.matrix.size() == 16) {
    std::copy(n.matrix.begin(), n.matrix.end(), local.begin());
  } else {
    local = matrix_of(n.translation, n.rotation, n.scale);
  }
  return n.parent < 0 ? local : product(world(nodes, at(n.parent)), local);
}

std::vector<GltfCharacter::Node> GltfCharacter::nodes_at(std::size_t clip, double seconds) const {
  std::vector<Node> nodes = nodes_;
  for (const Channel& channel : clips_.at(clip).channels) {
    nodes.at(channel.node).*channel.target =
        sample(channel.times, channel.values, channel.interpolation, static_cast<float>(seconds));
  }
  return nodes;
}

Palette GltfCharacter::palette(std::size_t clip, double seconds) const { return palette_of(nodes_at(clip, seconds)); }

Palette GltfCharacter::palette_of(const std::vector<Node>& nodes) const {
  Palette palette;
  for (const Joint& joint : joints_) palette.push_back(product(world(nodes, joint.node), joint.inverse_bind));
  return palette;
}

std::vector<std::size_t> GltfCharacter::nodes_of_locals() const {
  std::vector<std::size_t> out;
  for (const Joint& joint : joints_) out.push_back(joint.node);
  for (std::size_t node = 0; node < nodes_.size(); ++node) {
    if (std::find(out.begin(), out.end(), node) == out.end()) out.push_back(node);
  }
  return out;
}

std::vector<std::uint32_t> GltfCharacter::parents() const {
  const std::vector<std::size_t> nodes = nodes_of_locals();
  const auto first_of = [&](std::size_t node) {
    return static_cast<std::uint32_t>(std::find(nodes.begin(), nodes.end(), node) - nodes.begin());
  };
  std::vector<std::uint32_t> out;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const std::uint32_t first = first_of(nodes[i]);
    const int parent = nodes_[nodes[i]].parent;
    // A joint of several skins hangs on the first of them.
    out.push_back(first != i ? first : parent < 0 ? SC_NO_JOINT : first_of(at(parent)));
  }
  return out;
}

std::vector<spherechain::Transform> GltfCharacter::locals(std::size_t clip, double seconds) const {
  const std::vector<Node> nodes = nodes_at(clip, seconds);
  std::vector<bool> is_listed(nodes.size());
  std::vector<spherechain::Transform> out;
  for (const std::size_t node : nodes_of_locals()) {
    const Node& n = nodes[node];
    if (is_listed[node]) {
      out.push_back({{0, 0, 0}, {0, 0, 0, 1}, {1, 1, 1}});
    } else if (n.matrix.size() == 16) {
      out.push_back(transform_of(n.matrix));
    } else {
      out.push_back({{n.translation[0], n.translation[1], n.translation[2]},
                     {n.rotation[0], n.rotation[1], n.rotation[2], n.rotation[3]},
                     {n.scale[0], n.scale[1], n.scale[2]}});
    }
    is_listed[node] = true;
  }
  return out;
}

Palette GltfCharacter::palette(const std::vector<spherechain::Transform>& locals) const {
  const std::vector<std::size_t> order = nodes_of_locals();
  std::vector<Node> nodes = nodes_;
  for (std::size_t i = order.size(); i-- > 0;) {  // of a node that is listed twice, the first counts
    const spherechain::Transform& local = locals.at(i);
    Node& node = nodes[order[i]];
    node.translation = {local.translation.x, local.translation.y, local.translation.z};
    node.rotation = {std::begin(local.rotation), std::end(local.rotation)};
    node.scale = {local.scale.x, local.scale.y, local.scale.z};
    node.matrix.clear();
  }
  return palette_of(nodes);
}

const GltfCharacter::Primitive& GltfCharacter::find(std::size_t mesh, std::size_t primitive) const {
  for (const Primitive& p : primitives_) {
    if (p.mesh == mesh && p.index == primitive) return p;
  }
  throw std::runtime_error("no skinned primitive " + std::to_string(primitive) + " of mesh " + std::to_string(mesh));
}

const std::vector<float>& GltfCharacter::file_vertices(std::size_t mesh, std::size_t primitive) const {
  return find(mesh, primitive).positions;
}

std::vector<float> GltfCharacter::vertices(std::size_t mesh, std::size_t primitive, const Palette& palette) const {
  const Primitive& from = find(mesh, primitive);
  std::vector<float> out(from.positions.size());
  for (std::size_t v = 0; v < out.size() / 3; ++v) {
    const float* const p = &from.positions[3 * v];
    for (std::size_t k = 0; k < 4; ++k) {
      const float weight = from.weights.at(4 * v + k);
      const Matrix& m = palette.at(from.first_joint + static_cast<std::size_t>(from.joints.at(4 * v + k)));
      for (std::size_t row = 0; row < 3; ++row) {
        out[3 * v + row] += weight * (m[row] * p[0] + m[4 + row] * p[1] + m[8 + row] * p[2] + m[12 + row]);
      }
    }
  }
  return out;
}

}  // namespace samples

// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/gltf_primitive.h"

#include <algorithm>
#include <utility>

namespace spherechain::baker {
namespace {

constexpr int kByte = TINYGLTF_COMPONENT_TYPE_BYTE, kUnsignedByte = TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE,
              kShort = TINYGLTF_COMPONENT_TYPE_SHORT, kUnsignedShort = TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT,
              kUnsignedInt = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, kFloat = TINYGLTF_COMPONENT_TYPE_FLOAT;

// Integers as KHR_mesh_quantization has them.
std::vector<Vec3> read_vectors(const GltfFile& file, int accessor) {
  const std::vector<double> numbers =
      file.numbers(accessor, TINYGLTF_TYPE_VEC3, {kFloat, kByte, kUnsignedByte, kShort, kUnsignedShort});
  std::vector<Vec3> out;
  out.reserve(numbers.size() / 3);
  for (std::size_t i = 0; i < numbers.size(); i += 3) out.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
  return out;
}

const tinygltf::Accessor& accessor_of(const GltfFile& file, int index) {
  return file.model.accessors[static_cast<std::size_t>(index)];
}

void check_count(const GltfFile& file, std::size_t count, std::size_t vertex_count, const std::string& what) {
  if (count != vertex_count) {
    file.fail(what + " is for " + std::to_string(count) + " vertices of " + std::to_string(vertex_count));
  }
}

// One vertex's weights while they are gathered: the largest, one a bone.
class Gathered {
 public:
  void add(Index bone, double weight) {
    const auto end = entries_.begin() + static_cast<std::ptrdiff_t>(size_);
    const auto known = std::find_if(entries_.begin(), end, [&](const auto& entry) { return entry.second == bone; });
    if (known != end) {
      known->first += weight;
    } else if (size_ < kMaxInfluences) {
      entries_[size_++] = {weight, bone};
    } else if (const auto least = std::min_element(entries_.begin(), end); least->first < weight) {
      *least = {weight, bone};
    }
  }

  VertexWeights normalized(Index fallback) {
    if (size_ == 0) entries_[size_++] = {1.0, fallback};
    std::stable_sort(entries_.begin(), entries_.begin() + static_cast<std::ptrdiff_t>(size_),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    double sum = 0;
    for (std::size_t k = 0; k < size_; ++k) sum += entries_[k].first;
    VertexWeights out;
    for (std::size_t k = 0; k < size_; ++k) {
      out.joint[k] = entries_[k].second;
      out.weight[k] = entries_[k].first / sum;
    }
    return out;
  }

 private:
  std::array<std::pair<double, Index>, kMaxInfluences> entries_;
  std::size_t size_ = 0;
};

}  // namespace

bool has_triangles(const tinygltf::Primitive& primitive) { return primitive.mode >= TINYGLTF_MODE_TRIANGLES; }

std::size_t count_points_and_lines(const GltfFile& file, const tinygltf::Primitive& primitive) {
  const auto position = primitive.attributes.find("POSITION");
  if (primitive.indices < 0 && position == primitive.attributes.end()) return 0;
  const std::size_t n = accessor_of(file, primitive.indices >= 0 ? primitive.indices : position->second).count;
  if (primitive.mode == TINYGLTF_MODE_LINE) return n / 2;
  return primitive.mode == TINYGLTF_MODE_LINE_STRIP && n > 0 ? n - 1 : n;
}

std::vector<Vec3> read_positions(const GltfFile& file, const tinygltf::Primitive& primitive, const std::string& where) {
  const int index = primitive.attributes.at("POSITION");
  const tinygltf::Accessor& accessor = accessor_of(file, index);
  if (accessor.bufferView < 0 && !accessor.sparse.isSparse) {
    const bool draco = primitive.extensions.count("KHR_draco_mesh_compression") > 0;
    file.fail(where + " has positions without data" +
              (draco ? " (KHR_draco_mesh_compression is not read: export without it)" : ""));
  }
  return read_vectors(file, index);
}

std::vector<Triangle> read_triangles(const GltfFile& file, const tinygltf::Primitive& primitive,
                                     std::size_t vertex_count, const std::string& where) {
  std::vector<Index> corners;
  if (primitive.indices < 0) {
    for (Index v = 0; v < vertex_count; ++v) corners.push_back(v);
  } else {
    for (const double v :
         file.numbers(primitive.indices, TINYGLTF_TYPE_SCALAR, {kUnsignedByte, kUnsignedShort, kUnsignedInt})) {
      if (v >= static_cast<double>(vertex_count)) {
        file.fail(where + " uses vertex " + std::to_string(static_cast<std::uint32_t>(v)) + " of " +
                  std::to_string(vertex_count));
      }
      corners.push_back(static_cast<Index>(v));
    }
  }
  std::vector<Triangle> triangles;
  if (primitive.mode == TINYGLTF_MODE_TRIANGLES) {
    for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
      triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
    }
  } else if (primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
    for (std::size_t i = 0; i + 2 < corners.size(); ++i) {
      triangles.push_back({corners[i], corners[i + 1 + i % 2], corners[i + 2 - i % 2]});
    }
  } else if (primitive.mode == TINYGLTF_MODE_TRIANGLE_FAN) {
    for (std::size_t i = 0; i + 2 < corners.size(); ++i) {
      triangles.push_back({corners[i + 1], corners[i + 2], corners[0]});
    }
  } else {
    file.fail(where + ".mode is " + std::to_string(primitive.mode) + ", which glTF does not know");
  }
  return triangles;
}

bool is_skinned(const tinygltf::Primitive& primitive) {
  return primitive.attributes.count("JOINTS_0") > 0 && primitive.attributes.count("WEIGHTS_0") > 0;
}

std::vector<VertexWeights> read_weights(const GltfFile& file, const tinygltf::Primitive& primitive,
                                        const std::vector<Index>& bones, std::size_t vertex_count,
                                        const std::string& where) {
  std::vector<Gathered> gathered(vertex_count);
  std::vector<Index> first(vertex_count, bones.front());
  for (std::size_t set = 0;; ++set) {
    const auto joints_at = primitive.attributes.find("JOINTS_" + std::to_string(set)),
               weights_at = primitive.attributes.find("WEIGHTS_" + std::to_string(set));
    if (joints_at == primitive.attributes.end() || weights_at == primitive.attributes.end()) break;
    const std::vector<double> joints =
        file.numbers(joints_at->second, TINYGLTF_TYPE_VEC4, {kUnsignedByte, kUnsignedShort});
    const std::vector<double> weights =
        file.numbers(weights_at->second, TINYGLTF_TYPE_VEC4, {kFloat, kUnsignedByte, kUnsignedShort});
    check_count(file, joints.size() / 4, vertex_count, where + "." + joints_at->first);
    check_count(file, weights.size() / 4, vertex_count, where + "." + weights_at->first);
    for (std::size_t i = 0; i < joints.size(); ++i) {
      const auto joint = static_cast<std::size_t>(joints[i]);
      const bool exists = joint < bones.size();
      if (set == 0 && i % 4 == 0 && exists) first[i / 4] = bones[joint];
      if (weights[i] <= 0) continue;
      if (!exists) {
        file.fail(where + ": vertex " + std::to_string(i / 4) + " follows joint " + std::to_string(joint) + " of " +
                  std::to_string(bones.size()));
      }
      gathered[i / 4].add(bones[joint], weights[i]);
    }
  }
  std::vector<VertexWeights> out;
  out.reserve(vertex_count);
  for (std::size_t v = 0; v < vertex_count; ++v) out.push_back(gathered[v].normalized(first[v]));
  return out;
}

std::vector<Vec3> read_displacements(const GltfFile& file, const std::map<std::string, int>& target,
                                     std::size_t vertex_count, const std::string& where) {
  const auto position = target.find("POSITION");
  if (position == target.end()) return {};
  std::vector<Vec3> out = read_vectors(file, position->second);
  check_count(file, out.size(), vertex_count, where + ".POSITION");
  return out;
}

}  // namespace spherechain::baker

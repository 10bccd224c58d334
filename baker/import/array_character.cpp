// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/array_character.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "baker/mesh/error.h"
#include "spherechain/asset.h"

namespace spherechain::baker {
namespace {

// R2ET's files do not name the parents of their 22 joints.
constexpr int kParents[] = {-1, 0, 1, 2, 3, 4, 0, 6, 7, 8, 0, 10, 11, 12, 3, 14, 15, 16, 3, 18, 19, 20};

class CharacterOfArrays {
 public:
  CharacterOfArrays(const Arrays& arrays, const std::string& file) : arrays_(arrays), file_(file) {}

  SourceMesh read() {
    add_nodes();
    add_skin(table("rest_vertices", 3), table("rest_faces", 3));
    add_weights(table("skinning_weights", out_.rig.nodes.size()));
    out_.importer = "numpy";
    out_.meshes = 1;
    out_.metres_per_unit = 0.01;
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw Error(ExitCode::kFile, file_ + ": " + what); }

  const Array* find(const char* name) const { return find_table(arrays_, name, file_); }
  // A row of numbers for each vertex, face or joint.
  const Array& table(const char* name, std::size_t width) const {
    const Array* out = find(name);
    if (out == nullptr) fail(fmt::format("has no '{}', as a character needs", name));
    if (out->shape.size() != 2 || out->shape[1] != width || !out->texts.empty())
      fail(fmt::format("'{}' is no table of rows of {} numbers", name, width));
    return *out;
  }
  static Vec3 row(const Array& table, std::size_t k) {
    return {table.numbers[3 * k], table.numbers[3 * k + 1], table.numbers[3 * k + 2]};
  }

  void add_nodes() {
    const Array& skeleton = table("skeleton", 3);
    const Array *names = find("joint_names"), *parents = find("parents");
    const std::size_t count = skeleton.shape[0];
    if (count == 0 || (parents == nullptr && count != std::size(kParents)))
      fail(fmt::format("'skeleton' has {} joints and there is no 'parents' (22 are known without)", count));
    if (parents != nullptr && parents->numbers.size() != count)
      fail("'parents' has no number for each joint of 'skeleton'");
    if (names != nullptr && names->texts.size() != count)
      fail("'joint_names' has no name for each joint of 'skeleton'");
    for (std::size_t j = 0; j < count; ++j) {
      const double parent = parents == nullptr ? kParents[j] : parents->numbers[j];
      if (!(parent >= -1 && parent < static_cast<double>(j)))
        fail(fmt::format("the parent of joint {} does not come before it", j));
      Node node;
      node.name = names == nullptr ? fmt::format("joint {}", j) : names->texts[j];
      node.parent = static_cast<int>(parent);
      node.in_file = static_cast<int>(j);
      node.translation = row(skeleton, j);
      node.local.translation() = node.translation;
      out_.rig.nodes.push_back(std::move(node));
    }
    // Vertices are measured from the root, whose place in the scene the skeleton has.
    out_.rig.to_rest.translation() = -out_.rig.nodes[0].translation;
    for (const Affine& world : world_of(out_.rig.nodes)) {
      out_.rig.bones.push_back({static_cast<Index>(out_.rig.bones.size()), (out_.rig.to_rest * world).inverse()});
    }
  }

  void add_skin(const Array& vertices, const Array& faces) {
    std::vector<float> packed;
    const std::size_t count = vertices.shape[0];
    for (std::size_t v = 0; v < count; ++v) {
      const Eigen::Vector3f place = row(vertices, v).cast<float>();
      out_.positions.push_back(place.cast<double>());
      packed.insert(packed.end(), place.begin(), place.end());
    }
    for (std::size_t f = 0; f < faces.shape[0]; ++f) {
      Triangle triangle;
      for (std::size_t k = 0; k < 3; ++k) {
        const double corner = faces.numbers[3 * f + k];
        if (!(corner >= 0 && corner < static_cast<double>(count)))
          fail(fmt::format("triangle {} uses vertex {} of {}", f, corner, count));
        triangle[k] = static_cast<Index>(corner);
      }
      out_.triangles.push_back(triangle);
    }
    const Array* subject = find("subject");
    out_.buffers.push_back({0, 0, 0, static_cast<Index>(count),
                            sc_hash_positions(packed.data(), count, 3 * sizeof(float)),
                            static_cast<Index>(out_.triangles.size()),
                            subject != nullptr && subject->texts.size() == 1 ? subject->texts[0] : "mesh"});
  }

  void add_weights(const Array& table) {
    const std::size_t joints = table.shape[1];
    if (table.shape[0] != out_.positions.size()) fail("'skinning_weights' has no row for each vertex");
    std::vector<Index> order(joints);
    for (std::size_t v = 0; v < table.shape[0]; ++v) {
      const double* weights = table.numbers.data() + v * joints;
      std::iota(order.begin(), order.end(), Index{0});
      std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return weights[a] > weights[b]; });
      VertexWeights of;
      double sum = 0;
      for (std::size_t k = 0; k < std::min(kMaxInfluences, joints) && weights[order[k]] > 0; ++k) {
        of.joint[k] = order[k];
        of.weight[k] = weights[order[k]];
        sum += of.weight[k];
      }
      for (double& weight : of.weight) weight /= sum > 0 ? sum : 1;
      out_.rig.weights.push_back(of);
    }
  }

  const Arrays& arrays_;
  const std::string& file_;
  SourceMesh out_;
};

}  // namespace

std::optional<SourceMesh> array_character(const Arrays& arrays, const std::string& file) {
  if (arrays.count("rest_vertices") == 0 || arrays.count("rest_faces") == 0) return std::nullopt;
  return CharacterOfArrays(arrays, file).read();
}

}  // namespace spherechain::baker

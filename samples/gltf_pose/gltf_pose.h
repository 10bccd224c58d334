// SPDX-License-Identifier: MIT
// Stands for a game's own animation system: reads a skinned glTF file and poses it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "spherechain/spherechain.h"

namespace samples {

using Matrix = std::array<float, 16>;  // column-major: SC_COLUMNS_4X4
using Palette = std::vector<Matrix>;   // the matrix of each joint: what a skinning shader gets

inline spherechain::Pose pose_of(const Palette& palette) {
  return {palette.empty() ? nullptr : palette[0].data(), palette.size(), SC_COLUMNS_4X4};
}

// The whole file. Throws std::runtime_error("PATH: cannot be read").
std::vector<char> read_file(const char* path);

class GltfCharacter {
 public:
  // Throws std::runtime_error that names the file and what is wrong.
  explicit GltfCharacter(const char* path);

  // The joints of all skins, with their inverse bind matrices. The pointers live as long as the character.
  std::vector<spherechain::Bone> joints() const;

  std::size_t clip_count() const { return clips_.size(); }
  const std::string& clip_name(std::size_t clip) const { return clips_.at(clip).name; }
  double duration(std::size_t clip) const { return clips_.at(clip).duration; }
  // Frames at that rate. Files round times: an end that is this near to a frame is one.
  int frame_count(std::size_t clip, double fps) const { return 1 + static_cast<int>(fps * duration(clip) + 0.05); }

  // World matrix times inverse bind matrix of each joint, in the order of joints(). Morph targets are not read.
  Palette palette(std::size_t clip, double seconds) const;
  // The same where no clip plays. In most files this is the bind pose.
  Palette rest_palette() const { return palette_of(nodes_); }

  // For code that moves joints after the clip did: where each joint is in its parent's space, in the order of joints().
  // The file's other nodes come after them, for they carry joints, too.
  std::vector<spherechain::Transform> locals(std::size_t clip, double seconds) const;
  std::vector<std::uint32_t> parents() const;  // of each of them; SC_NO_JOINT: none
  Palette palette(const std::vector<spherechain::Transform>& locals) const;

  // The vertices of a mesh's primitive, x y z: as the file has them, and in a pose. It is what an engine that skins on
  // the CPU has. Throw std::runtime_error where there is no such primitive.
  const std::vector<float>& file_vertices(std::size_t mesh, std::size_t primitive) const;
  std::vector<float> vertices(std::size_t mesh, std::size_t primitive, const Palette& palette) const;

 private:
  struct Node {
    std::string name;
    int parent = -1;
    std::vector<float> translation, rotation, scale;  // 3, 4, 3
    std::vector<float> matrix;                        // 16, or none: of the three above
  };
  struct Joint {
    std::size_t node;
    Matrix inverse_bind;
  };
  struct Channel {
    std::size_t node;
    std::vector<float> Node::*target;
    std::string interpolation;
    std::vector<float> times, values;
  };
  struct Clip {
    std::string name;
    double duration = 0;
    std::vector<Channel> channels;
  };
  struct Primitive {
    std::size_t mesh, index, first_joint;
    std::vector<float> positions, joints, weights;  // 3, 4, 4 a vertex
  };

  const Primitive& find(std::size_t mesh, std::size_t primitive) const;
  std::vector<Node> nodes_at(std::size_t clip, double seconds) const;
  Palette palette_of(const std::vector<Node>& nodes) const;
  std::vector<std::size_t> nodes_of_locals() const;
  Matrix world(const std::vector<Node>& nodes, std::size_t node) const;

  std::vector<Node> nodes_;
  std::vector<Joint> joints_;
  std::vector<Clip> clips_;
  std::vector<Primitive> primitives_;
};

}  // namespace samples

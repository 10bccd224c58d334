// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <string>
#include <vector>

#include "mesh/mesh.h"

namespace spherechain::baker {

using Affine = Eigen::AffineCompact3d;

// Linear blend skinning of one vertex: the largest weights first, unused entries zero. They sum to 1, or are all zero
// where nothing moves the vertex.
inline constexpr std::size_t kMaxInfluences = 8;
struct VertexWeights {
  std::array<Index, kMaxInfluences> joint{};
  std::array<double, kMaxInfluences> weight{};
};

// A node of the file's scene at rest. `local` is what holds while nothing animates it; a channel replaces one of the
// three parts, and then translation * rotation * scale holds.
struct Node {
  std::string name;
  int parent = -1;  // before its children
  Affine local = Affine::Identity();
  Vec3 translation = Vec3::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Vec3 scale = Vec3::Ones();
};

// Translation, rotation and scale of `local`; what it shears is lost to them.
void decompose(Node& node);

// What vertex weights refer to. A vertex v of the rest pose moves to  to_rest * world(node) * inverse_bind * v.
struct Bone {
  Index node;
  Affine inverse_bind;
};

// A morph target: displacements of the rest positions.
struct Morph {
  std::string name;
  std::vector<Index> vertices;  // source vertices
  std::vector<Vec3> deltas;
  double rest_weight = 0;
};

enum class ChannelPath { kTranslation, kRotation, kScale, kMorphWeight };
enum class Interpolation { kStep, kLinear, kCubicSpline };

// One animated property: 3 numbers a key for translation and scale, 4 for rotation (x y z w), 1 for a morph's weight;
// with cubic splines three times as many (in-tangent, value, out-tangent). Times ascend, in seconds.
struct Channel {
  ChannelPath path;
  Index target;  // a node, or a morph
  Interpolation interpolation = Interpolation::kLinear;
  std::vector<double> times, values;
};

// A channel's value at a time, held before its first and after its last key: 3 numbers, 4 (a unit quaternion, x y z w)
// or 1, as its path says; the rest are 0.
Eigen::Vector4d sample(const Channel& channel, double seconds);

struct Clip {
  std::string name;
  double duration = 0;  // seconds, of the last key
  std::vector<Channel> channels;
};

// The skeleton, skin and motion a file brings along; all empty where it brings none.
struct SourceRig {
  std::vector<Node> nodes;
  std::vector<Bone> bones;
  std::vector<VertexWeights> weights;  // of every source vertex; empty where there are no bones
  std::vector<Morph> morphs;
  std::vector<Clip> clips;
  Affine to_rest = Affine::Identity();  // from the scene's axes and units to those of the rest positions
};

// Every node's transform into the scene.
std::vector<Affine> world_of(const std::vector<Node>& nodes);

}  // namespace spherechain::baker

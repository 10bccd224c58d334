// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "baker/import/robot_rig.h"
#include "baker/mesh/mesh.h"

namespace spherechain::baker {

using Affine = Eigen::AffineCompact3d;

// One vertex's weights for linear blend skinning, the largest first, unused entries zero. They add up to 1, or are all
// zero where nothing moves the vertex.
inline constexpr std::size_t kMaxInfluences = 8;
struct VertexWeights {
  std::array<Index, kMaxInfluences> joint{};
  std::array<double, kMaxInfluences> weight{};
};

// A node of the file's scene at rest. `local` is its transform while nothing animates it. A channel replaces one of the
// three parts; then the transform is translation * rotation * scale.
struct Node {
  std::string name;
  std::string humanoid_bone{};  // what a VRM avatar says it is, such as "leftUpperArm"; empty where it says nothing
  bool is_attachment = false;   // carries a rigid mesh, and hangs on a joint: a weapon, a hat
  int parent = -1;              // comes before its children
  int in_file = -1;             // its number in the file, or in what read_as_glb() makes of it
  std::int64_t fbx_id = 0;      // of its model in an FBX file
  Affine local = Affine::Identity();
  Vec3 translation = Vec3::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Vec3 scale = Vec3::Ones();
};

// Sets translation, rotation and scale from `local`. Shear is lost.
void decompose(Node& node);

// A bone, which vertex weights refer to. It moves a vertex v of the rest pose to
// to_rest * world(node) * inverse_bind * v.
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

// A channel's value at a time: 3 numbers, 4 (a unit quaternion, x y z w) or 1, by its path; the rest are 0. Before the
// first key it has the first value, after the last key the last.
Eigen::Vector4d sample(const Channel& channel, double seconds);

struct Clip {
  std::string name;
  double duration = 0;  // seconds, of the last key
  std::vector<Channel> channels;
  int in_file = -1;         // its number in the file, or in what read_as_glb() makes of it
  std::int64_t fbx_id = 0;  // of its stack in an FBX file
};

// A file's skeleton, skin and motion; all empty where it has none.
struct SourceRig {
  std::vector<Node> nodes;
  std::vector<Bone> bones;
  std::vector<VertexWeights> weights;  // of every source vertex; empty where there are no bones
  std::vector<Morph> morphs;
  std::vector<Clip> clips;
  Affine to_rest = Affine::Identity();  // from the scene's axes and units to those of the rest positions
  std::vector<Vec3> pivots;             // of all nodes; empty where joints turn where they are bound (pivots.h)
  bool are_pivots_from_skin = false;    // the file does not say where its joints turn
  RobotRig robot{};
};

// Which of the maps that a skin's bones are at rest holds for most of it: the one nearest to the median of all, entry
// by entry, each with the weight of the skin it moves. The first of several maps that are alike is chosen. A bone that
// was bound in other units or axes than the others does not decide. All maps are finite, and there is one at least.
std::size_t typical_map(const std::vector<Affine>& maps, const std::vector<double>& weights);

// Every node's transform into the scene.
std::vector<Affine> world_of(const std::vector<Node>& nodes);

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#include "fix/joints.h"

#include <algorithm>
#include <map>

namespace spherechain::baker {
namespace {

std::string without_side(const std::string& role) {
  for (const char* side : {"left_", "right_"}) {
    if (role.starts_with(side)) return role.substr(std::string(side).size());
  }
  return role;
}

std::string role_of(const Roles& roles, Index node) {
  return node < roles.of_node.size() ? without_side(roles.of_node[node].role) : "";
}

// What a radian costs. Joints near the trunk carry more with them.
double price_of(const std::string& role) {
  static const std::map<std::string, double> kPrices{{"shoulder", 1}, {"elbow", 1}, {"wrist", 2},  {"clavicle", 4},
                                                     {"neck", 6},     {"head", 6},  {"spine", 60}, {"chest", 60},
                                                     {"hip", 12},     {"knee", 12}, {"ankle", 25}, {"limb", 1}};
  if (role.starts_with("tail")) return 1;
  const auto found = kPrices.find(role);
  return found == kPrices.end() ? 0 : found->second;
}

// In a joint's own axes: across its two bones, as the clip bends it, and along the lower one. Dear is what is neither,
// and a little what twists. The identity where there is no such axis.
Eigen::Matrix3d hinge(const SourceRig& rig, const Clip& clip, Index node) {
  constexpr double kOff = 30, kTwist = 4;
  constexpr int kLooks = 100;
  const Eigen::Matrix3d none = Eigen::Matrix3d::Identity();
  const auto child = std::find_if(rig.nodes.begin(), rig.nodes.end(),
                                  [&](const Node& n) { return n.parent == static_cast<int>(node); });
  if (child == rig.nodes.end()) return none;
  const double upper_length = rig.nodes[node].translation.norm(), lower_length = child->translation.norm();
  if (upper_length == 0 || lower_length == 0) return none;
  const Vec3 lower = child->translation / lower_length;
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i <= kLooks; ++i) {
    Eigen::Quaterniond rotation = rig.nodes[node].rotation;
    for (const Channel& channel : clip.channels) {
      if (channel.path != ChannelPath::kRotation || channel.target != node) continue;
      rotation = Eigen::Quaterniond(sample(channel, clip.duration * i / kLooks));
    }
    const Vec3 axis = (rotation.inverse() * rig.nodes[node].translation / upper_length).cross(lower);
    sum += sum.dot(axis) < 0 ? Vec3(-axis) : axis;
  }
  if (sum.norm() < 1e-3) return none;
  const Vec3 axis = sum.normalized();
  return kOff * none - (kOff - 1) * axis * axis.transpose() - (kOff - kTwist) * lower * lower.transpose();
}

bool is_below(const SourceRig& rig, Index node, Index other) {
  int n = static_cast<int>(node);
  while (n >= 0 && n != static_cast<int>(other)) n = rig.nodes[static_cast<std::size_t>(n)].parent;
  return n >= 0;
}

}  // namespace

std::vector<TurningJoint> turning_joints(const SourceRig& rig, const Roles& roles, const Clip& clip) {
  std::vector<TurningJoint> out;
  for (Index n = 0; n < rig.nodes.size(); ++n) {
    const std::string role = role_of(roles, n);
    const double price = price_of(role);
    if (price == 0) continue;
    const bool is_hinge = role == "elbow" || role == "knee";
    out.push_back({n, price * (is_hinge ? hinge(rig, clip, n) : Eigen::Matrix3d::Identity())});
  }
  if (!out.empty()) return out;
  for (const Bone& bone : rig.bones) {
    const auto carries = [&](const Bone& other) { return is_below(rig, other.node, bone.node); };
    const auto is_it = [&](const TurningJoint& joint) { return joint.node == bone.node; };
    if (std::all_of(rig.bones.begin(), rig.bones.end(), carries)) continue;
    if (std::none_of(out.begin(), out.end(), is_it)) out.push_back({bone.node});
  }
  return out;
}

std::vector<Index> joints_of_role(const std::vector<TurningJoint>& joints, const Roles& roles,
                                  const std::string& role) {
  std::vector<Index> out;
  for (Index j = 0; j < joints.size(); ++j) {
    if (role_of(roles, joints[j].node) == role) out.push_back(j);
  }
  return out;
}

}  // namespace spherechain::baker

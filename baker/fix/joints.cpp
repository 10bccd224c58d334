// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/joints.h"

#include <algorithm>
#include <map>
#include <set>

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

// Cost of a radian. Joints near the trunk carry more, so they cost more.
double role_cost(const std::string& role) {
  static const std::map<std::string, double> kCosts{{"shoulder", 1}, {"elbow", 1}, {"wrist", 2},  {"clavicle", 4},
                                                    {"neck", 6},     {"head", 6},  {"spine", 60}, {"chest", 60},
                                                    {"hip", 12},     {"knee", 12}, {"ankle", 25}, {"limb", 1}};
  if (role.starts_with("tail")) return 1;
  const auto found = kCosts.find(role);
  return found == kCosts.end() ? 0 : found->second;
}

constexpr double kDegree = 3.14159265358979323846 / 180;
constexpr double kBendMax = 150 * kDegree;

// The hinge between two bones: its axis from the clip's bends, its range from straight to the larger of 150 degrees and
// the clip's largest bend. Empty if there is no such axis.
std::optional<Hinge> hinge_of(const SourceRig& rig, const Clip& clip, Index node) {
  constexpr int kLooks = 100;
  const auto child = std::find_if(rig.nodes.begin(), rig.nodes.end(),
                                  [&](const Node& n) { return n.parent == static_cast<int>(node); });
  if (child == rig.nodes.end()) return {};
  Hinge out;
  if (rig.nodes[node].translation.norm() == 0 || child->translation.norm() == 0) return {};
  out.upper = rig.nodes[node].translation.normalized();
  out.lower = child->translation.normalized();
  Vec3 sum = Vec3::Zero();
  std::vector<Eigen::Quaterniond> rotations;
  for (int i = 0; i <= kLooks; ++i) {
    rotations.push_back(rotation_at(rig, clip, node, clip.duration * i / kLooks));
    const Vec3 axis = (rotations.back().inverse() * out.upper).cross(out.lower);
    sum += sum.dot(axis) < 0 ? Vec3(-axis) : axis;
  }
  if (sum.norm() < 1e-3) return {};
  out.axis = sum.normalized();
  out.max_bend = kBendMax;
  for (const Eigen::Quaterniond& rotation : rotations) {
    out.min_bend = std::min(out.min_bend, out.bend(rotation));
    out.max_bend = std::max(out.max_bend, out.bend(rotation));
  }
  return out;
}

// Turning off the hinge's axis is expensive; twisting is slightly so.
Eigen::Matrix3d hinge_cost(const Hinge& hinge) {
  constexpr double kOff = 30, kTwist = 4;
  return kOff * Eigen::Matrix3d::Identity() - (kOff - 1) * hinge.axis * hinge.axis.transpose() -
         (kOff - kTwist) * hinge.lower * hinge.lower.transpose();
}

// The number of bones at each node or below.
std::vector<std::size_t> bones_below(const SourceRig& rig) {
  std::vector<std::size_t> out(rig.nodes.size(), 0);
  for (const Bone& bone : rig.bones) ++out[bone.node];
  for (std::size_t n = out.size(); n-- > 0;) {  // children come after their parents
    if (const int parent = rig.nodes[n].parent; parent >= 0) out[static_cast<std::size_t>(parent)] += out[n];
  }
  return out;
}

}  // namespace

std::vector<TurningJoint> turning_joints(const SourceRig& rig, const Roles& roles, const Clip& clip) {
  std::vector<TurningJoint> out;
  for (Index n = 0; n < rig.nodes.size(); ++n) {
    const std::string role = role_of(roles, n);
    const double cost = role_cost(role);
    if (cost == 0) continue;
    const bool is_hinge = role == "elbow" || role == "knee";
    const std::optional<Hinge> hinge = is_hinge ? hinge_of(rig, clip, n) : std::nullopt;
    out.push_back({n, cost * (hinge ? hinge_cost(*hinge) : Eigen::Matrix3d::Identity()), hinge});
  }
  if (!out.empty()) return out;
  const std::vector<std::size_t> carried = bones_below(rig);
  std::set<Index> taken;
  for (const Bone& bone : rig.bones) {
    if (carried[bone.node] == rig.bones.size() || !taken.insert(bone.node).second) continue;
    out.push_back({bone.node, Eigen::Matrix3d::Identity(), {}});
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

// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/motion/role_joints.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <optional>

namespace spherechain::baker {
namespace {

constexpr std::array kTrunk{"pelvis", "spine", "chest", "neck", "head"};
constexpr std::array kArm{"clavicle", "shoulder", "elbow", "wrist"};
constexpr std::array kLeg{"hip", "knee", "ankle", "toe"};

// The role a bone of this role ends at; empty where a body has none there; nothing where it is no body's role.
std::optional<std::string> next_role(const std::string& role) {
  const auto in = [](const auto& chain, const std::string& side,
                     const std::string& name) -> std::optional<std::string> {
    for (std::size_t i = 0; i < chain.size(); ++i) {
      if (chain[i] == name) return i + 1 < chain.size() ? side + chain[i + 1] : std::string();
    }
    return std::nullopt;
  };
  for (const std::string side : {"left_", "right_"}) {
    if (role.rfind(side, 0) != 0) continue;
    const std::string name = role.substr(side.size());
    if (name == "ankle") return "";  // a foot goes to the tip of its toes
    const auto arm = in(kArm, side, name);
    return arm ? arm : in(kLeg, side, name);
  }
  return in(kTrunk, "", role);
}

}  // namespace

int RoleJoints::find(const std::string& role) const {
  const auto found = std::find_if(joints.begin(), joints.end(), [&](const Joint& j) { return j.name == role; });
  return found == joints.end() ? -1 : static_cast<int>(found - joints.begin());
}

RoleJoints joints_by_role(const std::vector<Node>& nodes, const std::vector<std::string>& roles,
                          const std::vector<Vec3>& positions) {
  RoleJoints out;
  out.joint_of_node.assign(nodes.size(), 0);
  std::vector<int> above(nodes.size(), -1);  // the nearest joint at or above
  for (Index n = 0; n < nodes.size(); ++n) {
    if (nodes[n].parent >= 0) above[n] = above[static_cast<std::size_t>(nodes[n].parent)];
    if (next_role(roles[n])) {
      const int parent = out.joints.empty() ? -1 : std::max(above[n], 0);
      out.joints.push_back({roles[n], parent, positions[n], positions[n]});
      out.node.push_back(n);
      above[n] = static_cast<int>(out.joints.size()) - 1;
    }
    out.joint_of_node[n] = static_cast<Index>(std::max(above[n], 0));
  }
  for (std::size_t j = 0; j < out.joints.size(); ++j) {
    Joint& joint = out.joints[j];
    const std::string next = *next_role(joint.name);
    if (const int end = next.empty() ? -1 : out.find(next); end >= 0) {
      joint.tail = out.joints[static_cast<std::size_t>(end)].position;
      continue;
    }
    std::vector<bool> under(nodes.size(), false);
    under[out.node[j]] = true;
    for (Index n = out.node[j] + 1; n < nodes.size(); ++n) {
      under[n] = nodes[n].parent >= 0 && under[static_cast<std::size_t>(nodes[n].parent)];
      const double farther = (positions[n] - joint.position).norm() - (joint.tail - joint.position).norm();
      if (under[n] && farther > 0) joint.tail = positions[n];
    }
  }
  return out;
}

RoleJoints joints_by_role(std::vector<Joint> joints) {
  RoleJoints out;
  out.node.resize(joints.size());
  std::iota(out.node.begin(), out.node.end(), Index{0});
  out.joint_of_node = out.node;
  out.joints = std::move(joints);
  return out;
}

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/play/posable.h"

#include <algorithm>
#include <cmath>

#include "baker/roles/roles.h"

namespace spherechain::baker {
namespace {

bool moves_bones_of_asset(const AnimatedAsset& animated) {
  const std::vector<std::string>& names = animated.bone_names();
  const AssetView& asset = animated.asset().view();
  if (names.empty() || asset.bone_count() < names.size()) return false;
  for (std::size_t b = 0; b < names.size(); ++b) {
    if (asset.bone(b).name != names[b]) return false;
  }
  return true;
}

std::string words(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

int joint_of(const std::vector<std::string>& role_of_joint, const std::string& role) {
  const auto found = std::find(role_of_joint.begin(), role_of_joint.end(), role);
  return found == role_of_joint.end() ? -1 : static_cast<int>(found - role_of_joint.begin());
}

bool is_at_or_below(const std::vector<Joint>& joints, int joint, int top) {
  while (joint >= 0 && joint != top) joint = joints[static_cast<std::size_t>(joint)].parent;
  return joint == top;
}

// By role, as the joints of the automatic rig are named.
void add_limbs_by_role(PosableRig& out, const std::vector<std::string>& role_of_joint) {
  for (const std::string side : {"left", "right"}) {
    const auto add = [&](const char* upper, const char* middle, const char* end, const char* end_name, bool stands) {
      PosableLimb limb{side + " " + end_name,
                       side + " " + middle,
                       joint_of(role_of_joint, side + "_" + upper),
                       joint_of(role_of_joint, side + "_" + middle),
                       joint_of(role_of_joint, side + "_" + end),
                       Vec3::Zero(),
                       stands};
      if (limb.upper < 0 || limb.middle < 0 || limb.end < 0) return;
      limb.tip = out.joints[static_cast<std::size_t>(limb.end)].position;
      out.limbs.push_back(limb);
    };
    add("shoulder", "elbow", "wrist", "hand", false);
    add("hip", "knee", "ankle", "foot", true);
  }
}

// A limb that is neither arm nor leg of a biped bends at the joint that is nearest to half its length.
void add_limb(PosableRig& out, const RoleLimb& limb, bool has_feet, const std::vector<int>& joint_of_node,
              const std::vector<Vec3>& positions) {
  std::vector<int> nodes;  // those with a joint that hangs on the one before; a rig's helpers may hang elsewhere
  for (const int n : limb.nodes) {
    const int joint = joint_of_node[static_cast<std::size_t>(n)];
    if (joint < 0) continue;
    if (nodes.empty() || is_at_or_below(out.joints, joint, joint_of_node[static_cast<std::size_t>(nodes.back())]))
      nodes.push_back(n);
  }
  if (nodes.size() < 2) return;
  const auto at = [&](int node) { return positions[static_cast<std::size_t>(node)]; };
  const auto joint = [&](int node) { return joint_of_node[static_cast<std::size_t>(node)]; };
  // Nodes past the last joint say where the limb ends.
  const int tip =
      has_feet && limb.extremity > 0 ? limb.nodes[static_cast<std::size_t>(limb.extremity)] : limb.nodes.back();
  const bool is_joint = std::find(nodes.begin(), nodes.end(), tip) != nodes.end();
  double length = (at(tip) - at(nodes.back())).norm();
  for (std::size_t i = 1; i < nodes.size(); ++i) length += (at(nodes[i]) - at(nodes[i - 1])).norm();
  int middle = -1;
  double along = 0, best = HUGE_VAL;
  for (std::size_t i = 1; i < nodes.size() && nodes[i] != tip; ++i) {
    along += (at(nodes[i]) - at(nodes[i - 1])).norm();
    if (std::abs(along - length / 2) >= best) continue;
    best = std::abs(along - length / 2);
    middle = nodes[i];
  }
  if (middle < 0) return;
  const std::string name = words(limb.name);
  out.limbs.push_back({name, name + " bend", joint(nodes.front()), joint(middle),
                       is_joint ? joint(tip) : joint(nodes.back()), at(tip), name.find("leg") != std::string::npos});
}

// A body whose roles are not known, such as a hand: every chain of joints that leads to a tip is a limb.
void add_chains(PosableRig& out) {
  std::vector<int> children(out.joints.size(), 0);
  for (const Joint& joint : out.joints) {
    if (joint.parent >= 0) ++children[static_cast<std::size_t>(joint.parent)];
  }
  for (std::size_t tip = 0; tip < out.joints.size(); ++tip) {
    if (children[tip] > 0) continue;
    std::vector<int> chain{static_cast<int>(tip)};  // from the tip up
    for (int above = out.joints[tip].parent; above >= 0 && children[static_cast<std::size_t>(above)] == 1;
         above = out.joints[static_cast<std::size_t>(above)].parent) {
      chain.push_back(above);
    }
    if (chain.size() < 3) continue;
    const std::string& name = out.joints[tip].name;
    out.limbs.push_back(
        {name, name + " bend", chain.back(), chain[chain.size() / 2], chain.front(), out.joints[tip].position, false});
  }
}

// The middle of the box around the skin of the joints at and below one.
Vec3 center_of_skin(const AnimatedAsset& animated, const std::vector<Joint>& joints, int top) {
  Eigen::AlignedBox3d box;
  for (std::size_t v = 0; v < animated.weights().size(); ++v) {
    const VertexWeights& weights = animated.weights()[v];
    if (weights.weight[0] > 0 && is_at_or_below(joints, static_cast<int>(weights.joint[0]), top)) {
      box.extend(animated.character().source_positions[v]);
    }
  }
  return box.isEmpty() ? joints[static_cast<std::size_t>(top)].position : Vec3(box.center());
}

}  // namespace

PosableRig posable_rig(const AnimatedAsset& animated) {
  PosableRig out;
  if (!moves_bones_of_asset(animated)) return out;
  const SourceRig& rig = animated.character().rig;
  std::vector<std::string> role_of_joint;
  if (rig.bones.empty()) {
    out.rig = PoseRig::kAutomatic;
    out.joints = joints_of(animated.asset());
    for (const Joint& joint : out.joints) role_of_joint.push_back(joint.name);
    add_limbs_by_role(out, role_of_joint);
  } else {
    out.joints = own_joints(rig);
    const Roles roles = animated.roles();
    std::vector<int> joint_of_node(rig.nodes.size(), -1);
    for (std::size_t b = rig.bones.size(); b-- > 0;) joint_of_node[rig.bones[b].node] = static_cast<int>(b);
    for (const Bone& bone : rig.bones) role_of_joint.push_back(roles.of_node[bone.node].role);
    const std::vector<Vec3> positions = rest_positions(rig);
    if (roles.kind == BodyKind::kBiped) add_limbs_by_role(out, role_of_joint);
    for (const RoleLimb& limb : roles.limbs) {
      const bool is_arm_or_leg =
          limb.name == "left_arm" || limb.name == "right_arm" || limb.name == "left_leg" || limb.name == "right_leg";
      if (roles.kind == BodyKind::kBiped && is_arm_or_leg) continue;
      if (limb.name != "neck") add_limb(out, limb, roles.kind != BodyKind::kOther, joint_of_node, positions);
    }
  }
  if (out.limbs.empty()) {
    add_chains(out);
    return out;
  }
  out.hips = joint_of(role_of_joint, "pelvis");
  out.head = joint_of(role_of_joint, "head");
  out.neck = joint_of(role_of_joint, "neck");
  if (out.neck < 0) out.neck = out.head;
  if (out.head >= 0) out.head_center = center_of_skin(animated, out.joints, out.head);
  return out;
}

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string>
#include <vector>

#include "baker/import/source_rig.h"

namespace spherechain::baker {

enum class BodyKind { kUnknown, kBiped, kQuadruped, kOther };
const char* body_kind_name(BodyKind kind);

// The role of a rig's node on the body. Roles are named as the joints of the automatic rig:
// - pelvis, spine, chest, neck, head,
// - with left_ or right_ before: clavicle, shoulder (of the upper arm), elbow, wrist, finger, hip (of the thigh), knee,
//   ankle, toe; a quadruped's forelegs count as arms,
// - tail_1 ..., limb (a joint of a limb that is neither arm nor leg), twist (part of a limb, follows its joints), eye,
//   jaw, hair, head_part, attachment, control (moves other nodes, not the skin), root, other.
// A body has one node for each role of the first two lists, but any number of spine, neck, finger and toe.
struct NodeRole {
  std::string role;
  int limb = -1;       // index in Roles::limbs; -1 for trunk, head and clavicles
  std::string reason;  // how it was decided, in words
};

struct RoleLimb {
  std::string name;  // left_arm, right_leg; left_foreleg, right_hindleg; left_leg_1 ... from the front; neck; tail
  bool left, top;    // top: hangs on the chest, or in front
  std::vector<int> nodes;  // from the first joint of the limb proper (upper arm, thigh) down to one tip
  int extremity = -1;      // which of `nodes` is wrist or ankle; -1 none
  int girdle = -1;         // the node that joins it to the trunk (clavicle); -1 none
};

struct Roles {
  BodyKind kind = BodyKind::kUnknown;
  std::vector<NodeRole> of_node;
  std::vector<RoleLimb> limbs;  // left before right, top before bottom; then neck and tail where they are long
  std::vector<int> trunk;       // pelvis to chest
  std::vector<int> neck_head;   // from the chest to the head
};

// Roles given by hand, node name -> role. They override names and shape.
struct RoleFile {
  std::string file;  // for messages
  std::map<std::string, std::string> role_of;
};

// Reads a JSON object. Throws Error(kFile) where the text is no such object, or a role is unknown.
RoleFile parse_role_file(const std::string& json, const std::string& file);

// The roles of a rig's nodes. The result does not depend on the order of the nodes, nor on place, size and orientation.
// `positions`: the rest positions of the vertices that rig.weights belong to; empty without skin.
// `wanted`: decides whether a body with two pairs of limbs is a biped or a quadruped; kUnknown: its pose decides.
// A robot has none: its links are its parts.
// Throws Error(kFile) where the role file names a node that does not exist.
Roles find_roles(const SourceRig& rig, const std::vector<Vec3>& positions, const RoleFile& file = {},
                 BodyKind wanted = BodyKind::kUnknown);

// The names of the limbs that have a node which no name tells: the rig's shape says what it is.
std::vector<std::string> limbs_by_shape(const Roles& roles);

// The position of each node in the rest pose: from its inverse bind matrix, else from its place under its parent. Where
// the rig has pivots, these.
std::vector<Vec3> rest_positions(const SourceRig& rig);

}  // namespace spherechain::baker

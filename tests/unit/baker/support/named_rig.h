// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <random>
#include <string>
#include <vector>

#include "baker/roles/roles.h"

// A rig written down as a tree: a line a node, indented by its depth, "name = role". The role says where the node is
// (on a human or a fox, left +x, up +y, forward +z) and what find_roles is expected to make of it. `!` before the role:
// the node moves no skin.
struct NamedRig {
  spherechain::baker::SourceRig rig;
  std::vector<spherechain::baker::Vec3> positions;  // one vertex a node
  std::vector<std::string> expected;                // of each node
};

enum class Body { kHuman, kFox };
NamedRig named_rig(const std::string& tree, Body body = Body::kHuman);

// The same rig in another place, size and orientation.
NamedRig moved(const NamedRig& rig);
spherechain::baker::Vec3 moved(const spherechain::baker::Vec3& position);
// The same rig with its nodes in another order (parents still first).
NamedRig shuffled(const NamedRig& rig, unsigned seed);
// The same rig, its nodes called joint_0, joint_1 ...
NamedRig nameless(NamedRig rig);
// The same rig with nodes that are no joints of their own. The expected role of each of those is empty.
// - a node without skin, `shift` away, above each joint but the topmost
NamedRig with_offsets(const NamedRig& rig, const spherechain::baker::Vec3& shift);
// - a leaf that moves skin in each joint's place
NamedRig with_twins(const NamedRig& rig);

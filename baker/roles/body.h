// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/roles/limb_path.h"
#include "baker/roles/roles.h"

namespace spherechain::baker {

// How a rig's limbs, trunk and head hang together.
struct Body {
  BodyKind kind = BodyKind::kUnknown;
  std::vector<LimbPath> paths;          // every one with its side
  std::vector<std::string> side_notes;  // for each path: how its side was decided, or empty
  std::vector<int> path_of;             // a node -> the path that it is on or below; -1 none
  std::vector<int> upper, lower;  // paths of arms or forelegs, and of legs or hind legs: from the front, left first
  int pelvis = -1, chest = -1, head = -1;
  std::vector<int> trunk, neck_head;  // as in Roles
};

// Marks the node and all nodes above it.
std::vector<bool> at_or_above(const Skeleton& skeleton, int node);

Body find_body(const Skeleton& skeleton, const std::vector<Hint>& hints, BodyKind wanted);

// The node outside the limbs whose hint is `word`. Where there are several, it is the one in a role file, else the
// nearest to the root, else the one with the largest weight. -1: there is none.
int find_in_middle(const Skeleton& skeleton, const std::vector<Hint>& hints, const std::vector<int>& path_of,
                   Word word);

}  // namespace spherechain::baker

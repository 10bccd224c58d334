// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "roles/limb_path.h"
#include "roles/roles.h"

namespace spherechain::baker {

// How a rig's limbs, trunk and head hang together.
struct Body {
  BodyKind kind = BodyKind::kUnknown;
  std::vector<LimbPath> paths;          // every one with its side
  std::vector<std::string> side_notes;  // of `paths`: how the side was decided, where there is something to say
  std::vector<int> path_of;             // node -> the one of `paths` that it is of or hangs on; -1 none
  std::vector<int> upper, lower;        // of `paths`, arms or forelegs, legs or hind legs: from the front, left first
  int pelvis = -1, chest = -1, head = -1;
  std::vector<int> trunk, neck_head;  // as in Roles
};

Body find_body(const Skeleton& skeleton, const std::vector<Hint>& hints, BodyKind wanted);

// The node outside the limbs that speaks of something in the body's middle: by a role file, else the one fewest steps
// from the root, then the heaviest. -1 none.
int find_in_middle(const Skeleton& skeleton, const std::vector<Hint>& hints, const std::vector<int>& path_of,
                   Word word);

}  // namespace spherechain::baker

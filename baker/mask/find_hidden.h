// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "baker/layers/skin.h"

namespace spherechain::baker {

// The skin that is hidden at rest and in all clips.
struct HiddenSkin {
  std::vector<char> is_hidden;   // of the source's triangles
  std::vector<char> is_covered;  // at rest another piece lies over the triangle
  std::size_t hidden = 0;        // triangles
  std::size_t near_edge = 0;     // triangles that are never seen, and stay because of the margin
  double hidden_area = 0, area = 0;
  double poke_area = 0, poke_hidden_area = 0;  // that shows through clothes, over all frames; of it the hidden
  int frames = 0;
};

// Finds triangles that are covered by another piece of the skin and seen in no clip, in no view. Skin that comes
// through its cover counts as hidden. Triangles stay that lie within `margin`, a share of the height, of skin of their
// piece that is seen. `clips` move the nodes of the character's rig. So many `random_poses` within the clips' limits
// are looked at, too. `progress` gets frames done, and all.
HiddenSkin find_hidden(const Character& character, const LayeredSkin& skin, const std::vector<Clip>& clips,
                       int random_poses, double margin, const std::function<void(int, int)>& progress);

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "baker/layers/skin.h"
#include "baker/mask/find_hidden.h"

namespace spherechain::baker {

// The page of `spherechain mask` shows a character with its clips, and the layer of each triangle.
struct MaskPage {
  std::string title;
  std::string template_file;            // the page without data, as its build made it
  std::vector<std::string> mesh_names;  // of the skin's runs
  SourceLook look;                      // empty: none
};

// `clips` move the nodes of the character's rig. `progress` gets each frame before it is played, and all. Throws
// Error(kFile) where the template is missing or no page.
std::string mask_page(const Character& character, const LayeredSkin& skin, const std::vector<Clip>& clips,
                      const HiddenSkin& hidden, const MaskPage& page, const std::function<void(int, int)>& progress);

}  // namespace spherechain::baker

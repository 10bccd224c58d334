// SPDX-License-Identifier: MIT
// A crowd from above, as a picture.
#pragma once

#include <vector>

#include "spherechain/spherechain.h"

// A character among others.
struct Standing {
  sc_vec3 low{}, high{};  // a box around him
  std::size_t met = 0;    // how many he is in
  float depth = 0;        // how deep he is in the ground
};

// A hundred pixels a metre. Red are those in each other; a blue dot is larger, the deeper one is in the ground.
void draw_map(const sc_asset_info& info, const std::vector<Standing>& characters, const char* svg_file);

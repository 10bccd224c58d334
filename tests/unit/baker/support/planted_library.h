// SPDX-License-Identifier: GPL-3.0-or-later
// A character of which all faults are known: a ball that clips put into a wall.
#pragma once

#include <string>
#include <vector>

// A clip of 30 frames a second: how deep the ball is in the wall in each of its frames, in mm; below 0 it is outside.
// The wall is 1 m thick, the ball 600 mm.
struct PlantedClip {
  std::string name;
  std::vector<double> depths_mm;
  bool is_linear = false;            // the ball goes from place to place; else it jumps
  std::vector<double> heights_mm{};  // of the ball above the wall's middle; empty: 0. The wall is 2 m high
  std::vector<double> sizes{};       // of the ball, against its own; empty: 1
  float time_scale = 1;              // its keys are so many times 1/30 s apart
};

// Bytes of a GLB file. Its body parts are "wall" and "ball".
std::string planted_character(const std::vector<PlantedClip>& clips);

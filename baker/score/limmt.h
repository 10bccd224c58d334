// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "spherechain/pose.h"

namespace spherechain::baker {

// A frame as LIMMT's score sees it. Lengths in metres; heights above the ground.
struct LimmtFrame {
  std::vector<sc_transform> joints;         // each in its parent's space
  std::vector<double> foot_heights;         // of ankles, less what they have at rest
  std::vector<std::array<double, 2>> feet;  // their places on the ground
  std::array<double, 3> root;
  double lowest;        // of the skin
  int self_collisions;  // pairs of body parts that are in each other
};

// The physical score of LIMMT ("Less is more for motion tracking", arXiv 2606.06953), 100 for a flawless clip down to
// 0, with the weights of its public code: feet that slide, joints that turn faster than 30 rad/s, pairs that collide
// (10 a frame at most), unsteady speed, depth below the ground, and time in the air. It was made for a robot's joints
// and contacts; here a joint has three angles, and a pair is one of body parts with a fault. A deep and a shallow
// contact are one to it, and one pair in every frame costs 0.17 of 100.
double limmt_score(const std::vector<LimmtFrame>& frames, double fps);

}  // namespace spherechain::baker

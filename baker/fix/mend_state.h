// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "baker/fix/find_faults.h"
#include "baker/fix/goals.h"
#include "baker/fix/mend.h"
#include "baker/fix/part_joints.h"
#include "baker/fix/separations.h"
#include "baker/fix/turned_clip.h"

namespace spherechain::baker {

// Parts whose penetration is at most this deep, in mm, must not end far apart.
inline constexpr double kShallowMax = 10;

// Facts of the source clip. A fix does not change them.
struct ClipFacts {
  const AnimatedAsset& animated;
  MendOptions options;
  double mm, height;  // mm per source unit; the character's height in source units
  TurnedClip clip;
  std::vector<Index> feet, wrists;          // joints
  std::vector<std::vector<Index>> planted;  // by frame: hands that stand on the ground
  std::vector<char> hands_joined;           // by frame: 1 if both hands hold one thing
  PartJoints parts;
  bool loops;  // the last frame is the first again
};

ClipFacts clip_facts(const AnimatedAsset& animated, const Roles& roles, const ClipFrames& clip,
                     const MendOptions& options);

// A round whose penetrations were measured in frames and between them.
struct MeasuredRound {
  Turns turns;
  std::vector<PosePenetration> found;
  std::vector<char> in_window;  // by frame: 1 if it was measured
};

// Everything that changes while a clip is being fixed. `facts` and `report` must outlive it.
struct MendState {
  const ClipFacts& facts;
  const std::function<void(const std::string&)>& report;
  FaultFinder finder;
  Goals goals;
  Separations separations;
  double budget = 0;  // radians that a joint may turn in this pass
  Turns turns;
  std::map<std::pair<int, Index>, Vec3> target_turns;  // by frame and joint: a lower bound
  std::vector<char> in_window;                         // by frame: 1 if its joints may turn
  std::vector<char> jumps;                             // by frame: 1 if the step limit does not apply in the next step
  LeastResidual least;                                 // of all events together
  std::vector<MeasuredRound> rounds;
};

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "fix/turned_clip.h"
#include "fix/ways_out.h"
#include "play/play.h"
#include "play/skin_player.h"
#include "play/steps.h"

namespace spherechain::baker {

// What two body parts do in a frame, or between two.
struct Meeting {
  double frame;
  Penetration found;  // a fault: measured in full; else quickly
};

// The runtime's contacts of a clip with turns, of many frames at a time.
class FaultFinder {
 public:
  FaultFinder(const AnimatedAsset& animated, const TurnedClip& clip);

  // Pairs of parts (the lesser number first) that are not looked at.
  void leave_out(std::set<std::pair<std::uint32_t, std::uint32_t>> pairs) { left_out_ = std::move(pairs); }

  // In the order of the frames, then by parts.
  std::vector<Meeting> in_frames(const std::vector<double>& frames, const Turns& turns);
  // Of poses that are tried, all measured quickly.
  std::vector<std::vector<Meeting>> in_poses(const std::vector<TriedPose>& poses);
  // Faults on the way from each of these whole frames to the next that are none in either; where they are about
  // deepest.
  std::vector<Meeting> between(const std::vector<int>& frames, const Turns& turns);

 private:
  enum class Depth { kFull, kQuick };
  std::vector<Meeting> look(SkinPlayer& player, double frame, const std::vector<Vec3>& turns, Depth depth) const;

  const AnimatedAsset& animated_;
  const TurnedClip& clip_;
  std::set<std::pair<std::uint32_t, std::uint32_t>> left_out_;
  std::vector<SkinPlayer> players_;  // one a thread
  std::vector<StepPlayer> steps_;
};

}  // namespace spherechain::baker

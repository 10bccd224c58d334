// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "fix/turned_clip.h"
#include "fix/ways_out.h"
#include "play/play.h"
#include "play/skin_player.h"
#include "play/steps.h"

namespace spherechain::baker {

// Penetration of two body parts in a frame, or between two frames.
struct Meeting {
  double frame;
  Penetration found;  // measured quickly: its volume is not known
};

// The runtime's contacts of a clip with turns, of many frames at a time. What was found in a frame holds while joints
// turn by no more than can be seen.
class FaultFinder {
 public:
  FaultFinder(const AnimatedAsset& animated, const TurnedClip& clip);

  // Pairs of parts (the lesser number first) that are not looked at.
  void leave_out(std::set<std::pair<std::uint32_t, std::uint32_t>> pairs);

  // In the order of the frames, then by parts.
  std::vector<Meeting> in_frames(const std::vector<double>& frames, const Turns& turns);
  // Measures candidate poses quickly. Only pairs of parts of which one `moves` are measured.
  std::vector<std::vector<Meeting>> in_poses(const std::vector<TriedPose>& poses, const std::vector<char>& moves);
  // Faults on the way from each of these whole frames to the next that are none in either; where they are about
  // deepest.
  std::vector<Meeting> between(const std::vector<int>& frames, const Turns& turns);
  // How much of the two parts is in each other there; 0 where that is not known. Source units.
  double volume(double frame, const Penetration& of, const Turns& turns);

 private:
  struct Seen {
    std::vector<Vec3> turns;
    std::vector<Meeting> found;
  };
  using SeenFrames = std::map<double, Seen>;
  // Frames that have to be measured again, because joints turned.
  static std::vector<double> changed(SeenFrames& seen, const std::vector<std::pair<double, std::vector<Vec3>>>& now);
  template <typename Frames>
  static std::vector<Meeting> found_in(const SeenFrames& seen, const Frames& frames);
  std::vector<Meeting> look(SkinPlayer& player, double frame, const Turns& turns) const;
  std::vector<Meeting> look_after(std::size_t thread, int frame, const Turns& turns);

  const AnimatedAsset& animated_;
  const TurnedClip& clip_;
  std::set<std::pair<std::uint32_t, std::uint32_t>> left_out_;
  PartPairBits asked_;               // all but these
  std::vector<SkinPlayer> players_;  // one a thread
  std::vector<StepPlayer> steps_;
  SeenFrames seen_, seen_between_;
};

}  // namespace spherechain::baker

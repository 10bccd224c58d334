// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "baker/fix/turned_clip.h"
#include "baker/fix/ways_out.h"
#include "baker/play/play.h"
#include "baker/play/skin_player.h"
#include "baker/play/steps.h"

namespace spherechain::baker {

// Penetration of two body parts in a frame, or between two frames.
struct PosePenetration {
  double frame;
  Penetration found;  // measured by the fast form: without its volume
};

// Measures the penetrations of a turned clip, many frames at a time, strictly: what is no fault here is none in a clip,
// whatever comes before it. Results of a frame are kept until its joints turn visibly.
class FaultFinder {
 public:
  FaultFinder(const AnimatedAsset& animated, const TurnedClip& clip);

  // Excludes pairs of parts (the lesser number first).
  void leave_out(std::set<std::pair<std::uint32_t, std::uint32_t>> pairs);

  // As `check` finds them, frame by frame: a fault goes on until it is clearly none.
  std::vector<PosePenetration> in_sequence(const Turns& turns);
  // Sorted by frame, in the order given, then by parts.
  std::vector<PosePenetration> in_frames(const std::vector<double>& frames, const Turns& turns);
  // Measures candidate poses quickly. Only pairs of parts of which one `moves` are measured.
  std::vector<std::vector<PosePenetration>> in_poses(const std::vector<TriedPose>& poses,
                                                     const std::vector<char>& moves);
  // Faults between each of these whole frames and the next that neither frame has. Each is measured near its deepest
  // point.
  std::vector<PosePenetration> between(const std::vector<int>& frames, const Turns& turns);
  // Common volume of the two parts in that frame, in source units; 0 if it cannot be measured.
  double volume(double frame, const Penetration& of, const Turns& turns);

 private:
  struct Seen {
    std::vector<Vec3> turns;
    std::vector<PosePenetration> found;
  };
  using SeenFrames = std::map<double, Seen>;
  // Frames that have to be measured again, because joints turned.
  static std::vector<double> changed(SeenFrames& seen, const std::vector<std::pair<double, std::vector<Vec3>>>& now);
  template <typename Frames>
  static std::vector<PosePenetration> found_in(const SeenFrames& seen, const Frames& frames);
  std::vector<PosePenetration> look(SkinPlayer& player, double frame, const Turns& turns) const;
  std::vector<PosePenetration> look_after(std::size_t thread, int frame, const Turns& turns);

  const AnimatedAsset& animated_;
  const TurnedClip& clip_;
  std::set<std::pair<std::uint32_t, std::uint32_t>> left_out_;
  PartPairBits asked_;               // every pair except those
  std::vector<SkinPlayer> players_;  // one a thread
  std::vector<StepPlayer> steps_;
  SeenFrames seen_, seen_between_;
};

}  // namespace spherechain::baker

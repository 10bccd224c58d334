// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "baker/fix/mend_state.h"

namespace spherechain::baker {

// How much an animator sees of a change: nothing moved; one has to look for it; one sees it; the pose says another
// thing.
enum class ActingVerdict { kUnchanged, kSmall, kVisible, kChangesPose };
const char* verdict_name(ActingVerdict verdict);

// How far a pose differs from the clip as animated, over some frames.
struct Acting {
  int from = 0, to = 0;                                  // these frames
  std::vector<std::pair<std::string, double>> moves_mm;  // of head, hands and feet: the largest move; largest first
  std::vector<std::pair<std::string, double>> turns;     // by joint, in degrees: the largest turn; largest first
  // How much further than before an end or a joint goes from one frame to the next, at most, in % of the height.
  double step_percent = 0;
  ActingVerdict verdict = ActingVerdict::kUnchanged;

  double move_mm() const { return moves_mm.empty() ? 0 : moves_mm.front().second; }
};

// Measures how turns change what a character's head, hands and feet do. A body without these has the tips of its limbs
// in their place.
class ActingMeasure {
 public:
  // `facts` and `roles` must outlive it.
  ActingMeasure(const ClipFacts& facts, const Roles& roles);

  // Measures the whole clip.
  Acting of_clip(const Turns& turns) { return measure(turns, {0, facts_.clip.frames() - 1}); }
  // Measures an event: its frames and kWindowPad seconds around them, up to half-way to the next event of its joints.
  Acting of_event(const std::vector<MendedEvent>& events, std::size_t event, const Turns& turns);

 private:
  struct Frames {
    int from, to;
  };
  Acting measure(const Turns& turns, Frames frames);
  // The centre of each end's skin; then the place of each joint.
  std::vector<Vec3> places(int frame, const std::vector<Vec3>& turns) const;

  const ClipFacts& facts_;
  const Roles& roles_;
  std::vector<std::string> ends_;
  std::vector<std::size_t> first_;  // of the samples of each end, and the number of all
  std::vector<Vec3> rest_;          // samples of the skin
  std::vector<VertexWeights> weights_;
  std::map<int, std::vector<Vec3>> animated_;  // places in the source clip, by frame
};

// The joints that an event's cure may turn: those that move one of its parts, and the rest of their limbs.
std::vector<Index> joints_of_event(const MendedEvent& event, const ClipFacts& facts, const Roles& roles);

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <set>
#include <vector>

#include "baker/fix/goals.h"
#include "baker/fix/turned_clip.h"
#include "baker/fix/ways_out.h"

namespace spherechain::baker {

// Maps body parts to the turning joints that move them.
class PartJoints {
 public:
  // `feet`: joints that must not turn, nor any joint above them.
  PartJoints(const AnimatedAsset& animated, const TurnedClip& clip, const std::vector<Index>& feet);

  const std::vector<Index>& above(std::uint32_t part) const { return above_[part]; }
  // Joints that move only one of the two parts, and cost at most so many times the cheapest of them: the trunk does not
  // move for an arm.
  std::set<Index> parting(std::uint32_t a, std::uint32_t b, double most = 4.1) const;
  // The cheap ones among them. Joints above a foot are left out.
  std::set<Index> between(std::uint32_t a, std::uint32_t b) const;
  // Marks each part that one of these joints moves.
  std::vector<char> moved_by(const std::set<Index>& joints) const;

 private:
  std::set<Index> cheap(std::uint32_t a, std::uint32_t b, double most, const std::set<Index>& without) const;

  std::vector<std::vector<Index>> above_;  // by part
  std::vector<double> costs_;              // by joint, along its cheapest axis
  std::set<Index> held_;
};

// An event, together with all events that share joints and frames with it and fulfil `is_included`.
struct LimbInTrouble {
  std::vector<std::size_t> events;  // the requested event comes first
  std::vector<Index> joints;        // empty: no joint can turn
  std::vector<char> moves;          // by part: 1 if these joints move it
  int from, to;                     // frames of all these events
  std::vector<int> worst;           // the deepest frame of each event
};
LimbInTrouble limb_in_trouble(const Goals& goals, const PartJoints& parts, std::size_t event,
                              const std::function<bool(const WorkingEvent&)>& is_included);

}  // namespace spherechain::baker

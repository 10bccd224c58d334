// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <set>
#include <vector>

#include "fix/goals.h"
#include "fix/turned_clip.h"
#include "fix/ways_out.h"

namespace spherechain::baker {

// Which turning joints move which body parts.
class PartJoints {
 public:
  // `feet`: joints that are held, with all that they hang on.
  PartJoints(const AnimatedAsset& animated, const TurnedClip& clip, const std::vector<Index>& feet);

  const std::vector<Index>& above(std::uint32_t part) const { return above_[part]; }
  // Cheap joints that move only one of the two parts. Joints above a foot are left out.
  std::set<Index> between(std::uint32_t a, std::uint32_t b) const;
  // Marks each part that one of these joints moves.
  std::vector<char> moved_by(const std::set<Index>& joints) const;

 private:
  std::vector<std::vector<Index>> above_;  // of each part
  std::vector<double> prices_;             // of each joint, along its cheapest axis
  std::set<Index> held_;
};

// An event, with all others that it shares joints and time with.
struct LimbInTrouble {
  std::vector<std::size_t> events;  // the first of them is the one that was asked for
  std::vector<Index> joints;        // none: nothing can be turned
  std::vector<char> moves;          // of each part: these joints do
  int from, to;                     // frames of all of them
  std::vector<int> worst;           // an event's deepest frame each
};
LimbInTrouble limb_in_trouble(const Goals& goals, const PartJoints& parts, std::size_t event,
                              const std::function<bool(std::size_t)>& is_open);

}  // namespace spherechain::baker

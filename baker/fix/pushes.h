// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <tuple>
#include <vector>

#include "fix/solve.h"
#include "fix/turned_clip.h"
#include "play/play.h"
#include "spherechain/contacts.h"

namespace spherechain::baker {

// Two body parts in a frame, or between two.
struct MeetingPlace {
  double frame;
  std::uint32_t part, other;

  bool operator<(const MeetingPlace& of) const {
    return std::tie(frame, part, other) < std::tie(of.frame, of.part, of.other);
  }
};

// Two spots, b of the part that goes in and a of the other, and a way for b to leave a.
struct Push {
  SkinSpot a, b;
  Vec3 way;         // unit length
  double target;    // how far b is to be from a along the way; negative: no deeper than that
  bool is_shallow;  // it ends near
};

// All that was ever in each other: what was pushed out once must not come back.
class Pushes {
 public:
  Pushes(const AnimatedAsset& animated, const TurnedClip& clip) : animated_(animated), clip_(clip) {}

  // From what was measured there. Another way out is not begun while one is not at its end.
  void add(const MeetingPlace& place, const Penetration& found, double target, bool is_shallow, const Turns& turns);
  // Removes the constraints of each place for which the predicate is true.
  template <typename Predicate>
  void forget(const Predicate& is_it) {
    for (auto& [place, pushes] : of_) {
      if (is_it(place)) pushes.clear();
    }
  }

  const std::map<MeetingPlace, std::vector<Push>>& all() const { return of_; }
  // That spots part, to first order around the turns.
  void add_wishes(double weight, const Turns& turns, std::vector<Wish>& wishes) const;

 private:
  double gap(const Push& push, double frame, const Turns& turns) const;

  const AnimatedAsset& animated_;
  const TurnedClip& clip_;
  std::map<MeetingPlace, std::vector<Push>> of_;
};

}  // namespace spherechain::baker

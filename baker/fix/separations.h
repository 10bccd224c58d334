// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "baker/fix/solve.h"
#include "baker/fix/turned_clip.h"
#include "baker/play/play.h"
#include "spherechain/contacts.h"

namespace spherechain::baker {

// Identifies a penetration: two body parts in a frame, or between two frames.
struct PenetrationKey {
  double frame;
  std::uint32_t part, other;

  bool operator<(const PenetrationKey& of) const {
    return std::tie(frame, part, other) < std::tie(of.frame, of.part, of.other);
  }
};

// Pushes two skin points apart: b on the part that goes in, a on the other part.
struct Separation {
  SkinSpot a, b;
  Vec3 way;         // direction in which b leaves a; unit length
  double target;    // distance of b from a along `way`; negative: the depth that may stay
  bool is_shallow;  // the parts must not end far apart
};

// Separations of all penetrations found so far. They stay, so that separated parts do not come back.
class Separations {
 public:
  // `joints_of`: the joints that may turn to part two body parts.
  using JointsOf = std::function<std::set<Index>(std::uint32_t part, std::uint32_t other)>;
  Separations(const AnimatedAsset& animated, const TurnedClip& clip, JointsOf joints_of)
      : animated_(animated), clip_(clip), joints_of_(std::move(joints_of)) {}

  // Adds a measured penetration. Ignored if its direction differs from a separation that has not reached its target.
  void add(const PenetrationKey& place, const Penetration& found, double target, bool is_shallow, const Turns& turns);
  // Removes the constraints of each place for which the predicate is true.
  template <typename Predicate>
  void forget(const Predicate& is_it) {
    for (auto& [place, separations] : of_) {
      if (is_it(place)) separations.clear();
    }
  }

  const std::map<PenetrationKey, std::vector<Separation>>& all() const { return of_; }
  // Adds one constraint per separation, linearised at the current turns.
  void add_constraints(double weight, const Turns& turns, std::vector<Constraint>& constraints) const;

 private:
  double gap(const Separation& separation, double frame, const Turns& turns) const;

  const AnimatedAsset& animated_;
  const TurnedClip& clip_;
  JointsOf joints_of_;
  std::map<PenetrationKey, std::vector<Separation>> of_;
};

}  // namespace spherechain::baker

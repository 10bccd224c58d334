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
#include "spherechain/response.h"

namespace spherechain::baker {

// Identifies a penetration: two body parts in a frame, or between two frames.
struct PenetrationKey {
  double frame;
  std::uint32_t part, other;

  bool operator<(const PenetrationKey& of) const {
    return std::tie(frame, part, other) < std::tie(of.frame, of.part, of.other);
  }
};

// A contact row as the runtime's response has it, and the skin that its two spots are on.
struct Separation {
  ContactRow row;
  SkinSpot at, at_other;
  bool is_shallow;  // the parts must not end far apart
};

// Separations of all penetrations found so far. They stay, so that separated parts do not come back.
class Separations {
 public:
  // `joints_of`: the joints that may turn to part two body parts.
  using JointsOf = std::function<std::set<Index>(std::uint32_t part, std::uint32_t other)>;
  Separations(const AnimatedAsset& animated, const TurnedClip& clip, JointsOf joints_of)
      : animated_(animated), clip_(clip), joints_of_(std::move(joints_of)) {}

  // Adds a measured penetration, of which so much may stay. Ignored if its direction differs from a separation that is
  // not there yet.
  void add(const PenetrationKey& place, const Penetration& found, double allowed, bool is_shallow, const Turns& turns);
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

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "baker/truth/truth.h"
#include "spherechain/contacts.h"

namespace spherechain::baker {

// How deep the faults of a frame are that a method does not see: penetrations and deep folds of two body parts of which
// it reports no contact.
class MissedDepth {
 public:
  // `part_of`: of a source triangle. `reported` are pairs of spheres, sorted.
  MissedDepth(const std::vector<std::uint8_t>& part_of, const FrameTruth& truth, const std::vector<Pair>& reported,
              const std::vector<Penetration>& penetrations);

  // Depth of a contact's fault in the source's units. 0 if it belongs to no missed fault.
  double operator()(const TrueContact& contact) const;

 private:
  Pair part_pair_of(const Pair& triangles) const;

  const std::vector<std::uint8_t>& part_of_;
  std::map<Pair, double> depths_;  // of two parts
};

}  // namespace spherechain::baker

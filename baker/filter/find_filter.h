// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

#include "baker/calibrate/random_poses.h"
#include "baker/filter/part_filter.h"
#include "baker/filter/touching_parts.h"
#include "baker/play/play.h"

namespace spherechain::baker {

// Looks at a character in many poses, on all cores, and says what each two of its body parts do. The same poses in any
// number of threads give the same answer. `progress`, from time to time, is given how many are done.
class FilterSearch {
 public:
  using Progress = std::function<void(int done)>;

  // The asset must have clusters. Looks at the rest pose.
  FilterSearch(const AnimatedAsset& animated, Target target);

  // All frames that `animated` plays now.
  void look_at_frames(const Progress& progress);
  // `count` poses, each joint turned on its own, evenly within its limits. Pose i is the same whatever the count.
  void look_at_random(const RandomPoses& poses, int count, const Progress& progress);

  PartFilter result() const;

 private:
  struct Tally {
    int count = 0;                                 // of poses
    std::vector<int> touching;                     // of pair after pair: poses in which they touch
    std::vector<int> first_touching, first_apart;  // of pair after pair: number of the pose; INT_MAX: none
  };
  void look(int count, const std::function<Deformation(int)>& pose, const Progress& progress, Tally& tally) const;
  std::size_t pair_count() const { return parts_ * (parts_ - 1) / 2; }

  const AnimatedAsset& animated_;
  PartSkin skin_;
  Target target_;
  std::size_t parts_;
  Tally rest_, clips_, random_;
};

}  // namespace spherechain::baker

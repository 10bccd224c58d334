// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "baker/import/import.h"

namespace spherechain::baker {

// How a robot's own colliders compare with its meshes over the poses of a motion. Bodies count as solid where they are
// closed: one inside another intersects it.
struct ColliderAlarms {
  struct Counts {
    int alarms = 0;  // poses in which colliders intersect
    int wrong = 0;   // of those, in which the meshes do not
    int missed = 0;  // poses in which meshes intersect and colliders do not
  };
  struct BonePair {
    std::array<Index, 2> bones;
    Counts counts;
  };
  int poses = 0;
  Counts any;                   // poses with such a pair. An alarm is wrong where no pair's meshes intersect.
  std::vector<BonePair> pairs;  // those with an alarm or a miss, in the order of the bones
};

// `bones` gives the bones' matrices of a pose, rest -> pose. Pairs that the robot excludes, and bones without a
// collider, are left out. Exact for the positions at rest; a round collider is a prism or polyhedron of 48 sides.
ColliderAlarms find_collider_alarms(const Character& robot, int poses,
                                    const std::function<std::vector<Affine>(int)>& bones);

}  // namespace spherechain::baker

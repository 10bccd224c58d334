// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "calibrate/random.h"
#include "import/import.h"
#include "rig/rig.h"

namespace spherechain::baker {

// Poses within a character's joint limits. Each joint turns about its three axes on its own, evenly in a box of
// rotation vectors. With clips the box is the smallest around all their keys and 10 degrees more; so are the boxes of
// translations, scales and morph weights, without the 10 degrees. Without clips a joint turns by up to 45 degrees about
// each axis, and morphs keep their weight at rest.
class RandomPoses {
 public:
  // `joints`: the automatic rig's, for a character without bones.
  RandomPoses(const Character& character, const std::vector<Joint>& joints);

  // Whether there is anything to move.
  bool any() const { return !bones_.empty(); }

  struct Pose {
    std::vector<Affine> bones;  // for each bone: rest -> posed
    std::vector<double> morphs;
  };
  Pose next(Random& random) const;

 private:
  struct Range {
    Vec3 low = Vec3::Zero(), high = Vec3::Zero();
  };
  struct Limits {
    Eigen::Quaterniond middle = Eigen::Quaterniond::Identity();  // what rotation vectors start from
    Range turn, translation, scale;
    bool moves = false;  // else the node keeps its transform
  };

  std::vector<Node> nodes_;
  std::vector<Limits> limits_;  // of each node
  std::vector<Bone> bones_;
  Affine to_rest_ = Affine::Identity();
  std::vector<std::pair<double, double>> morphs_;  // the least and the greatest weight
};

}  // namespace spherechain::baker

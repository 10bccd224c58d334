// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "motion/motion.h"
#include "pipeline/pipeline.h"
#include "spherechain/triangle_contacts.h"

namespace spherechain::test {

// assimp-testmodels' human.zae, baked, in frames of its motion capture of a boxer and of samples/poses.
struct MovingHuman {
  struct Frame {
    std::string name;
    baker::Deformation deformation;
  };

  baker::Bake bake;

  Asset asset() const;  // a view of bake.asset
  std::vector<float> rest_positions() const;
  std::vector<Frame> frames() const;
  // x y z of each source vertex, rounded to float.
  std::vector<float> deformed(const baker::Deformation& deformation) const;
};

// Baked once for all tests of a run.
const MovingHuman& moving_human();

}  // namespace spherechain::test

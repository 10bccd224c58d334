// SPDX-License-Identifier: GPL-3.0-or-later
// Figure 15: the running stage frame by frame.
#include "experiments.h"
#include "run_frames.h"

namespace spherechain::paper {

Table measure_running_time(const Study& study, const Bake& bake, int repetitions) {
  Table out{"figure15", {"animation", "frame", "method", "tests", "overlaps", "us"}, {}};
  const auto costs = run_frames({bake.asset}, study.animations(), repetitions);
  for (const FrameCost& frame : costs.front()) {
    for (std::size_t m = 0; m < kMethods.size(); ++m) {
      const Cost& cost = frame.methods[m];
      out.add({study.animations()[frame.animation].name, frame.frame, kMethods[m], cost.tests, cost.overlaps, cost.us});
    }
  }
  return out;
}

}  // namespace spherechain::paper

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "calibrate/samples.h"

namespace spherechain::baker {

// Where to draw a line so that what is below it is reported.
struct Line {
  double value = 0;  // 0: nothing is worth it
  double gain = 0;   // contacts found times their worth, less false alarms
};

// The best line. Each of `values` is that of a contact or of none; a contact found is worth `worth` false alarms.
Line best_line(std::vector<std::pair<double, bool>> values, double worth);

// The greatest distance at which a pair is worth reporting, as a part of the sum of the radii. They are the detect
// radii of the samples, times `scale_a` and `scale_b`.
double best_reach(const SampledPair& pair, double scale_a, double scale_b);

// What to multiply the detect radius of each of `count` spheres with, at least 1, so that contacts that they miss are
// found. A pair in `is_rest_pair` reaches no farther than best_reach() says.
std::vector<double> grow_radii(const std::vector<SampledPair>& pairs, const std::vector<bool>& is_rest_pair,
                               std::size_t count);

}  // namespace spherechain::baker

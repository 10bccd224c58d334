// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "calibrate/samples.h"

namespace spherechain::baker {

// How near two spheres must come to be reported, for each pair, as a part of the sum of their sampled radii: where the
// contacts that a report finds, times their worth, exceed its false alarms most. A contact is worth 10 false alarms of
// a rest pair, 30 of another: what is beyond the radii is never found.
// A pair that is no rest pair borrows three average pairs from each of its spheres and from the whole body, for many
// touch seldom in samples. It reaches 0.7 at least. Without samples it reaches 1, and a rest pair 0.
std::vector<double> best_reaches(const std::vector<SampledPair>& pairs, const std::vector<bool>& is_rest_pair,
                                 std::size_t sphere_count);

// What to multiply the sampled radius of each sphere with, at least `least`, so that each pair reaches as far as it
// should. `radii` are the spheres' at rest; mirrored spheres get the same factor.
std::vector<double> radius_factors(const std::vector<SampledPair>& pairs, const std::vector<double>& reaches,
                                   const std::vector<double>& radii, const std::vector<double>& least);

// In how many samples of a pair the radii times their factors report what `reach` does not, and nothing touches.
std::size_t false_alarms_beyond(const SampledPair& pair, double reach, double factor_a, double factor_b);

}  // namespace spherechain::baker

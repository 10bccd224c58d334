// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "calibrate/samples.h"

namespace spherechain::baker {

// How near two spheres must come to be reported, for each pair, as a part of the sum of their sampled radii: where the
// contacts that a report finds, times their worth, exceed its false alarms most. A contact is worth 25 false alarms of
// a rest pair, 12 of another.
// `at_rest` is what a rest pair should reach for what it is at rest; it counts as ten contacts there, which samples
// without contacts can outweigh. Other pairs have none: they borrow three average pairs from each of their spheres and
// from the whole body, for many touch seldom in samples, and reach 0.7 at least, or 1 without samples.
std::vector<double> best_reaches(const std::vector<SampledPair>& pairs,
                                 const std::vector<std::optional<double>>& at_rest, std::size_t sphere_count);

// What to multiply the sampled radius of each sphere with, at least `least`, so that each pair reaches as far as it
// should. `radii` are the spheres' at rest; mirrored spheres get the same factor.
std::vector<double> radius_factors(const std::vector<SampledPair>& pairs, const std::vector<double>& reaches,
                                   const std::vector<double>& radii, const std::vector<double>& least);

// In how many samples of a pair the radii times their factors report what `reach` does not, and nothing touches.
std::size_t false_alarms_beyond(const SampledPair& pair, double reach, double factor_a, double factor_b);

}  // namespace spherechain::baker

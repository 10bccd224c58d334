// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "baker/calibrate/samples.h"

namespace spherechain::baker {

// How near two spheres must come to be reported, for each pair, as a part of the sum of their sampled radii: where the
// contacts that a report finds, times their worth, exceed its false alarms most. An expected pose counts four times.
// A contact is worth 8 false alarms, 12 where no pose is expected; or as many more, up to 200, as the whole body needs
// to find 95 % of the contacts of expected poses and 85 % of the others.
// `at_rest` is what a rest pair should reach for what it is at rest. It counts as one contact of an expected pose,
// which samples without contacts can outweigh down to half of it. Other pairs have none: they borrow an average pair
// from each of their spheres and from the whole body, for many touch seldom in samples, and reach 0.3 at least, or 1
// without samples.
std::vector<double> best_reaches(const std::vector<SampledPair>& pairs,
                                 const std::vector<std::optional<double>>& at_rest, std::size_t sphere_count);

// Factors for each sphere's sampled radius, at least `least`, so that each pair reaches as far as it should. `radii`
// are the radii at rest. Mirrored spheres get the same factor.
std::vector<double> radius_factors(const std::vector<SampledPair>& pairs, const std::vector<double>& reaches,
                                   const std::vector<double>& radii, const std::vector<double>& least);

// Counts a pair's additional false alarms: samples without contact that the scaled radii report and `reach` does not.
std::size_t false_alarms_beyond(const SampledPair& pair, double reach, double factor_a, double factor_b);

}  // namespace spherechain::baker

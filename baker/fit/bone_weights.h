// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <boost/container/flat_map.hpp>
#include <vector>

#include "baker/import/import.h"

namespace spherechain::baker {

// How much each bone moves some skin: the mean of its vertices' weights by area.
using BoneWeights = boost::container::flat_map<Index, double>;

// Mean bone weights of triangles of Character::skin. Empty if the source has no bones.
BoneWeights mean_weights(const Character& character, const std::vector<Index>& triangles);

// From 0, no bone moves both, to 1, all bones move both as much.
double overlap(const BoneWeights& a, const BoneWeights& b);

inline constexpr double kMovesAlike = 0.8;  // skins whose weights overlap by more move alike

}  // namespace spherechain::baker

// SPDX-License-Identifier: MIT
// How often the skin winds around a point, as counted along x, y and z.
#pragma once

#include <algorithm>

#include "runtime/src/skin/skin_table.h"

namespace spherechain {

constexpr std::size_t kShortAxis = 2;  // most characters stand along y, and are thinnest along z

// Counts along x, y and z, of which the middle one counts.
template <typename T>
T middle_of(const T* counts) {
  return std::max(std::min(counts[0], counts[1]), std::min(std::max(counts[0], counts[1]), counts[2]));
}

// At rest the skin is closed around a point where it winds around it equally often along each axis.
inline bool is_closed(const std::int8_t* at_rest) { return at_rest[0] == at_rest[1] && at_rest[1] == at_rest[2]; }

}  // namespace spherechain

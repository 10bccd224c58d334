// SPDX-License-Identifier: MIT
#pragma once

#include <limits>

namespace spherechain {

// No number below 0: by the rule of detect.h it touches nothing then, whatever the other sphere's radius is.
inline float padded_radius(float radius, float padding) {
  const float padded = radius + padding;
  return padded < 0.0F ? std::numeric_limits<float>::quiet_NaN() : padded;
}

}  // namespace spherechain

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>

namespace spherechain::baker {

// A frame's number: an integer, or a fraction between two frames.
inline nlohmann::ordered_json number_json(double number) {
  if (number == std::floor(number)) return static_cast<long>(number);
  return std::round(100 * number) / 100;
}

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

namespace spherechain::baker {

// Limits of both numbers below.
inline constexpr double kSizeFactorMin = 1e-6, kSizeFactorMax = 1e6;

// The size that a user gives a character in place of its file's. At most one of the numbers is set. Coordinates stay
// the file's: only the metres in one of its units change.
struct GivenSize {
  std::optional<double> scale;   // the character is so many times as large as its file says
  std::optional<double> height;  // metres that a biped is tall, or any other body long

  bool is_given() const { return scale || height; }
  // Metres in a unit of the source. `by_file` is the same by the file, `units` the body's height in units.
  double metres_per_unit(double by_file, double units) const {
    return height ? *height / units : scale.value_or(1) * by_file;
  }
};

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

namespace spherechain::baker {

// A sphere that overlaps the one before it by this much or more lies mostly inside it and would add nothing.
inline constexpr double kClosingDepth = 0.7;

// The first position past `from` and before `to` where `reached` holds: found by steps, its place by bisection.
template <typename Reached>
std::optional<double> first_where(double from, double to, double step, const Reached& reached) {
  for (double high = from + step; high < to; high += step) {
    if (!reached(high)) continue;
    double low = high - step, top = high;
    for (int i = 0; i < 24; ++i) {
      const double middle = 0.5 * (low + top);
      (reached(middle) ? top : low) = middle;
    }
    return top;
  }
  return std::nullopt;
}

}  // namespace spherechain::baker

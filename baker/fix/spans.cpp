// SPDX-License-Identifier: GPL-3.0-or-later
#include "fix/spans.h"

#include <algorithm>
#include <cmath>

namespace spherechain::baker {

std::vector<std::vector<std::size_t>> spans_of(const std::vector<char>& in_window, bool loops) {
  std::vector<std::vector<std::size_t>> out;
  for (std::size_t f = 0; f < in_window.size(); ++f) {
    if (in_window[f] == 0) continue;
    if (f == 0 || in_window[f - 1] == 0) out.emplace_back();
    out.back().push_back(f);
  }
  if (loops && out.size() > 1 && in_window.front() != 0 && in_window.back() != 0) {
    out.front().insert(out.front().end(), out.back().begin(), out.back().end());
    out.pop_back();
  }
  return out;
}

void taper(const TurnedClip& clip, Index joint, const std::vector<char>& fails, double seconds, bool loops,
           Turns& turns) {
  const double pad = seconds * clip.fps();
  for (std::size_t f = 0; f < fails.size(); ++f) {
    double near = HUGE_VAL;
    for (std::size_t g = 0; g < fails.size(); ++g) {
      if (fails[g] == 0) continue;
      const double apart = std::abs(static_cast<double>(f) - static_cast<double>(g));
      near = std::min({near, apart, loops ? static_cast<double>(fails.size() - 1) - apart : apart});
    }
    const double share = std::clamp((near - pad) / pad, 0.0, 1.0);
    turns[f * clip.count() + joint] *= share * share * (3 - 2 * share);
  }
}

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/time_windows.h"

#include <algorithm>
#include <cmath>

namespace spherechain::baker {

std::vector<char> windows_around(const std::set<int>& frames, const TurnedClip& clip, bool loops) {
  std::vector<char> out(static_cast<std::size_t>(clip.frames()), 0);
  const int pad = static_cast<int>(std::ceil(kWindowPad * clip.fps()));
  for (const int frame : frames) {
    const int from = std::max(0, frame - pad), to = std::min(clip.frames() - 1, frame + 1 + pad);
    for (int f = from; f <= to; ++f) out[static_cast<std::size_t>(f)] = 1;
  }
  if (loops) out.front() = out.back() = static_cast<char>(out.front() | out.back());
  return out;
}

std::vector<int> marked_frames(const std::vector<char>& in_window) {
  std::vector<int> out;
  for (std::size_t f = 0; f < in_window.size(); ++f) {
    if (in_window[f] != 0) out.push_back(static_cast<int>(f));
  }
  return out;
}

std::vector<std::vector<std::size_t>> contiguous_runs(const std::vector<char>& in_window, bool loops) {
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

}  // namespace spherechain::baker

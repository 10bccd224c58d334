// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/smoothing.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "baker/fix/step_limit.h"
#include "baker/fix/time_windows.h"

namespace spherechain::baker {
namespace {

constexpr double kShaky = 1.5;        // ratio of the jerk to that of the source clip
constexpr double kCalm = 5;           // heights per second^3: an invisible jerk
constexpr double kMovedAtAll = 2e-3;  // heights
constexpr double kSpread = 0.02;      // radians a frame: the slope of turns that are spread
constexpr int kSmoothings = 8;        // with a Gaussian of 1, 1.5, 2, ... frames
constexpr int kFadeSteps = 10;        // to this share each, then to nothing
constexpr double kFade = 0.85;

// 1 in the marked frames, falling to 0 within `frames` of them.
std::vector<double> shares_around(const std::vector<char>& marked, double frames, bool loops) {
  std::vector<double> out;
  const auto count = static_cast<int>(marked.size()), reach = static_cast<int>(std::ceil(frames));
  const auto is_marked = [&](int g) {
    const int last = count - 1;
    if (loops && last > 0) g = ((g % last) + last) % last;
    const bool is_end = loops && g == 0 && marked.back() != 0;  // the last frame is the first again
    return is_end || (g >= 0 && g < count && marked[static_cast<std::size_t>(g)] != 0);
  };
  for (int f = 0; f < count; ++f) {
    double near = HUGE_VAL;
    for (int d = -reach; d <= reach; ++d) {
      if (is_marked(f + d)) near = std::min(near, std::abs(double(d)));
    }
    const double share = std::clamp(1 - near / frames, 0.0, 1.0);
    out.push_back(share * share * (3 - 2 * share));
  }
  return out;
}

// Makes turns around the marked frames rise and fall more slowly, by turning more where they are small.
void spread(const TurnedClip& clip, Index joint, const std::vector<double>& shares, double most, bool loops,
            Turns& turns) {
  const auto frames = static_cast<std::size_t>(clip.frames());
  const auto at = [&](std::size_t f) -> Vec3& { return turns[f * clip.count() + joint]; };
  const auto pull = [&](std::size_t f, const Vec3& from) {
    const Vec3 apart = at(f) - from;
    if (shares[f] == 0 || at(f).norm() > from.norm() || apart.norm() <= most) return;
    at(f) = clip.within_limits(static_cast<int>(f), joint, at(f) + shares[f] * (most / apart.norm() - 1) * apart, 4);
  };
  for (int turn = 0; turn < (loops ? 2 : 1); ++turn) {  // the second time from the seam on
    for (std::size_t f = 1; f < frames; ++f) pull(f, at(f - 1));
    if (loops) at(0) = at(frames - 1);
    for (std::size_t f = frames - 1; f-- > 0;) pull(f, at(f + 1));
    if (loops) at(frames - 1) = at(0);
  }
}

// Smooths a joint's turns with a Gaussian whose standard deviation is `frames` times each frame's share.
void smooth(const TurnedClip& clip, Index joint, const std::vector<double>& shares, double frames, bool loops,
            Turns& turns) {
  std::vector<Vec3> from;
  for (std::size_t i = joint; i < turns.size(); i += clip.count()) from.push_back(turns[i]);
  const int last = clip.frames() - 1;
  for (int f = 0; f <= last; ++f) {
    const double width = frames * shares[static_cast<std::size_t>(f)];
    if (width < 0.1) continue;
    const int reach = static_cast<int>(std::ceil(3 * width));
    Vec3 sum = Vec3::Zero();
    double weights = 0;
    for (int d = -reach; d <= reach; ++d) {
      int g = f + d;
      if (loops && last > 0) g = ((g % last) + last) % last;
      const double weight = std::exp(-0.5 * d * d / (width * width));
      sum += weight * from[static_cast<std::size_t>(std::clamp(g, 0, last))];
      weights += weight;
    }
    turns[static_cast<std::size_t>(f) * clip.count() + joint] = sum / weights;
  }
}

}  // namespace

void fade_out(const TurnedClip& clip, Index joint, const std::vector<char>& marked, double seconds, double least,
              bool loops, Turns& turns) {
  const std::vector<double> shares = shares_around(marked, seconds * clip.fps() + 1, loops);
  for (std::size_t f = 0; f < shares.size(); ++f) turns[f * clip.count() + joint] *= 1 - (1 - least) * shares[f];
}

MarkedTurns shaking_turns(const TurnedClip& clip, const Turns& turns, double height) {
  const auto frames = static_cast<std::size_t>(clip.frames());
  const EndSteps steps(clip, turns, height);
  const auto pad = static_cast<std::size_t>(std::ceil(kWindowPad * clip.fps()));
  MarkedTurns out;
  for (std::size_t e = 0; e < steps.ends().size(); ++e) {
    const auto at = [&](std::size_t k, std::size_t f) {
      return k == 0 ? steps.before(e, static_cast<int>(f)) : steps.after(e, static_cast<int>(f));
    };
    std::vector<std::array<double, 3>> jerks(frames, {0, 0, 0});  // before, after, and what is not seen
    std::vector<char> marked(frames, 0);
    for (std::size_t f = 1; f < frames; ++f) {
      const Vec3 moved = at(1, f) - at(0, f);
      if (steps.extra(e, static_cast<int>(f)) > EndSteps::kStepMax) marked[f] = marked[f - 1] = 1;
      if (f < 3 || moved.norm() < kMovedAtAll * height) continue;
      for (std::size_t k = 0; k < 2; ++k) {
        jerks[f][k] = (at(k, f) - 3 * at(k, f - 1) + 3 * at(k, f - 2) - at(k, f - 3)).norm();
      }
      jerks[f][2] = kCalm * height / std::pow(clip.fps(), 3);
    }
    for (std::size_t f = 0; f < frames; ++f) {
      double sums[3] = {};
      for (std::size_t g = f - std::min(f, pad); g <= std::min(f + pad, frames - 1); ++g) {
        for (std::size_t k = 0; k < 3; ++k) sums[k] += jerks[g][k];
      }
      if (sums[1] > kShaky * sums[0] + sums[2]) marked[f] = 1;
    }
    if (std::find(marked.begin(), marked.end(), 1) == marked.end()) continue;
    for (const Index above : clip.above_joint(steps.ends()[e].joint)) {
      std::vector<char>& all = out.try_emplace(above, frames, 0).first->second;
      for (std::size_t f = 0; f < frames; ++f) all[f] = static_cast<char>(all[f] | marked[f]);
    }
  }
  return out;
}

void calm_turns(const TurnedClip& clip, double height, bool loops, Turns& turns) {
  MarkedTurns shaking = shaking_turns(clip, turns, height);
  const double pad = kWindowPad * clip.fps();
  for (int attempt = 0; attempt <= kSmoothings + kFadeSteps && !shaking.empty(); ++attempt) {
    for (const auto& [joint, marked] : shaking) {
      if (attempt >= kSmoothings) {
        fade_out(clip, joint, marked, kWindowPad, attempt == kSmoothings + kFadeSteps ? 0 : kFade, loops, turns);
        continue;
      }
      spread(clip, joint, shares_around(marked, 4 * pad, loops), kSpread / (1 + attempt), loops, turns);
      smooth(clip, joint, shares_around(marked, pad, loops), 1 + 0.5 * attempt, loops, turns);
    }
    shaking = shaking_turns(clip, turns, height);
  }
}

}  // namespace spherechain::baker

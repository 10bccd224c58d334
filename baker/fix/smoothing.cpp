// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/smoothing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace spherechain::baker {
namespace {

constexpr double kShaky = 1.5;        // ratio of the jerk to that of the source clip
constexpr double kCalm = 5;           // heights per second^3: an invisible jerk
constexpr double kMovedAtAll = 2e-3;  // heights
constexpr double kSmoothingMax = 4;   // frames

}  // namespace

void fade_out(const TurnedClip& clip, Index joint, const std::vector<char>& fails, double seconds, bool loops,
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

std::set<Index> shaking_joints(const TurnedClip& clip, const std::vector<std::size_t>& span, const Turns& turns,
                               double height) {
  std::set<Index> out;
  const Turns none(turns.size(), Vec3::Zero());
  std::map<std::size_t, std::array<std::vector<Affine>, 2>> poses;  // by frame: before and after
  const auto axes = [&](std::size_t frame, std::size_t k, Index joint) {
    auto& both = poses[frame];
    if (both[0].empty()) {
      both = {clip.pose(static_cast<double>(frame), none).axes, clip.pose(static_cast<double>(frame), turns).axes};
    }
    return Vec3(both[k][joint].translation());
  };
  for (Index j = 0; j < clip.count(); ++j) {
    double sums[2] = {};
    double count = 0;
    for (const std::size_t f : span) {
      if (f < 3 || (axes(f, 0, j) - axes(f, 1, j)).norm() < kMovedAtAll * height) continue;
      ++count;
      for (std::size_t k = 0; k < 2; ++k) {
        sums[k] += (axes(f, k, j) - 3 * axes(f - 1, k, j) + 3 * axes(f - 2, k, j) - axes(f - 3, k, j)).norm();
      }
    }
    if (sums[1] > kShaky * sums[0] + kCalm * count * height / std::pow(clip.fps(), 3)) {
      const std::vector<Index> all = clip.above_joint(j);
      out.insert(all.begin(), all.end());
    }
  }
  return out;
}

void smooth(const TurnedClip& clip, Index joint, const std::vector<std::size_t>& span, double frames, bool loops,
            Turns& turns) {
  std::vector<Vec3> from;
  for (std::size_t i = joint; i < turns.size(); i += clip.count()) from.push_back(turns[i]);
  const int reach = static_cast<int>(std::ceil(3 * frames)), last = clip.frames() - 1;
  for (const std::size_t f : span) {
    Vec3 sum = Vec3::Zero();
    double weights = 0;
    for (int d = -reach; d <= reach; ++d) {
      int g = static_cast<int>(f) + d;
      if (loops && last > 0) g = ((g % last) + last) % last;
      if (g < 0 || g > last) continue;
      const double weight = std::exp(-0.5 * d * d / (frames * frames));
      sum += weight * from[static_cast<std::size_t>(g)];
      weights += weight;
    }
    turns[f * clip.count() + joint] = sum / weights;
  }
}

void calm_turns(const TurnedClip& clip, const std::vector<std::vector<std::size_t>>& runs, double height, bool loops,
                Turns& turns) {
  for (const std::vector<std::size_t>& run : runs) {
    std::set<Index> joints = shaking_joints(clip, run, turns, height);
    for (double frames = 1; frames <= kSmoothingMax && !joints.empty(); frames *= 2) {
      for (const Index joint : joints) smooth(clip, joint, run, frames, loops, turns);
      joints = shaking_joints(clip, run, turns, height);
    }
    for (const Index joint : joints) {
      for (const std::size_t f : run) turns[f * clip.count() + joint].setZero();
    }
  }
}

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#include "fix/ways_out.h"

#include <algorithm>
#include <cmath>

namespace spherechain::baker {
namespace {

constexpr int kLevels = 6;       // angles that are tried, up to the budget
constexpr int kMoves = 3;        // joints that are turned one after another
constexpr int kHalvings = 3;     // of the last step to the way out
constexpr double kWorthIt = .9;  // of what is in each other: a move that leaves more is none

// To the faces and corners of a cube.
std::vector<Vec3> axes_to_try() {
  std::vector<Vec3> out;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        const int sides = std::abs(x) + std::abs(y) + std::abs(z);
        if (sides == 1 || sides == 3) out.push_back(Vec3(x, y, z).normalized());
      }
    }
  }
  return out;
}

struct Found {
  std::vector<Vec3> turns;
  double left;  // what is in each other
};

class Search {
 public:
  Search(const TurnedClip& clip, const LimbInTrouble& limb, double budget, const Turns& start, const JudgePoses& judge)
      : clip_(clip), limb_(limb), budget_(budget), start_(start), judge_(judge) {}

  std::map<int, std::vector<Vec3>> run() const {
    std::map<int, std::vector<Vec3>> out;
    out[limb_.worst] = free(limb_.worst, none(limb_.worst));
    for (int f = limb_.worst + 1; f <= limb_.to; ++f) out[f] = free(f, out[f - 1]);
    for (int f = limb_.worst - 1; f >= limb_.from; --f) out[f] = free(f, out[f + 1]);
    return out;
  }

 private:
  std::vector<Vec3> none(int frame) const {
    const auto first = start_.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(frame) * clip_.count());
    std::vector<Vec3> out(first, first + static_cast<std::ptrdiff_t>(clip_.count()));
    for (const Index joint : limb_.joints) out[joint].setZero();
    return out;
  }

  double price(const std::vector<Vec3>& turns) const {
    double sum = 0;
    for (const Index joint : limb_.joints) sum += turns[joint].dot(clip_.joints()[joint].price * turns[joint]);
    return sum;
  }

  // Those of the limb's joints, a share of the way.
  std::vector<Vec3> scaled(int frame, const std::vector<Vec3>& turns, double share) const {
    std::vector<Vec3> out = none(frame);
    for (const Index joint : limb_.joints) {
      out[joint] = share * turns[joint];
      if (out[joint].norm() > budget_) out[joint] *= budget_ / out[joint].norm();
    }
    return out;
  }

  // As `neighbour` does, as far as it must; else by what frees it.
  std::vector<Vec3> free(int frame, const std::vector<Vec3>& neighbour) const {
    Found best = follow(frame, neighbour);
    if (best.left == 0) return best.turns;
    for (int move = 0; move < kMoves && best.left > 0; ++move) {
      Found next = turn_one(frame, best);
      if (next.left > kWorthIt * best.left) break;
      best = std::move(next);
    }
    return best.left == 0 ? follow(frame, best.turns).turns : best.turns;
  }

  // The least share of a way that frees a frame; without one the best.
  Found follow(int frame, const std::vector<Vec3>& way) const {
    constexpr double kShares[] = {0, .25, .5, .75, 1, 1.2};
    std::vector<TriedPose> poses;
    for (const double share : kShares) poses.push_back({frame, scaled(frame, way, share)});
    const std::vector<double> left = judge_(poses);
    const auto best = static_cast<std::size_t>(std::min_element(left.begin(), left.end()) - left.begin());
    if (left[best] > 0 || best == 0) return {poses[best].turns, left[best]};
    double in = kShares[best - 1], out = kShares[best];
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = (in + out) / 2;
      (judge_({{frame, scaled(frame, way, middle)}})[0] == 0 ? out : in) = middle;
    }
    return {scaled(frame, way, out), 0};
  }

  // One joint more, by the least angle that frees; without one by the best.
  Found turn_one(int frame, const Found& from) const {
    static const std::vector<Vec3> kAxes = axes_to_try();
    Found best = from;
    for (int level = 1; level <= kLevels; ++level) {
      std::vector<TriedPose> poses;
      for (const Index joint : limb_.joints) {
        for (const Vec3& axis : kAxes) {
          std::vector<Vec3> turns = from.turns;
          turns[joint] += budget_ * level / kLevels * axis;
          if (turns[joint].norm() <= budget_ * (1 + 1e-9)) poses.push_back({frame, std::move(turns)});
        }
      }
      const std::vector<double> left = judge_(poses);
      for (std::size_t i = 0; i < poses.size(); ++i) {
        const bool is_cheaper =
            left[i] == best.left && best.left < from.left && price(poses[i].turns) < price(best.turns);
        if (left[i] < best.left || is_cheaper) best = {poses[i].turns, left[i]};
      }
      if (best.left == 0) break;
    }
    return best;
  }

  const TurnedClip& clip_;
  const LimbInTrouble& limb_;
  double budget_;
  const Turns& start_;
  const JudgePoses& judge_;
};

}  // namespace

std::map<int, std::vector<Vec3>> find_way_out(const TurnedClip& clip, const LimbInTrouble& limb, double budget,
                                              const Turns& start, const JudgePoses& judge) {
  return Search(clip, limb, budget, start, judge).run();
}

}  // namespace spherechain::baker

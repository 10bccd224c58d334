// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/ways_out.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "baker/fix/part_joints.h"

namespace spherechain::baker {
namespace {

constexpr int kFramesMax = 40;   // frames of a limb that are searched; between them, turns are blended
constexpr int kLevels = 6;       // number of angles to try, up to the budget
constexpr int kMoves = 3;        // largest number of joints to turn one after another
constexpr int kHalvings = 3;     // bisections of the last step to the way out
constexpr double kWorthIt = .9;  // a move must leave less than this share of the penetration
constexpr std::size_t kWays = 8;
constexpr double kLeft = 1e4;      // cost of one height of residual penetration, relative to a radian at a shoulder
constexpr double kSteadyWay = .1;  // seconds: faster changes are expensive

// Directions to the faces and corners of a cube.
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
  double left;  // residual penetration
};

class Search {
 public:
  Search(const TurnedClip& clip, const LimbInTrouble& limb, double budget, const Turns& start,
         const EvaluatePoses& evaluate)
      : clip_(clip), limb_(limb), budget_(budget), start_(start), evaluate_(evaluate) {
    const int step = (limb.to - limb.from) / kFramesMax + 1;
    std::set<int> frames(limb.worst.begin(), limb.worst.end());
    for (int f = limb.from; f < limb.to; f += step) frames.insert(f);
    frames.insert(limb.to);
    frames_.assign(frames.begin(), frames.end());
  }

  std::map<int, std::vector<Vec3>> run() {
    follow(none(limb_.from));
    for (const int frame : limb_.worst) {
      if (ways_ < kWays && best(frame).left > 0) add_way(frame);
    }
    // Adds candidates for the frames that none of them frees.
    std::set<int> hopeless;
    while (ways_ < kWays) {
      int worst = -1;
      double most = 0;
      for (const int f : frames_) {
        if (hopeless.contains(f) || best(f).left <= most) continue;
        most = best(f).left;
        worst = f;
      }
      if (worst < 0) break;
      add_way(worst);
      if (best(worst).left > 0) hopeless.insert(worst);
    }
    return blended(steadiest());
  }

 private:
  std::vector<Vec3> none(int frame) const {
    const auto first = start_.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(frame) * clip_.count());
    std::vector<Vec3> out(first, first + static_cast<std::ptrdiff_t>(clip_.count()));
    for (const Index joint : limb_.joints) out[joint].setZero();
    return out;
  }

  double cost(const std::vector<Vec3>& turns) const {
    double sum = 0;
    for (const Index joint : limb_.joints) sum += turns[joint].dot(clip_.joints()[joint].cost * turns[joint]);
    return sum;
  }

  // The turns of the limb's joints, times `share`.
  std::vector<Vec3> scaled(int frame, const std::vector<Vec3>& turns, double share) const {
    std::vector<Vec3> out = none(frame);
    for (const Index joint : limb_.joints) {
      out[joint] = clip_.within_limits(frame, joint, share * turns[joint], budget_);
    }
    return out;
  }

  const Found& best(int frame) const {
    const std::vector<Found>& found = found_.at(frame);
    return *std::min_element(found.begin(), found.end(),
                             [](const Found& a, const Found& b) { return a.left < b.left; });
  }

  // Finds the turns that free a frame best, and the share of them that every other frame needs.
  void add_way(int frame) {
    Found way = best(frame);
    for (int move = 0; move < kMoves && way.left > 0; ++move) {
      Found next = turn_one(frame, way);
      if (next.left > kWorthIt * way.left) break;
      way = std::move(next);
    }
    follow(way.turns);
    ++ways_;
  }

  // Chooses one candidate per frame: the cheapest path through all frames.
  std::map<int, std::vector<Vec3>> steadiest() const {
    const double steady = std::pow(kSteadyWay * clip_.fps(), 2);
    std::vector<std::vector<double>> sums;
    std::vector<std::vector<std::size_t>> from;
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      sums.emplace_back();
      from.emplace_back();
      for (const Found& to : found_.at(frames_[i])) {
        double least = i == 0 ? 0 : HUGE_VAL;
        std::size_t chosen = 0;
        for (std::size_t k = 0; i > 0 && k < sums[i - 1].size(); ++k) {
          std::vector<Vec3> change = to.turns;
          for (const Index joint : limb_.joints) change[joint] -= found_.at(frames_[i - 1])[k].turns[joint];
          const double sum = sums[i - 1][k] + steady * cost(change) / (frames_[i] - frames_[i - 1]);
          if (sum < least) chosen = k;
          least = std::min(least, sum);
        }
        sums.back().push_back(least + cost(to.turns) + kLeft * to.left);
        from.back().push_back(chosen);
      }
    }
    std::map<int, std::vector<Vec3>> out;
    auto at = static_cast<std::size_t>(std::min_element(sums.back().begin(), sums.back().end()) - sums.back().begin());
    for (std::size_t i = frames_.size(); i-- > 0; at = from[i][at]) out[frames_[i]] = found_.at(frames_[i])[at].turns;
    return out;
  }

  // Adds the frames between those that were searched.
  std::map<int, std::vector<Vec3>> blended(std::map<int, std::vector<Vec3>> out) const {
    for (std::size_t i = 1; i < frames_.size(); ++i) {
      const int first = frames_[i - 1], last = frames_[i];
      for (int f = first + 1; f < last; ++f) {
        const double share = static_cast<double>(f - first) / (last - first);
        std::vector<Vec3> turns = none(f);
        for (const Index joint : limb_.joints) {
          turns[joint] =
              clip_.within_limits(f, joint, (1 - share) * out.at(first)[joint] + share * out.at(last)[joint], budget_);
        }
        out[f] = std::move(turns);
      }
    }
    return out;
  }

  // Finds the least share of a candidate that frees each frame, or else the best share.
  void follow(const std::vector<Vec3>& way) {
    constexpr std::array<double, 6> kShares{0, .25, .5, .75, 1, 1.2};
    std::vector<TriedPose> poses;
    for (const int f : frames_) {
      for (const double share : kShares) poses.push_back({f, scaled(f, way, share)});
    }
    const std::vector<double> left = evaluate_(poses);
    struct Bracket {
      int frame;
      double in, out;
    };
    std::vector<Bracket> brackets;
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      const int f = frames_[i];
      const std::size_t first = i * kShares.size();
      const auto begin = left.begin() + static_cast<std::ptrdiff_t>(first);
      const auto best = static_cast<std::size_t>(std::min_element(begin, begin + kShares.size()) - begin);
      found_[f].push_back({std::move(poses[first + best].turns), left[first + best]});
      if (left[first + best] == 0 && best > 0) brackets.push_back({f, kShares[best - 1], kShares[best]});
    }
    for (int i = 0; i < kHalvings; ++i) {
      poses.clear();
      for (const Bracket& b : brackets) poses.push_back({b.frame, scaled(b.frame, way, (b.in + b.out) / 2)});
      const std::vector<double> middle = evaluate_(poses);
      for (std::size_t k = 0; k < brackets.size(); ++k) {
        Bracket& b = brackets[k];
        (middle[k] == 0 ? b.out : b.in) = (b.in + b.out) / 2;
        found_[b.frame].back().turns = scaled(b.frame, way, b.out);
      }
    }
  }

  // Turns one more joint: by the least angle that frees the frame, or else by the best one.
  Found turn_one(int frame, const Found& from) const {
    static const std::vector<Vec3> kAxes = axes_to_try();
    Found best = from;
    for (int level = 1; level <= kLevels; ++level) {
      std::vector<TriedPose> poses;
      for (const Index joint : limb_.joints) {
        for (const Vec3& axis : kAxes) {
          std::vector<Vec3> turns = from.turns;
          const Vec3 wanted = turns[joint] + budget_ * level / kLevels * axis;
          turns[joint] = clip_.within_limits(frame, joint, wanted, budget_);
          poses.push_back({frame, std::move(turns)});
        }
      }
      const std::vector<double> left = evaluate_(poses);
      for (std::size_t i = 0; i < poses.size(); ++i) {
        const bool is_cheaper =
            left[i] == best.left && best.left < from.left && cost(poses[i].turns) < cost(best.turns);
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
  const EvaluatePoses& evaluate_;
  std::vector<int> frames_;  // that are searched
  std::size_t ways_ = 0;
  std::map<int, std::vector<Found>> found_;  // by frame: the frame itself, then each candidate
};

}  // namespace

std::map<int, std::vector<Vec3>> find_way_out(const TurnedClip& clip, const LimbInTrouble& limb, double budget,
                                              const Turns& start, const EvaluatePoses& evaluate) {
  return Search(clip, limb, budget, start, evaluate).run();
}

}  // namespace spherechain::baker

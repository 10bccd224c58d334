// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/best_rounds.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace spherechain::baker {
namespace {

constexpr double kLeftInRound = 1e4;  // cost of one height of residual penetration, relative to a radian at a shoulder
constexpr double kSteadyChoice = .3;  // seconds: a choice that changes faster is expensive

struct Round {
  Turns turns;
  std::vector<double> left;  // by frame: residual penetration, in the source's units
};

std::vector<double> residuals_by_frame(const Goals& goals, const std::vector<PosePenetration>& found,
                                       std::size_t frames) {
  std::vector<double> out(frames, 0);
  for (const PosePenetration& one : found) {
    // Touches count, too: what was pushed apart is to stay apart.
    const double left = double{one.found.measures.depth} - std::max(goals.allowed(one), 0.0);
    if (!goals.is_let_be(one)) out[static_cast<std::size_t>(one.frame)] += left;
  }
  return out;
}

// The source clip, then each round. Frames that a round did not measure are those of the source clip.
std::vector<Round> rounds_of(const MendState& state) {
  const std::size_t frames = state.in_window.size(), count = state.facts.clip.count();
  std::vector<PosePenetration> source;
  for (const auto& [place, found] : state.goals.before()) source.push_back({place.frame, found});
  std::vector<Round> out{{Turns(state.turns.size(), Vec3::Zero()), residuals_by_frame(state.goals, source, frames)}};
  for (const MeasuredRound& round : state.rounds) {
    out.push_back({round.turns, residuals_by_frame(state.goals, round.found, frames)});
    for (std::size_t f = 0; f < frames; ++f) {
      if (round.in_window[f] != 0) continue;
      out.back().left[f] = out.front().left[f];
      std::fill_n(out.back().turns.begin() + static_cast<std::ptrdiff_t>(f * count), count, Vec3::Zero());
    }
  }
  return out;
}

// The cheapest path through the rounds, frame by frame.
class BestPath {
 public:
  BestPath(const MendState& state, const std::vector<Round>& rounds)
      : clip_(state.facts.clip), height_(state.facts.height), rounds_(rounds) {}

  // The round of each frame. `ends`: the round of the first and of the last one, or kAny.
  std::vector<std::size_t> find(std::size_t ends) const {
    const double steady = std::pow(kSteadyChoice * clip_.fps(), 2);
    const auto frames = static_cast<std::size_t>(clip_.frames());
    std::vector<double> sums;
    std::vector<std::vector<std::size_t>> from(frames);
    for (std::size_t f = 0; f < frames; ++f) {
      std::vector<double> next;
      for (std::size_t r = 0; r < rounds_.size(); ++r) {
        const bool is_barred = (f == 0 || f + 1 == frames) && ends != kAny && r != ends;
        double least = f == 0 ? 0 : HUGE_VAL;
        from[f].push_back(0);
        for (std::size_t s = 0; f > 0 && s < rounds_.size(); ++s) {
          const double sum = sums[s] + steady * cost(r, f, &rounds_[s]);
          if (sum < least) from[f].back() = s;
          least = std::min(least, sum);
        }
        next.push_back(is_barred ? HUGE_VAL
                                 : least + cost(r, f, nullptr) + kLeftInRound * rounds_[r].left[f] / height_);
      }
      sums = std::move(next);
    }
    std::vector<std::size_t> out(frames);
    auto at = static_cast<std::size_t>(std::min_element(sums.begin(), sums.end()) - sums.begin());
    for (std::size_t f = frames; f-- > 0; at = from[f][at]) out[f] = at;
    return out;
  }

  static constexpr std::size_t kAny = static_cast<std::size_t>(-1);

 private:
  // Costs of the turns of a round in a frame; with `before`, of their change since that round in the frame before.
  double cost(std::size_t round, std::size_t frame, const Round* before) const {
    double sum = 0;
    for (Index j = 0; j < clip_.count(); ++j) {
      Vec3 turn = rounds_[round].turns[frame * clip_.count() + j];
      if (before != nullptr) turn -= before->turns[(frame - 1) * clip_.count() + j];
      sum += turn.dot(clip_.joints()[j].cost * turn);
    }
    return sum;
  }

  const TurnedClip& clip_;
  double height_;
  const std::vector<Round>& rounds_;
};

}  // namespace

void take_best_rounds(MendState& state) {
  const std::vector<Round> rounds = rounds_of(state);
  const BestPath path(state, rounds);
  std::vector<std::size_t> chosen = path.find(BestPath::kAny);
  if (state.facts.loops && chosen.front() != chosen.back()) chosen = path.find(chosen.front());
  const std::size_t count = state.facts.clip.count();
  for (std::size_t f = 0; f < chosen.size(); ++f) {
    const auto first = static_cast<std::ptrdiff_t>(f * count);
    std::copy_n(rounds[chosen[f]].turns.begin() + first, count, state.turns.begin() + first);
  }
}

}  // namespace spherechain::baker

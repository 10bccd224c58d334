// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibrate/reach.h"

#include <algorithm>
#include <array>

namespace spherechain::baker {
namespace {

constexpr double kRestWorth = 25, kWorth = 12;  // false alarms that a contact is worth: of a rest pair; of another
constexpr double kAtRest = 10;                  // contacts that a rest pair is taken to have where it nearly touches
constexpr double kBorrowed = 3;                 // average pairs, from each sphere and from the body
constexpr double kReachMin = 0.7;               // of pairs that are no rest pairs

// What reporting below a distance gains, by the distance as a part of the radii's sum, in steps.
class Gain {
 public:
  void add(const SampledPair& pair, double worth) {
    for (const PairSample& sample : pair.samples) {
      const double part = sample.distance / (double{sample.radius_a} + sample.radius_b);
      steps_[std::min(static_cast<std::size_t>(part / kStep), kSteps - 1)] += sample.touch ? worth : -1;
    }
  }
  // A contact at a distance that is a part of the radii's sum.
  void add_contact(double part, double worth) {
    steps_[std::min(static_cast<std::size_t>(part / kStep), kSteps - 1)] += worth;
  }
  void add(const Gain& other, double times) {
    for (std::size_t i = 0; i < kSteps; ++i) steps_[i] += times * other.steps_[i];
  }
  // The distance that gains most; 0 where none gains anything.
  double best() const {
    double sum = 0, most = 0, best = 0;
    for (std::size_t i = 0; i < kSteps; ++i) {
      sum += steps_[i];
      if (sum <= most) continue;
      most = sum;
      best = kStep * static_cast<double>(i + 1);
    }
    return best;
  }

 private:
  static constexpr std::size_t kSteps = 200;
  static constexpr double kStep = kSampledReach / kSteps;

  std::array<double, kSteps> steps_{};
};

// The sum of some pairs' gains.
struct Pool {
  Gain sum;
  std::size_t pairs = 0;

  void add(const Gain& gain) {
    sum.add(gain, 1);
    ++pairs;
  }
  void lend(Gain& to) const {
    if (pairs > 0) to.add(sum, kBorrowed / static_cast<double>(pairs));
  }
};

}  // namespace

std::vector<double> best_reaches(const std::vector<SampledPair>& pairs,
                                 const std::vector<std::optional<double>>& at_rest, std::size_t sphere_count) {
  std::vector<Gain> gains(pairs.size());
  std::vector<Pool> of_sphere(sphere_count);
  Pool of_body;
  bool any = false;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    any = any || !pairs[i].samples.empty();
    gains[i].add(pairs[i], at_rest[i] ? kRestWorth : kWorth);
    if (at_rest[i]) {
      gains[i].add_contact(*at_rest[i], kAtRest * kRestWorth);
      continue;
    }
    for (Pool* pool : {&of_sphere[pairs[i].spheres.a], &of_sphere[pairs[i].spheres.b], &of_body}) pool->add(gains[i]);
  }
  std::vector<double> reaches;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (at_rest[i]) {
      reaches.push_back(gains[i].best());
      continue;
    }
    Gain gain = gains[i];
    for (const Pool* pool : {&of_sphere[pairs[i].spheres.a], &of_sphere[pairs[i].spheres.b], &of_body})
      pool->lend(gain);
    reaches.push_back(any ? std::max(kReachMin, gain.best()) : 1);
  }
  return reaches;
}

std::vector<double> radius_factors(const std::vector<SampledPair>& pairs, const std::vector<double>& reaches,
                                   const std::vector<double>& radii, const std::vector<double>& least) {
  constexpr int kRounds = 6;
  std::vector<double> factors = least;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    for (const std::uint32_t s : {pairs[i].spheres.a, pairs[i].spheres.b})
      factors[s] = std::max(factors[s], reaches[i]);
  }
  // Every pair reaches far enough now. Each sphere goes halfway to what it needs while the others stay: a pair's sum
  // then is no less than halfway between what it was and what it should be.
  for (int round = 0; round < kRounds; ++round) {
    std::vector<double> needed = least;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const auto [a, b] = pairs[i].spheres;
      const double sum = reaches[i] * (radii[a] + radii[b]);
      needed[a] = std::max(needed[a], (sum - factors[b] * radii[b]) / radii[a]);
      needed[b] = std::max(needed[b], (sum - factors[a] * radii[a]) / radii[b]);
    }
    for (std::size_t s = 0; s < factors.size(); ++s) factors[s] = 0.5 * (factors[s] + needed[s]);
  }
  return factors;
}

std::size_t false_alarms_beyond(const SampledPair& pair, double reach, double factor_a, double factor_b) {
  return static_cast<std::size_t>(
      std::count_if(pair.samples.begin(), pair.samples.end(), [&](const PairSample& sample) {
        return !sample.touch && sample.distance >= reach * (double{sample.radius_a} + sample.radius_b) &&
               sample.distance < factor_a * sample.radius_a + factor_b * sample.radius_b;
      }));
}

}  // namespace spherechain::baker

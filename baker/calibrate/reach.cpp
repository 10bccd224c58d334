// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/calibrate/reach.h"

#include <algorithm>
#include <array>

namespace spherechain::baker {
namespace {

constexpr double kWorthMin = 8, kWorthMax = 200, kWorthStep = 1.1;  // false alarms that a contact is worth
constexpr double kWorthUnknown = 12;                                // the least where no pose is expected
constexpr double kRecall = 0.95, kOtherRecall = 0.85;  // contacts to find: of expected poses; of the others
constexpr double kExpected = 4;                        // other poses that an expected one counts for
constexpr double kBorrowed = 1;                        // average pairs, from each sphere and from the body
constexpr double kReachMin = 0.3;                      // of pairs that are no rest pairs
constexpr double kRestReachMin = 0.5;                  // of what a rest pair should reach for what it is at rest

constexpr std::size_t kSteps = 200;
constexpr double kStep = kSampledReach / kSteps;

// Distances are quantised in steps, as parts of the radii's sum.
std::size_t step_of(double part) {
  return part > 0 ? std::min(static_cast<std::size_t>(part / kStep), kSteps - 1) : std::size_t{0};
}
std::size_t step_of(const PairSample& sample) {
  return step_of(sample.distance / (double{sample.radius_a} + sample.radius_b));
}

// Contacts and false alarms by distance.
struct Evidence {
  std::array<double, kSteps> contacts{}, alarms{};

  void add(const SampledPair& pair) {
    for (const PairSample& sample : pair.samples) {
      (sample.touch ? contacts : alarms)[step_of(sample)] += sample.expected ? kExpected : 1;
    }
  }
  void add(const Evidence& other, double times) {
    for (std::size_t i = 0; i < kSteps; ++i) {
      contacts[i] += times * other.contacts[i];
      alarms[i] += times * other.alarms[i];
    }
  }
  // The distance below which reports gain most; 0 where none gains anything.
  double best(double worth) const {
    double sum = 0, most = 0, best = 0;
    for (std::size_t i = 0; i < kSteps; ++i) {
      sum += worth * contacts[i] - alarms[i];
      if (sum <= most) continue;
      most = sum;
      best = kStep * static_cast<double>(i + 1);
    }
    return best;
  }
};

// The sum of some pairs' evidence.
struct Pool {
  Evidence sum;
  std::size_t pairs = 0;

  void add(const Evidence& evidence) {
    sum.add(evidence, 1);
    ++pairs;
  }
  void lend(Evidence& to) const {
    if (pairs > 0) to.add(sum, kBorrowed / static_cast<double>(pairs));
  }
};

// Evidence for each pair: its own samples, its state at rest, and samples borrowed from pairs of the same spheres.
std::vector<Evidence> evidence_of(const std::vector<SampledPair>& pairs,
                                  const std::vector<std::optional<double>>& at_rest, std::size_t sphere_count) {
  std::vector<Evidence> evidence(pairs.size());
  std::vector<Pool> of_sphere(sphere_count);
  Pool of_body;
  const auto pools = [&](const Pair& pair) { return std::array{&of_sphere[pair.a], &of_sphere[pair.b], &of_body}; };
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    evidence[i].add(pairs[i]);
    if (at_rest[i]) {
      evidence[i].contacts[step_of(*at_rest[i])] += kExpected;
    } else {
      for (Pool* pool : pools(pairs[i].spheres)) pool->add(evidence[i]);
    }
  }
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (at_rest[i]) continue;
    for (const Pool* pool : pools(pairs[i].spheres)) pool->lend(evidence[i]);
  }
  return evidence;
}

bool any_expected(const std::vector<SampledPair>& pairs) {
  return std::any_of(pairs.begin(), pairs.end(), [](const SampledPair& pair) {
    return std::any_of(pair.samples.begin(), pair.samples.end(), [](const auto& sample) { return sample.expected; });
  });
}

// Whether enough contacts are nearer than `reaches`.
bool find_enough(const std::vector<SampledPair>& pairs, const std::vector<double>& reaches) {
  struct Share {
    std::size_t found = 0, all = 0;
    bool is_at_least(double part) const { return static_cast<double>(found) >= part * static_cast<double>(all); }
  };
  Share expected, others;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    for (const PairSample& sample : pairs[i].samples) {
      if (!sample.touch) continue;
      Share& share = sample.expected ? expected : others;
      ++share.all;
      if (sample.distance < reaches[i] * (double{sample.radius_a} + sample.radius_b)) ++share.found;
    }
  }
  return expected.is_at_least(kRecall) && others.is_at_least(kOtherRecall);
}

}  // namespace

std::vector<double> best_reaches(const std::vector<SampledPair>& pairs,
                                 const std::vector<std::optional<double>>& at_rest, std::size_t sphere_count) {
  const bool any = std::any_of(pairs.begin(), pairs.end(), [](const auto& pair) { return !pair.samples.empty(); });
  const std::vector<Evidence> evidence = evidence_of(pairs, at_rest, sphere_count);
  const auto at_worth = [&](double worth) {
    std::vector<double> reaches;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const double best = evidence[i].best(worth);
      const double least = at_rest[i] ? kRestReachMin * *at_rest[i] : any ? kReachMin : 1;
      reaches.push_back(std::max(least, best));
    }
    return reaches;
  };
  double worth = any_expected(pairs) ? kWorthMin : kWorthUnknown;
  std::vector<double> reaches = at_worth(worth);
  while (worth < kWorthMax && !find_enough(pairs, reaches)) reaches = at_worth(worth *= kWorthStep);
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

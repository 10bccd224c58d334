// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibrate/reach.h"

#include <algorithm>
#include <limits>

namespace spherechain::baker {
namespace {

// False alarms that a contact is worth: of a rest pair, and where a larger radius finds it. The second is dearer: what
// is beyond all radii is never found.
constexpr double kRestWorth = 7, kGrowthWorth = 40;
// A pair must touch this often before its spheres grow: a pair that seldom touches says little.
constexpr std::size_t kTouchesMin = 6;
constexpr double kRounding = 1 + 1e-5;

// What a larger radius of a sphere could report.
struct Open {
  std::size_t other;  // the other sphere
  PairSample sample;  // a is the sphere itself
};

// What each sphere could report with larger radii.
std::vector<std::vector<Open>> open_samples(const std::vector<SampledPair>& pairs,
                                            const std::vector<bool>& is_rest_pair, std::size_t count) {
  std::vector<std::vector<Open>> open(count);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto touches = std::count_if(pairs[i].samples.begin(), pairs[i].samples.end(),
                                       [](const PairSample& sample) { return sample.touch; });
    const bool often = static_cast<std::size_t>(touches) >= kTouchesMin;
    if (is_rest_pair[i] && !often) continue;
    const double reach = is_rest_pair[i] ? best_reach(pairs[i], 1, 1) : std::numeric_limits<double>::infinity();
    const auto [a, b] = pairs[i].spheres;
    for (const PairSample& sample : pairs[i].samples) {
      const double sum = double{sample.radius_a} + sample.radius_b;
      if (sample.distance < sum || sample.distance > reach * sum) continue;
      const bool touch = sample.touch && often;
      open[a].push_back({b, {sample.distance, sample.radius_a, sample.radius_b, touch}});
      open[b].push_back({a, {sample.distance, sample.radius_b, sample.radius_a, touch}});
    }
  }
  return open;
}

}  // namespace

Line best_line(std::vector<std::pair<double, bool>> values, double worth) {
  std::sort(values.begin(), values.end());
  double gain = 0;
  Line best;
  for (const auto& [value, is_contact] : values) {
    gain += is_contact ? worth : -1;
    if (gain > best.gain) best = {kRounding * value, gain};
  }
  return best;
}

double best_reach(const SampledPair& pair, double scale_a, double scale_b) {
  std::vector<std::pair<double, bool>> values;
  for (const PairSample& sample : pair.samples) {
    values.emplace_back(sample.distance / (scale_a * sample.radius_a + scale_b * sample.radius_b), sample.touch);
  }
  return best_line(std::move(values), kRestWorth).value;
}

std::vector<double> grow_radii(const std::vector<SampledPair>& pairs, const std::vector<bool>& is_rest_pair,
                               std::size_t count) {
  constexpr int kSweeps = 3;
  const std::vector<std::vector<Open>> open = open_samples(pairs, is_rest_pair, count);
  std::vector<double> factors(count, 1);
  // The best factor of one sphere while the others keep theirs.
  const auto best_factor = [&](std::size_t sphere) {
    std::vector<std::pair<double, bool>> needed;
    for (const auto& [other, sample] : open[sphere]) {
      const double factor = (sample.distance - factors[other] * sample.radius_b) / sample.radius_a;
      if (factor >= factors[sphere]) needed.emplace_back(factor, sample.touch);
    }
    return best_line(std::move(needed), kGrowthWorth);
  };
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    std::vector<std::pair<double, std::size_t>> order;  // those that gain most first
    for (std::size_t s = 0; s < count; ++s) order.emplace_back(-best_factor(s).gain, s);
    std::sort(order.begin(), order.end());
    for (const auto& [gain, s] : order) factors[s] = std::max(factors[s], best_factor(s).value);
  }
  return factors;
}

}  // namespace spherechain::baker

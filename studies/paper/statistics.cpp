// SPDX-License-Identifier: GPL-3.0-or-later
#include "statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace spherechain::paper {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::vector<double> finite(std::vector<double> values) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  return values;
}

std::vector<double> ranks(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  std::vector<double> out(values.size());
  for (std::size_t i = 0; i < order.size();) {
    std::size_t j = i;
    while (j < order.size() && values[order[j]] == values[order[i]]) ++j;
    for (std::size_t k = i; k < j; ++k) out[order[k]] = 0.5 * static_cast<double>(i + j - 1);
    i = j;
  }
  return out;
}

struct Moments {
  double xx = 0, xy = 0, yy = 0;
};

Moments central_moments(const std::vector<double>& x, const std::vector<double>& y) {
  const double mx = mean(x), my = mean(y);
  Moments m;
  for (std::size_t i = 0; i < x.size(); ++i) {
    m.xx += (x[i] - mx) * (x[i] - mx);
    m.xy += (x[i] - mx) * (y[i] - my);
    m.yy += (y[i] - my) * (y[i] - my);
  }
  return m;
}

}  // namespace

double mean(const std::vector<double>& values) {
  const std::vector<double> v = finite(values);
  return v.empty() ? kNan : std::accumulate(v.begin(), v.end(), 0.0) / static_cast<double>(v.size());
}

double quantile(std::vector<double> values, double q) {
  values = finite(std::move(values));
  if (values.empty()) return kNan;
  std::sort(values.begin(), values.end());
  const double at = q * static_cast<double>(values.size() - 1);
  const auto i = static_cast<std::size_t>(at);
  const double next = values[std::min(i + 1, values.size() - 1)];
  return values[i] + (at - static_cast<double>(i)) * (next - values[i]);
}

double least(const std::vector<double>& values) { return quantile(values, 0); }
double most(const std::vector<double>& values) { return quantile(values, 1); }

double rank_correlation(const std::vector<double>& x, const std::vector<double>& y) {
  std::vector<double> fx, fy;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(x[i]) || !std::isfinite(y[i])) continue;
    fx.push_back(x[i]);
    fy.push_back(y[i]);
  }
  const Moments m = central_moments(ranks(fx), ranks(fy));
  return m.xx > 0 && m.yy > 0 ? m.xy / std::sqrt(m.xx * m.yy) : kNan;
}

double growth_exponent(const std::vector<double>& x, const std::vector<double>& y) {
  std::vector<double> lx, ly;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!(x[i] > 0) || !(y[i] > 0)) continue;
    lx.push_back(std::log(x[i]));
    ly.push_back(std::log(y[i]));
  }
  const Moments m = central_moments(lx, ly);
  return m.xx > 0 ? m.xy / m.xx : kNan;
}

}  // namespace spherechain::paper

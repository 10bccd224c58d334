// SPDX-License-Identifier: MIT
#include "contestants.h"

#include <algorithm>
#include <chrono>
#include <random>

#include "device.h"

namespace spherechain::bench {
namespace {

constexpr std::size_t kPasses = 41, kLaunches = 8;

}  // namespace

double Times::median() const {
  std::vector<double> sorted = values;
  std::sort(sorted.begin(), sorted.end());
  return sorted[sorted.size() / 2];
}

double Times::least() const { return *std::min_element(values.begin(), values.end()); }

double seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

void measure(std::vector<Contestant>& all, std::size_t instances) {
  DeviceClock clock;
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < kPasses * all.size(); ++i) {
    order.push_back(i % all.size());
  }
  std::shuffle(order.begin(), order.end(), std::mt19937(1));
  for (const Contestant& one : all) {
    one.enqueue();  // warm
  }
  for (const std::size_t i : order) {
    clock.start();
    for (std::size_t launch = 0; launch < kLaunches; ++launch) {
      all[i].enqueue();
    }
    all[i].times.add(clock.stop() * 1e6 / static_cast<double>(instances * kLaunches));
  }
}

void print_table(const std::vector<Contestant>& all, double tests_an_instance, const Ceilings& ceilings) {
  std::printf("  %-58s %9s %9s %16s %18s\n", "ns a character", "median", "min", "bytes, of copy", "pair tests/s");
  for (const Contestant& one : all) {
    const double median = one.times.median();
    std::printf("  %-58s %9.3f %9.3f %7.0f, %5.1f %% %14.2f e12\n", one.name.c_str(), median, one.times.least(),
                one.bytes, 100 * one.bytes / median * 1e9 / ceilings.bytes_a_second,
                tests_an_instance / median * 1e9 / 1e12);
  }
}

}  // namespace spherechain::bench

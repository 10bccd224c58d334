// SPDX-License-Identifier: MIT
// Methods that are measured against each other in one run, passes in random order.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace spherechain::bench {

constexpr std::size_t kInstances = 65536;

struct Times {
  std::vector<double> values;

  void add(double value) { values.push_back(value); }
  double median() const;
  double least() const;
};

struct Contestant {
  std::string name;
  std::function<void()> enqueue;
  double bytes = 0;  // an instance
  Times times;       // nanoseconds an instance
};

struct Ceilings {
  double bytes_a_second, multiply_adds_a_second;
};

double seconds();

// Fills in the times of launches of that many instances each.
void measure(std::vector<Contestant>& all, std::size_t instances);
void print_table(const std::vector<Contestant>& all, double tests_an_instance, const Ceilings& ceilings);

}  // namespace spherechain::bench

// SPDX-License-Identifier: GPL-3.0-or-later
// Google Benchmark times: each repetition of each contestant, in an order drawn at random over all of them, so that
// what the machine does beside hits all alike. A repetition is one pass over the poses, after one that is not timed.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace spherechain::bench {

// Nanoseconds for one pose (or character), over the repetitions.
struct Times {
  double median = 0, min = 0;
};

class Timing {
 public:
  explicit Timing(int repetitions) : repetitions_(repetitions) {}

  // A pass calls run(0) ... run(calls - 1); `per_call` is what one call does, in poses. On several threads the time is
  // the clock's, else what the process spent, so that waiting for a core of a shared machine does not count.
  void add(const std::string& name, std::size_t calls, std::function<void(std::size_t)> run, double per_call = 1,
           bool has_threads = false);
  void run_all();
  const Times& of(const std::string& name);

 private:
  struct Row {
    std::string name;
    double per_call;
    bool has_threads;
    Times times;
  };
  class Reporter;
  Row& row(const std::string& name);

  int repetitions_;
  std::vector<Row> rows_;
};

}  // namespace spherechain::bench

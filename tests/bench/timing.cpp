// SPDX-License-Identifier: GPL-3.0-or-later
#include "timing.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <stdexcept>

namespace spherechain::bench {

// Google Benchmark hands over a benchmark's repetitions together, once all have run.
class Timing::Reporter : public benchmark::BenchmarkReporter {
 public:
  explicit Reporter(Timing& timing) : timing_(timing) {}
  bool ReportContext(const Context&) override { return true; }
  void ReportRuns(const std::vector<Run>& runs) override {
    Row& row = timing_.row(runs.at(0).run_name.function_name);
    std::vector<double> times;
    for (const Run& run : runs) {
      if (run.run_type == Run::RT_Iteration) {
        const double seconds = row.has_threads ? run.real_accumulated_time : run.cpu_accumulated_time;
        times.push_back(1e9 * seconds / (static_cast<double>(run.iterations) * row.per_call));
      }
    }
    if (times.empty()) {
      return;  // its own statistics, which come after
    }
    std::sort(times.begin(), times.end());
    row.times = {times.at(times.size() / 2), times.at(0)};
  }

 private:
  Timing& timing_;
};

Timing::Row& Timing::row(const std::string& name) {
  const auto found = std::find_if(rows_.begin(), rows_.end(), [&](const Row& row) { return row.name == name; });
  if (found == rows_.end()) {
    throw std::logic_error("nothing is timed as " + name);
  }
  return *found;
}

const Times& Timing::of(const std::string& name) { return row(name).times; }

void Timing::add(const std::string& name, std::size_t calls, std::function<void(std::size_t)> run, double per_call,
                 bool has_threads) {
  rows_.push_back({name, per_call, has_threads, {}});
  auto* timed = benchmark::RegisterBenchmark(name.c_str(), [run = std::move(run), calls](benchmark::State& state) {
    std::size_t i = 0;
    while (i < calls) {
      run(i++);  // so that the contestant before leaves nothing in the caches, nor takes anything from them
    }
    i = 0;
    for ([[maybe_unused]] auto _ : state) {
      run(i++);
      benchmark::ClobberMemory();
    }
  });
  timed->Iterations(static_cast<benchmark::IterationCount>(calls))->Repetitions(repetitions_);
  if (has_threads) {
    timed->UseRealTime();
  } else {
    timed->MeasureProcessCPUTime();
  }
}

void Timing::run_all() {
  char program[] = "spherechain_bench", interleave[] = "--benchmark_enable_random_interleaving=true";
  char* arguments[] = {program, interleave, nullptr};
  int count = 2;
  benchmark::Initialize(&count, arguments);
  Reporter reporter(*this);
  benchmark::RunSpecifiedBenchmarks(&reporter);
  benchmark::Shutdown();
  for (const Row& row : rows_) {
    if (!(row.times.min > 0)) {
      throw std::runtime_error(row.name + ": not timed");
    }
  }
}

}  // namespace spherechain::bench

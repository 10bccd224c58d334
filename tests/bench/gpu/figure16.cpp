// SPDX-License-Identifier: MIT
// The paper's Figure 16: its kernels on a GPU, frame by frame, checked against the CPU's pairs and timed beside it.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <functional>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "paper_case.h"
#include "paper_runner.h"

using namespace spherechain;
using namespace spherechain::bench;
using cuda_paper::Kernel;

namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

constexpr std::size_t kRepetitions = 201;  // at most
constexpr double kSeconds = 0.2;           // for one method on one animation, about
constexpr double kSlow = 100'000;          // microseconds: see step_of()
constexpr std::size_t kSlowStep = 20;
constexpr int kFailed = 1, kPairsDiffer = 2;  // exit codes
constexpr const char* kAnimations = "arms and legs, 40 frames each";

struct GpuMethod {
  const char* key;
  Kernel kernel;
  CpuMethod same_pairs;
};
constexpr GpuMethod kGpuMethods[] = {{"gpu_m2_sphere", Kernel::kM2Sphere, CpuMethod::kM2},
                                     {"gpu_m1_chain", Kernel::kM1Chain, CpuMethod::kM1},
                                     {"gpu_m1_sphere", Kernel::kM1Sphere, CpuMethod::kM1}};

struct CpuTimed {
  const char* key;
  CpuMethod method;
};
constexpr CpuTimed kCpuMethods[] = {{"cpu_m1", CpuMethod::kM1}, {"cpu_m2", CpuMethod::kM2}};

// A method is timed on every which frame: on few where it is slow.
std::size_t step_of(double microseconds) { return microseconds > kSlow ? kSlowStep : 1; }

double microseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

double least(const std::vector<double>& values) { return *std::min_element(values.begin(), values.end()); }

double rounded(double microseconds) { return std::round(1000 * microseconds) / 1000; }

bool same(const std::vector<ChainPair>& l, const std::vector<ChainPair>& r) {
  return std::equal(l.begin(), l.end(), r.begin(), r.end(),
                    [](const ChainPair& p, const ChainPair& q) { return p.chain == q.chain && p.pair == q.pair; });
}

// The CPU's results for each frame of an animation, by method.
struct Expected {
  std::vector<std::vector<ChainPair>> m1, m2;
  const std::vector<ChainPair>& of(CpuMethod method, std::size_t frame) const {
    return method == CpuMethod::kM1 ? m1[frame] : m2[frame];
  }
};

// By sc_detect(), on all cores: a thread takes the next frame.
Expected expect(const PaperCase& paper_case, const PaperAnimation& animation) {
  const std::size_t count = animation.frames.size();
  Expected out{std::vector<std::vector<ChainPair>>(count), std::vector<std::vector<ChainPair>>(count)};
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex mutex;
  const auto work = [&] {
    try {
      CpuRunner runner(paper_case);
      for (std::size_t i = next++; i < count; i = next++) {
        out.m2[i] = runner.pairs(CpuMethod::kM2, animation.frames[i]);
        out.m1[i] = chain_pairs_of(paper_case.view(), out.m2[i]);
      }
    } catch (...) {
      const std::lock_guard lock(mutex);
      failure = std::current_exception();
    }
  };
  std::vector<std::thread> threads;
  for (unsigned i = 1; i < std::thread::hardware_concurrency(); ++i) {
    threads.emplace_back(work);
  }
  work();
  for (std::thread& thread : threads) {
    thread.join();
  }
  if (failure) {
    std::rethrow_exception(failure);
  }
  return out;
}

// A case with its place on the device.
struct Contestant {
  explicit Contestant(std::unique_ptr<PaperCase> paper_case_) : paper_case(std::move(paper_case_)) {
    std::size_t most = 0;
    for (const PaperAnimation& animation : paper_case->animations) {
      expected.push_back(expect(*paper_case, animation));
      for (std::size_t i = 0; i < animation.frames.size(); ++i) {
        most = std::max({most, expected.back().m1[i].size(), expected.back().m2[i].size()});
      }
    }
    runner = std::make_unique<cuda_paper::Runner>(*paper_case->tables, static_cast<std::uint32_t>(2 * most + 1024));
  }

  std::unique_ptr<PaperCase> paper_case;
  std::vector<Expected> expected;  // an animation each
  std::unique_ptr<cuda_paper::Runner> runner;
  std::size_t steps[std::size(kGpuMethods)];
  std::size_t compared = 0;  // frames times kernels
};

// All frames, or some where a launch takes long. How many frames differ, which are named.
int compare(Contestant& contestant) {
  int differ = 0;
  CpuRunner cpu(*contestant.paper_case);
  for (std::size_t a = 0; a < contestant.expected.size(); ++a) {
    const PaperAnimation& animation = contestant.paper_case->animations[a];
    for (std::size_t m = 0; m < std::size(kGpuMethods); ++m) {
      const GpuMethod& method = kGpuMethods[m];
      if (a == 0) {
        const auto start = Clock::now();
        contestant.runner->pairs(method.kernel, animation.frames[0].data());
        contestant.steps[m] = step_of(microseconds_since(start));
      }
      for (std::size_t i = 0; i < animation.frames.size(); i += contestant.steps[m]) {
        const auto found = contestant.runner->pairs(method.kernel, animation.frames[i].data());
        const auto& expected = contestant.expected[a].of(method.same_pairs, i);
        ++contestant.compared;
        if (!same(found, expected)) {
          ++differ;
          std::fprintf(stderr, "%s in %u parts, %s, frame %zu, %s: %zu overlaps on the GPU, %zu on the CPU\n",
                       contestant.paper_case->name.c_str(), contestant.paper_case->parts, animation.name.c_str(), i,
                       method.key, found.size(), expected.size());
        }
      }
    }
    if (!same(cpu.pairs(CpuMethod::kM1, animation.frames[0]), contestant.expected[a].m1[0])) {
      ++differ;
      std::fprintf(stderr, "%s: the paper's loops find other pairs than sc_detect()\n",
                   contestant.paper_case->name.c_str());
    }
  }
  return differ;
}

// The times of one method on the frames of one animation.
struct Timed {
  std::vector<std::size_t> frames;
  std::vector<std::vector<cuda_paper::Times>> times;  // a frame each, its repetitions
};

// Frame after frame, again and again, until the time is up.
Timed repeat(std::size_t frame_count, std::size_t step, const std::function<cuda_paper::Times(std::size_t)>& run) {
  Timed out;
  for (std::size_t i = 0; i < frame_count; i += step) {
    out.frames.push_back(i);
  }
  out.times.resize(out.frames.size());
  const auto start = Clock::now();
  for (std::size_t r = 0; r < kRepetitions; ++r) {
    for (std::size_t i = 0; i < out.frames.size(); ++i) {
      out.times[i].push_back(run(out.frames[i]));
    }
    if (std::chrono::duration<double>(Clock::now() - start).count() > kSeconds) {
      break;
    }
  }
  return out;
}

// Adds "NAME_us" and "NAME_min_us", a figure a frame; the median over the frames.
double add_times(Json& series, const std::string& name, const Timed& timed, double cuda_paper::Times::*member) {
  std::vector<double> medians, minima;
  for (const auto& repetitions : timed.times) {
    std::vector<double> values;
    values.reserve(repetitions.size());
    for (const cuda_paper::Times& times : repetitions) {
      values.push_back(times.*member);
    }
    medians.push_back(rounded(median(values)));
    minima.push_back(rounded(least(values)));
  }
  series[name + "_us"] = medians;
  series[name + "_min_us"] = minima;
  return median(medians);
}

class Report {
 public:
  Report(const std::string& command, const cuda_paper::Device& device) {
    char date[64] = "";
    const std::time_t now = std::time(nullptr);
    std::strftime(date, sizeof date, "%Y-%m-%d %H:%M UTC", std::gmtime(&now));
    json_ = {{"what", "the paper's Figure 16: tests/bench/gpu/figure16.cpp"},
             {"date", date},
             {"chip", device.chip},
             {"driver", "CUDA " + device.driver},
             {"runtime", "CUDA " + device.runtime},
             {"processor", processor()},
             {"command", command},
             {"animations", kAnimations},
             {"radius", "fit"},
             {"characters", Json::array()},
             {"series", Json::array()}};
    std::printf("%s, CUDA %s (driver %s); %s\n", device.chip.c_str(), device.runtime.c_str(), device.driver.c_str(),
                processor().c_str());
  }

  void add_character(const Contestant& contestant) {
    const PaperCase& paper_case = *contestant.paper_case;
    const AssetView& asset = paper_case.view();
    std::size_t m1 = 0;
    for (std::size_t c = 0; c < asset.chain_count(); ++c) {
      m1 += asset.chain(c).spheres.size * asset.chain(c).spheres.size;
    }
    json_["characters"].push_back({{"spheres", asset.spheres().size},
                                   {"asset", paper_case.name},
                                   {"parts", paper_case.parts},
                                   {"chains", asset.chain_count()},
                                   {"chain_entries", paper_case.tables->members.size()},
                                   {"tests_m1", m1},
                                   {"tests_m2", asset.spheres().size * asset.spheres().size},
                                   {"frames_compared", contestant.compared}});
  }

  void head() const {
    std::printf("\n%-8s %-5s %-14s %9s | %12s %12s | %12s %12s | %12s %12s | %5s %4s\n", "spheres", "clip", "method",
                "overlaps", "kernel us", "least", "launch us", "least", "frame us", "least", "frms", "reps");
  }

  // `expected` null: nothing is looked for.
  void add(const PaperCase& paper_case, const PaperAnimation& animation, const char* method, const Timed& timed,
           const std::function<std::size_t(std::size_t)>& overlaps, bool is_gpu) {
    Json series = {{"spheres", paper_case.view().spheres().size},
                   {"animation", animation.name},
                   {"method", method},
                   {"repetitions", timed.times[0].size()},
                   {"frame", timed.frames}};
    std::vector<std::size_t> found;
    double mean = 0;
    for (const std::size_t frame : timed.frames) {
      found.push_back(overlaps(frame));
      mean += static_cast<double>(found.back()) / static_cast<double>(timed.frames.size());
    }
    series["overlaps"] = found;
    std::printf("%-8zu %-5s %-14s %9.1f |", paper_case.view().spheres().size, animation.name.c_str(), method, mean);
    column(series, "kernel", timed, &cuda_paper::Times::kernel);
    if (is_gpu) {
      column(series, "launch", timed, &cuda_paper::Times::launch);
      column(series, "frame", timed, &cuda_paper::Times::frame);
    } else {
      std::printf(" %12s %12s | %12s %12s |", "", "", "", "");
    }
    std::printf(" %5zu %4zu\n", timed.frames.size(), timed.times[0].size());
    std::fflush(stdout);
    json_["series"].push_back(std::move(series));
  }

  void write(const std::string& file) const {
    std::ofstream out(file);
    // A line for each of the long lists' entries.
    std::string text = "{";
    for (const auto& [key, value] : json_.items()) {
      text += (text.size() > 1 ? ",\n" : "\n") + Json(key).dump() + ": ";
      if (value.is_array()) {
        text += "[";
        for (std::size_t i = 0; i < value.size(); ++i) {
          text += (i > 0 ? ",\n" : "\n") + value[i].dump();
        }
        text += "\n]";
      } else {
        text += value.dump();
      }
    }
    out << text << "\n}\n";
    if (!out.flush()) {
      throw std::runtime_error(file + ": cannot be written");
    }
  }

 private:
  static void column(Json& series, const char* name, const Timed& timed, double cuda_paper::Times::*member) {
    const double middle = add_times(series, name, timed, member);
    std::printf(" %12.2f %12.2f |", middle, least(series[std::string(name) + "_min_us"].get<std::vector<double>>()));
  }

  static std::string processor() {
    std::ifstream info("/proc/cpuinfo");
    std::string line;
    while (std::getline(info, line)) {
      if (line.rfind("model name", 0) == 0) {
        return line.substr(line.find(':') + 2) + ", " + std::to_string(std::thread::hardware_concurrency()) + " cores";
      }
    }
    return "unknown processor";
  }

  Json json_;
};

void time(Contestant& contestant, Report& report) {
  const PaperCase& paper_case = *contestant.paper_case;
  for (std::size_t a = 0; a < paper_case.animations.size(); ++a) {
    const PaperAnimation& animation = paper_case.animations[a];
    const std::size_t count = animation.frames.size();
    const auto gpu = [&](Kernel kernel, std::size_t step) {
      return repeat(count, step,
                    [&](std::size_t frame) { return contestant.runner->time(kernel, animation.frames[frame].data()); });
    };
    report.add(
        paper_case, animation, "gpu_empty", gpu(Kernel::kEmpty, 1), [](std::size_t) { return std::size_t{0}; }, true);
    for (std::size_t m = 0; m < std::size(kGpuMethods); ++m) {
      const GpuMethod& method = kGpuMethods[m];
      report.add(
          paper_case, animation, method.key, gpu(method.kernel, contestant.steps[m]),
          [&](std::size_t f) { return contestant.expected[a].of(method.same_pairs, f).size(); }, true);
    }
    CpuRunner cpu(paper_case);
    for (const CpuTimed& timed : kCpuMethods) {
      for (const std::size_t frame : {std::size_t{0}, count - 1}) {
        cpu.pairs(timed.method, animation.frames[frame]);
      }
      const std::size_t step = step_of(cpu.time(timed.method, animation.frames[0]));
      report.add(
          paper_case, animation, timed.key,
          repeat(count, step,
                 [&](std::size_t frame) {
                   return cuda_paper::Times{cpu.time(timed.method, animation.frames[frame]), 0, 0};
                 }),
          [&](std::size_t f) { return contestant.expected[a].of(timed.method, f).size(); }, false);
    }
  }
}

int run(const std::string& data, const std::string& json, const std::string& command) {
  Report report(command, cuda_paper::device());
  struct Choice {
    const char* name;
    std::uint32_t parts;
  };
  std::vector<Contestant> contestants;
  int differ = 0;
  for (const Choice& choice : {Choice{"paper", 1}, {"paper_denser", 1}, {"paper", 20}, {"paper", 200}}) {
    contestants.emplace_back(std::make_unique<PaperCase>(data, choice.name, choice.parts));
    Contestant& contestant = contestants.back();
    differ += compare(contestant);
    report.add_character(contestant);
    std::printf("%s, each sphere in %u: %zu spheres, the kernels' pairs compared with the CPU's %zu times\n",
                choice.name, choice.parts, contestant.paper_case->view().spheres().size, contestant.compared);
    std::fflush(stdout);
  }
  if (differ > 0) {
    std::fprintf(stderr, "spherechain_figure16: pairs differ %d times; nothing is timed\n", differ);
    return kPairsDiffer;
  }
  report.head();
  for (Contestant& contestant : contestants) {
    time(contestant, report);
  }
  if (!json.empty()) {
    report.write(json);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"The paper's Figure 16 on this machine's GPU"};
  std::string data = "out/gpu_data", json, command;
  app.add_option("--data", data, "folder that spherechain_gpu_data wrote")->capture_default_str();
  app.add_option("--json", json, "file to write");
  CLI11_PARSE(app, argc, argv);
  for (int i = 0; i < argc; ++i) {
    command += std::string(i > 0 ? " " : "") + argv[i];
  }
  try {
    return run(data, json, command);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "spherechain_figure16: error: %s\n", error.what());
    return kFailed;
  }
}

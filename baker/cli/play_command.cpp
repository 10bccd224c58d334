// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <map>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "cli/progress.h"
#include "play/play.h"
#include "spherechain/detect.h"
#include "spherechain/refit.h"
#include "write/write.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

// Median microseconds of a few runs: a frame's work is shorter than the machine's hiccups.
template <typename Run>
double median_us(const Run& run) {
  std::array<double, 5> times{};
  for (double& time : times) {
    const auto start = Clock::now();
    run();
    time = std::chrono::duration<double, std::micro>(Clock::now() - start).count();
  }
  std::nth_element(times.begin(), times.begin() + 2, times.end());
  return times[2];
}

void check(Status status) {
  if (status != Status::kOk) throw Error(ExitCode::kInternal, to_string(status));
}

// The runtime as a game uses it: buffers made once, then a refit and a detection a frame.
class Player {
 public:
  Player(const Asset& asset, const PlayOptions& options)
      : asset_(asset),
        radius_(options.radius == "fit" ? RadiusKind::kFit : RadiusKind::kDetect),
        m1_(options.mode != "m2"),
        m2_(options.mode != "m1"),
        spheres_(asset.spheres().size),
        pairs_(spheres_.size() * (spheres_.size() - 1) / 2),
        words_(DetectContext::words_needed(asset)) {}

  ordered_json frame(int index, double time, const std::vector<float>& positions) {
    RefitJob refit;
    refit.asset = &asset_;
    refit.positions = positions.data();
    refit.vertex_count = positions.size() / 3;
    refit.radius = radius_;
    refit.spheres = {spheres_.data(), spheres_.size()};
    ordered_json out{{"index", index}, {"time", time}, {"refit_us", median_us([&] { check(refit.run()); })}};
    refit_us_ += out["refit_us"].get<double>();
    if (m1_) {
      const auto [job, us] = detect(Method::kM1);
      out["m1"] = {
          {"tests", job.test_count}, {"pairs", job.chain_pair_count}, {"unique_pairs", job.pair_count}, {"us", us}};
      m1_us_ += us;
      m1_tests_ = job.test_count;
      m1_raw_ += job.chain_pair_count;
      store(job);
    }
    if (m2_) {
      const auto [job, us] = detect(Method::kM2);
      out["m2"] = {{"tests", job.test_count}, {"pairs", job.pair_count}, {"us", us}};
      m2_us_ += us;
      m2_tests_ = job.test_count;
      store(job);
    }
    out["pairs"] = ordered_json::array();
    for (std::size_t i = 0; i < pair_count_; ++i) out["pairs"].push_back({pairs_[i].a, pairs_[i].b});
    count_regions(index);
    return out;
  }

  std::string summary(int frames) const {
    std::string out =
        fmt::format("{} frames, radius {}, backend scalar\n\n", frames, radius_ == RadiusKind::kFit ? "fit" : "detect");
    out += fmt::format("{:<6} {:>8} {:>10} {:>12} {:>10}\n", "", "tests", "pairs", "raw pairs", "us");
    const double n = frames;
    out += fmt::format("{:<6} {:>8} {:>10} {:>12} {:>10.2f}\n", "refit", "", "", "", refit_us_ / n);
    if (m1_)
      out += fmt::format("{:<6} {:>8} {:>10} {:>12.1f} {:>10.2f}\n", "M1", m1_tests_,
                         m2_ ? std::string() : fmt::format("{:.1f}", static_cast<double>(total_pairs_) / n),
                         static_cast<double>(m1_raw_) / n, m1_us_ / n);
    if (m2_)
      out += fmt::format("{:<6} {:>8} {:>10.1f} {:>12} {:>10.2f}\n", "M2", m2_tests_,
                         static_cast<double>(total_pairs_) / n, "", m2_us_ / n);
    out += fmt::format("(a frame, on average)\n\nframes with touching spheres: {} of {}\n", touching_frames_, frames);
    for (const auto& [names, frame_list] : by_region_) {
      out += fmt::format("  {:<24} {:>3} frames, from frame {}\n", names.first + " - " + names.second,
                         frame_list.second, frame_list.first);
    }
    return out;
  }

 private:
  std::pair<DetectJob, double> detect(Method method) {
    DetectContext context{{words_.data(), words_.size()}};
    DetectJob job;
    job.asset = &asset_;
    job.spheres = {spheres_.data(), spheres_.size()};
    job.radius = radius_;
    job.method = method;
    job.context = &context;
    job.pairs = {pairs_.data(), pairs_.size()};
    const double us = median_us([&] { check(job.run()); });
    return {job, us};
  }

  void store(const DetectJob& job) { pair_count_ = job.pair_count; }

  void count_regions(int index) {
    total_pairs_ += pair_count_;
    touching_frames_ += pair_count_ > 0 ? 1 : 0;
    std::map<std::pair<std::string, std::string>, bool> seen;
    for (std::size_t i = 0; i < pair_count_; ++i) {
      std::string a = asset_.region(asset_.spheres()[pairs_[i].a].region).name,
                  b = asset_.region(asset_.spheres()[pairs_[i].b].region).name;
      if (b < a) std::swap(a, b);
      seen[{a, b}] = true;
    }
    for (const auto& [names, yes] : seen) ++by_region_.try_emplace(names, index, 0).first->second.second;
  }

  const Asset& asset_;
  RadiusKind radius_;
  bool m1_, m2_;
  std::vector<Sphere> spheres_;
  std::vector<Pair> pairs_;
  std::vector<std::uint64_t> words_;
  std::size_t pair_count_ = 0, total_pairs_ = 0, touching_frames_ = 0, m1_tests_ = 0, m2_tests_ = 0, m1_raw_ = 0;
  double refit_us_ = 0, m1_us_ = 0, m2_us_ = 0;
  std::map<std::pair<std::string, std::string>, std::pair<int, int>> by_region_;  // regions -> first frame, frames
};

}  // namespace

ExitCode run_play(const PlayOptions& options) {
  const AnimatedAsset animated(options.asset, options.source, options.poses);
  Player player(animated.asset(), options);
  ordered_json frames = ordered_json::array();
  {
    Progress progress("play " + options.asset + ":");
    for (int i = 0; i < options.frames; ++i) {
      progress.show(fmt::format("frame {} of {}", i + 1, options.frames));
      frames.push_back(player.frame(i, i / options.fps, pack(animated.positions(i, options.frames))));
    }
  }
  if (!options.json.empty()) {
    const ordered_json out{{"backend", "scalar"}, {"radius", options.radius}, {"frames", std::move(frames)}};
    write_atomically(options.json, out.dump(1) + "\n");
  }
  fmt::print("{}", player.summary(options.frames));
  if (!options.json.empty()) fmt::print("wrote {}\n", options.json);
  return ExitCode::kDone;
}

}  // namespace spherechain::baker

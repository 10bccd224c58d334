// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <map>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "cli/files.h"
#include "import/import.h"
#include "motion/motion.h"
#include "rig/rig.h"
#include "spherechain/detect.h"
#include "spherechain/refit.h"
#include "write/write.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

Vec3 to_vec3(const spherechain::Vec3& v) { return {v.x, v.y, v.z}; }

std::vector<Joint> joints_of(const Asset& asset) {
  std::vector<Joint> joints;
  for (std::size_t i = 0; i < asset.joint_count(); ++i) {
    const JointView joint = asset.joint(i);
    joints.push_back({joint.name, joint.parent, to_vec3(joint.position), to_vec3(joint.tail)});
  }
  return joints;
}

BodyFrame frame_of(const Asset& asset) {
  const AssetInfo info = asset.info();
  return {to_vec3(info.origin), to_vec3(info.left), to_vec3(info.up), to_vec3(info.forward),
          static_cast<double>(info.height)};
}

std::vector<float> pack(const std::vector<Vec3>& positions) {
  std::vector<float> packed;
  packed.reserve(positions.size() * 3);
  for (const Vec3& p : positions) {
    for (int k = 0; k < 3; ++k) packed.push_back(static_cast<float>(p[k]));
  }
  return packed;
}

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
  const AssetFile file = open_asset(options.asset);
  const Character character = import_character(options.source);
  const std::vector<float> rest = pack(character.source_positions);
  if (const Status status = check_source(file.asset, rest.data(), rest.size() / 3); status != Status::kOk) {
    throw Error(ExitCode::kFile, options.source + ": is not the mesh that " + options.asset + " was baked from (" +
                                     to_string(status) + ")");
  }
  std::optional<BezierMotion> motion;
  if (!options.poses.empty()) {
    const std::vector<Joint> joints = joints_of(file.asset);
    const PoseMotion poses = read_pose_motion(options.poses, joints);
    motion.emplace(character.source_positions, rig_weights(character, joints), joints, frame_of(file.asset), poses);
  }

  Player player(file.asset, options);
  ordered_json frames = ordered_json::array();
  {
    Progress progress("play " + options.asset + ":");
    for (int i = 0; i < options.frames; ++i) {
      progress.show(fmt::format("frame {} of {}", i + 1, options.frames));
      const double t = options.frames > 1 ? static_cast<double>(i) / (options.frames - 1) : 0;
      frames.push_back(player.frame(i, i / options.fps, motion ? pack(motion->at(t)) : rest));
    }
  }
  if (!options.json.empty()) {
    write_atomically(
        options.json,
        ordered_json{{"backend", "scalar"}, {"radius", options.radius}, {"frames", std::move(frames)}}.dump(1) + "\n");
  }
  fmt::print("{}", player.summary(options.frames));
  if (!options.json.empty()) fmt::print("wrote {}\n", options.json);
  return ExitCode::kDone;
}

}  // namespace spherechain::baker

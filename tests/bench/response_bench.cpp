// SPDX-License-Identifier: GPL-3.0-or-later
// spherechain_bench_response [--fps N] [--seconds S] ASSET SOURCE [ASSET SOURCE ...]: characters as animated, by
// sc_respond and by capsules, in one run. All are judged by penetrations in full, as `play --respond` does.
#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "baker/play/responder.h"
#include "baker/play/target.h"
#include "capsule_response.h"
#include "table.h"

using namespace spherechain;

namespace {

constexpr double kHuman = 1750;  // millimetres

void print(const std::string& name, const baker::ResponseMeasures& of) {
  fmt::print("{:10} {:8} {:6} {:6.2f} {:6.2f} {:8.0f} {:8} {:9.1f} {:9.1f} {:8.0f} {:8.0f}\n", name, of.faulty_after,
             of.new_faults, of.wrist_acceleration, of.elbow_acceleration, kHuman * of.largest_jump, of.flickers,
             100 * of.moved_without_fault, kHuman * of.residual_p95, of.us_mean, of.us_p99);
}

// Seconds of the animation are counted through all clips.
void run(const char* asset, const char* source, double fps, double seconds) {
  const baker::AnimatedAsset animated(asset, source, baker::MotionChoice(), baker::FrameChoice{0, fps});
  const Target target = baker::choose_target("auto");
  baker::Responder responder(animated, target, 0);
  bench::CapsuleResponse capsules(animated);
  baker::ArmJudge judge(animated, target);
  const double height = animated.frame().height;
  baker::ResponseTally as_animated(height), by_response(height), by_capsules(height);
  for (int f = 0; f < animated.frame_count() && f < seconds * fps; ++f) {
    const baker::Responder::Corrected response = responder.correct(f);
    const bool starts = response.starts_clip;
    const double passed = starts ? 0 : animated.frame_at(f).seconds - animated.frame_at(f - 1).seconds;
    const bench::CapsuleResponse::Corrected pushed = capsules.correct(response.animated, passed, starts);
    const baker::ArmPose before = judge.look_at(response.animated);
    as_animated.add(before, before, 0, starts);
    by_response.add(before, response.is_turned ? judge.look_at(response.corrected) : before, response.us, starts);
    by_capsules.add(before, judge.look_at(pushed.pose), pushed.us, starts);
  }
  const baker::ResponseMeasures measures = as_animated.measures();
  fmt::print("{}: {} frames at {:g} a second\n", std::filesystem::path(source).stem().string(), measures.frames, fps);
  fmt::print("{:10} {:>8} {:>6} {:>6} {:>6} {:>8} {:>8} {:>9} {:>9} {:>8} {:>8}\n", "", "faulty", "new", "wrist",
             "elbow", "jump mm", "flickers", "moved %", "p95 mm", "us", "p99");
  print("animated", measures);
  print("response", by_response.measures());
  print("capsules", by_capsules.measures());
  fmt::print("\n");
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) try {
  std::vector<const char*> files;
  double fps = 30, seconds = 1e9;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if ((word == "--fps" || word == "--seconds") && i + 1 < argc) {
      (word == "--fps" ? fps : seconds) = std::stod(argv[++i]);
    } else {
      files.push_back(argv[i]);
    }
  }
  if (files.empty() || files.size() % 2 != 0) throw std::runtime_error("pass pairs of ASSET SOURCE");
  fmt::print("{}\n\n", bench::machine());
  std::fflush(stdout);
  for (std::size_t i = 0; i < files.size(); i += 2) run(files[i], files[i + 1], fps, seconds);
  return 0;
} catch (const std::exception& e) {
  fmt::print(stderr, "spherechain_bench_response: {}\n", e.what());
  return 1;
}

// SPDX-License-Identifier: GPL-3.0-or-later
// spherechain_bench_clothed ASSET SOURCE [ASSET SOURCE ...]: clothed characters against a bare one, the first, in their
// first clips: load, contacts, penetrations, and how often spheres alarm without a fault.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "baker/play/play.h"
#include "baker/play/skin_player.h"

using namespace spherechain;

namespace {

constexpr int kFrames = 30, kRounds = 3, kRepeats = 2;

double microseconds(const auto& run) {
  double least = 1e30;
  for (int i = 0; i < kRepeats; ++i) {
    const auto start = std::chrono::steady_clock::now();
    run();
    const auto end = std::chrono::steady_clock::now();
    least = std::min(least, std::chrono::duration<double, std::micro>(end - start).count());
  }
  return least;
}

struct Times {
  double apart, layers, quick, full;
};

class Character {
 public:
  Character(const char* asset, const char* source) : name(asset) {
    baker::AnimatedAsset animated(asset, source, baker::MotionChoice(), baker::FrameChoice());
    const std::string bytes = baker::read_file(asset);
    ModelDef def;
    def.data = bytes.data();
    def.size = bytes.size();
    load_ms = microseconds([&] { model = std::make_unique<Model>(def); }) / 1000;
    body = Body(*model);
    const int step = std::max(1, animated.frame_count() / kFrames);
    for (int f = 0; f < animated.frame_count(); f += step) {
      palettes.push_back(baker::bone_palette(animated.asset(), animated.deformation(f)));
    }
  }

  // The mean over the frames.
  Times round() {
    Times sum{};
    alarms = faulty = missed = 0;
    for (const std::vector<float>& palette : palettes) {
      Pose pose;
      pose.bones = palette.data();
      pose.bone_count = palette.size() / 12;
      pose.bone_layout = SC_ROWS_3X4;
      std::size_t faults = 0;
      const auto ask = [&](Scope scope, int full, bool measures) {
        Query query;
        query.scope = scope;
        query.full = full;
        query.classes = full != 0 ? ~0U : 0;
        return microseconds([&] {
          body.set_pose(pose);
          if (measures) {
            faults = body.penetrations(query).total;
          } else {
            body.contacts(query);
          }
        });
      };
      sum.apart += ask(SC_SCOPE_APART, 0, false);
      sum.layers += ask(SC_SCOPE_LAYERS, 0, false);
      sum.full += ask(SC_SCOPE_LAYERS, 1, true);
      sum.quick += ask(SC_SCOPE_APART, 0, true);
      const bool is_alarmed = body.sphere_pairs().total > 0;
      alarms += is_alarmed && faults == 0 ? 1 : 0;
      faulty += faults > 0 ? 1 : 0;
      missed += !is_alarmed && faults > 0 ? 1 : 0;
    }
    const auto count = static_cast<double>(palettes.size());
    return {sum.apart / count, sum.layers / count, sum.quick / count, sum.full / count};
  }

  std::string name;
  double load_ms = 0;
  std::size_t alarms = 0, faulty = 0, missed = 0;
  std::unique_ptr<Model> model;
  Body body;
  std::vector<std::vector<float>> palettes;
};

double median(std::vector<double> of) {
  std::sort(of.begin(), of.end());
  return of[of.size() / 2];
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 3 || argc % 2 == 0) {
    std::fputs("usage: spherechain_bench_clothed ASSET SOURCE [ASSET SOURCE ...]\n", stderr);
    return 2;
  }
  std::vector<std::unique_ptr<Character>> all;
  for (int i = 1; i < argc; i += 2) all.push_back(std::make_unique<Character>(argv[i], argv[i + 1]));
  std::vector<std::vector<Times>> rounds(all.size());
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t k = 0; k < all.size(); ++k) rounds[k].push_back(all[k]->round());
  }
  const auto of = [&](std::size_t k, double Times::*which) {
    std::vector<double> values;
    for (const Times& times : rounds[k]) values.push_back(times.*which);
    return median(values);
  };
  fmt::print("{:28} {:>8} {:>9} {:>6} {:>9} {:>9} {:>7} {:>9} {:>18}\n", "", "load ms", "contacts", "ratio", "layers",
             "quick", "/ cont.", "full", "alarms, no fault");
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Character& one = *all[k];
    const double apart = of(k, &Times::apart), quick = of(k, &Times::quick);
    fmt::print("{:28} {:8.1f} {:9.1f} {:6.2f} {:9.1f} {:9.1f} {:7.1f} {:9.1f} {:11} of {:3}", one.name, one.load_ms,
               apart, apart / of(0, &Times::apart), of(k, &Times::layers), quick, quick / apart, of(k, &Times::full),
               one.alarms, one.palettes.size());
    fmt::print("; {} with faults, {} of them without alarm\n", one.faulty, one.missed);
  }
  return 0;
} catch (const std::exception& e) {
  fmt::print(stderr, "spherechain_bench_clothed: {}\n", e.what());
  return 1;
}

// SPDX-License-Identifier: GPL-3.0-or-later
// Goals P1 to P4 (docs/performance.md), one table.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <exception>

#include "character.h"
#include "check_pairs.h"
#include "pair_finder.h"
#include "timing.h"

using namespace spherechain;
using namespace spherechain::bench;

namespace {

int run(std::size_t pose_count, int repetitions) {
  PosedCharacter human;
  load(human, "human", "{}", pose_count);
  PairFinders finders = runtime_finders(human.asset);
  for (const auto& more : {&fcl_finders}) {
    for (auto& finder : more(human.asset)) {
      finders.push_back(std::move(finder));
    }
  }
  fmt::print("{} spheres, {} poses\n", human.asset.spheres().size, human.poses.size());
  Timing timing(repetitions);
  for (const auto& finder : finders) {
    const Agreement agreement = check_pairs(human, *finder);
    fmt::print("{:<28} {} pairs, {} candidates, {} ties\n", finder->name, agreement.pairs, agreement.candidates,
               agreement.ties);
    if (!agreement.difference.empty()) {
      fmt::print(stderr, "{}: not the same pairs: {}\n", finder->name, agreement.difference);
      return 1;
    }
    timing.add(finder->name, human.spheres.size(),
               [&human, f = finder.get()](std::size_t i) { f->find(human.spheres[i].data()); });
  }
  timing.run_all();
  for (const auto& finder : finders) {
    const Times times = timing.of(finder->name);
    fmt::print("{:<28} {:>9.0f} {:>9.0f} ns  {:.1f}x\n", finder->name, times.median, times.min,
               times.median / timing.of(finders[0]->name).median);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Times the runtime against its peers"};
  std::size_t pose_count = 1024;
  int repetitions = 15;
  app.add_option("--poses", pose_count, "Real poses, over eleven motions")->capture_default_str();
  app.add_option("--repetitions", repetitions, "Passes over the poses; medians and minima are over these")
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    return run(pose_count, repetitions);
  } catch (const std::exception& error) {
    fmt::print(stderr, "spherechain_bench: {}\n", error.what());
    return 1;
  }
}

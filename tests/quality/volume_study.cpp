// SPDX-License-Identifier: GPL-3.0-or-later
// volume_study FRAMES ASSET SOURCE [MOTION]...: how well colliders of each shape and number tell which body parts
// touch. The truth are exact skin contacts. Prints rows of a Markdown table. Pairs that the colliders ignore are
// missed.
#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <map>
#include <set>

#include "play/play.h"
#include "play/skin_player.h"
#include "play/target.h"
#include "volumes/bodies.h"
#include "volumes/fit_volumes.h"
#include "volumes/measure.h"

using namespace spherechain::baker;

namespace {

using Pairs = std::set<std::pair<int, int>>;  // of bodies

struct PosedTruth {
  std::vector<Affine> bones;
  Pairs touching;
};

std::vector<PosedTruth> truths(const AnimatedAsset& animated, const Colliders& bodies) {
  const BodyParts parts = parts_of(animated.asset());
  std::map<std::string, int> by_name;
  for (std::size_t i = 0; i < bodies.bodies.size(); ++i) by_name[bodies.bodies[i].name] = static_cast<int>(i);
  SkinPlayer player(animated.asset(), choose_target("auto"));
  std::vector<PosedTruth> out;
  for (int i = 0; i < animated.frame_count(); ++i) {
    const Deformation deformation = animated.deformation(i);
    PosedTruth one{deformation.bones, {}};
    for (const sc_triangle_contact& contact : player.find(BonePose(animated.asset(), deformation).pose())) {
      const int a = by_name.at(parts.parts[contact.part_a].name), b = by_name.at(parts.parts[contact.part_b].name);
      if (a == b || bodies.bodies[static_cast<std::size_t>(a)].parent == b ||
          bodies.bodies[static_cast<std::size_t>(b)].parent == a) {
        continue;
      }
      one.touching.emplace(std::min(a, b), std::max(a, b));
    }
    out.push_back(std::move(one));
  }
  return out;
}

// What touches and is tested, what touches and is not, what is reported, and what of that touches.
struct PairCounts {
  double tested = 0, ignored = 0, reported = 0, right = 0;
  double recall() const { return right / std::max(tested, 1.0); }
  double precision() const { return right / std::max(reported, 1.0); }
};

PairCounts counts_of(const std::vector<PosedTruth>& truth, Colliders colliders, double padding) {
  for (ColliderBody& body : colliders.bodies) {
    for (Volume& volume : body.volumes) volume = padded(volume, padding);
  }
  Pairs ignored;
  for (const IgnoredBodies& pair : colliders.ignored) ignored.emplace(pair.a, pair.b);
  const auto holder = [&](int body) {
    const int held_by = colliders.bodies[static_cast<std::size_t>(body)].held_by;
    return held_by < 0 ? body : held_by;
  };
  PairCounts out;
  for (const PosedTruth& one : truth) {
    Pairs touching;  // of the bodies whose volumes stand for those that touch
    for (const auto& [a, b] : one.touching) {
      const int i = holder(a), j = holder(b);
      const std::pair<int, int> pair(std::min(i, j), std::max(i, j));
      (i == j || ignored.contains(pair) ? out.ignored : out.tested) += 1;
      if (i != j) touching.insert(pair);
    }
    for (const std::pair<int, int>& pair : overlapping(colliders, posed(colliders, one.bones))) {
      out.reported += 1;
      out.right += touching.contains(pair) ? 1 : 0;
    }
  }
  return out;
}

// With the least padding that finds this share of what is tested: that padding, and the precision.
std::string precision_at(double recall, const std::vector<PosedTruth>& truth, const Colliders& colliders) {
  for (const double percent : {-2.0, -1.5, -1.0, -0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0}) {
    const double padding = percent / 100 * colliders.height;
    const PairCounts counts = counts_of(truth, colliders, padding);
    if (counts.recall() >= recall) return fmt::format("{:.2f} ({:+.0f} mm)", counts.precision(), 1000 * padding);
  }
  return "-";
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 4) {
    std::cerr << "usage: volume_study FRAMES ASSET SOURCE [MOTION]...\n";
    return 2;
  }
  std::vector<MotionChoice> motions;
  for (int i = 4; i < argc; ++i) motions.push_back({"", "", argv[i]});
  if (motions.empty()) motions.emplace_back();
  AnimatedAsset animated(argv[2], argv[3], motions[0], {std::atoi(argv[1]), 30});
  const Colliders bodies = find_bodies(animated.asset());
  std::vector<PosedTruth> truth = truths(animated, bodies);
  for (std::size_t i = 1; i < motions.size(); ++i) {
    animated.play(motions[i], {std::atoi(argv[1]), 30});
    for (PosedTruth& one : truths(animated, bodies)) truth.push_back(std::move(one));
  }
  for (const std::string shape : kVolumeShapes) {
    for (const int at_most : {0, 15, 32, 64}) {
      const Colliders colliders = fit_volumes(animated.asset(), volume_shape(shape), at_most);
      const ColliderFit fit = measure_fit(animated.asset(), colliders);
      const PairCounts counts = counts_of(truth, colliders, 0);
      fmt::print("| {} | {} | {} | {:.2f} | {:.2f} | {} | {:.0f} % | {:.0f} % | {:.1f} | {:.1f} | {:.2f} |\n",
                 std::filesystem::path(argv[3]).filename().string(), shape, fit.volumes, counts.recall(),
                 counts.precision(), precision_at(0.95, truth, colliders),
                 100 * counts.ignored / std::max(counts.ignored + counts.tested, 1.0), 100 * fit.coverage,
                 1000 * fit.gap_mean, 1000 * fit.gap_95, fit.volume_ratio);
      std::fflush(stdout);
    }
  }
  return 0;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}

// SPDX-License-Identifier: GPL-3.0-or-later
// volume_study FRAMES ASSET SOURCE[+MOTION] [ASSET SOURCE[+MOTION]]...: how well colliders of each shape and number
// stand for skins, and tell which body parts touch, over all these characters. The truth are exact skin contacts.
// Prints a Markdown table.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <set>

#include "baker/play/play.h"
#include "baker/play/skin_player.h"
#include "baker/play/target.h"
#include "baker/volumes/bodies.h"
#include "baker/volumes/fit_volumes.h"
#include "baker/volumes/measure.h"

using namespace spherechain::baker;

namespace {

using Pairs = std::set<std::pair<int, int>>;  // of bodies

struct PosedTruth {
  std::vector<Affine> bones;
  Pairs touching;
};

std::vector<PosedTruth> truths(const AnimatedAsset& animated, const Colliders& bodies) {
  const std::vector<int> body_of_part = body_of_parts(animated.asset(), bodies);
  SkinPlayer player(animated.asset(), choose_target("auto"));
  std::vector<PosedTruth> out;
  for (int i = 0; i < animated.frame_count(); ++i) {
    const Deformation deformation = animated.deformation(i);
    PosedTruth one{deformation.bones, {}};
    const BonePose pose(animated.asset(), deformation);
    player.set_pose(pose.pose());
    for (const sc_triangle_contact& contact : player.triangles()) {
      const int a = body_of_part[contact.part_a], b = body_of_part[contact.part_b];
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

// Over all characters. Paddings in percent of the height.
constexpr double kPaddings[] = {-2, -1.5, -1, -0.75, -0.5, -0.25, 0, 0.25, 0.5, 0.75, 1, 1.5, 2};
constexpr std::size_t kNoPadding = 6;

struct PairCounts {
  double tested = 0, ignored = 0;  // pairs that touch, and are tested or not
  double reported = 0, right = 0;  // by the colliders, and what of that touches
  double recall() const { return right / std::max(tested, 1.0); }
  double precision() const { return right / std::max(reported, 1.0); }
};

struct StudyRow {
  std::array<PairCounts, std::size(kPaddings)> counts;
  ColliderFit fit;  // sums; lengths in percent of the height
};

void add_counts(const std::vector<PosedTruth>& truth, Colliders colliders, double padding, PairCounts& out) {
  for (ColliderBody& body : colliders.bodies) {
    for (Volume& volume : body.volumes) volume = padded(volume, padding);
  }
  Pairs ignored;
  for (const IgnoredBodies& pair : colliders.ignored) ignored.emplace(pair.a, pair.b);
  const auto holder = [&](int body) {
    const int held_by = colliders.bodies[static_cast<std::size_t>(body)].held_by;
    return held_by < 0 ? body : held_by;
  };
  for (const PosedTruth& one : truth) {
    Pairs touching;  // of the bodies whose volumes stand for those that touch
    for (const auto& [a, b] : one.touching) {
      const int i = holder(a), j = holder(b);
      const std::pair<int, int> pair(std::min(i, j), std::max(i, j));
      if (i == j || ignored.contains(pair)) {
        out.ignored += 1;
      } else if (touching.insert(pair).second) {
        out.tested += 1;
      }
    }
    for (const std::pair<int, int>& pair : overlapping(colliders, posed(colliders, one.bones))) {
      out.reported += 1;
      out.right += touching.contains(pair) ? 1 : 0;
    }
  }
}

struct StudyCharacter {
  OpenAsset asset;
  std::vector<PosedTruth> truth;
};

StudyCharacter character_of(const std::string& asset, const std::string& source, int frames) {
  const std::size_t plus = source.find('+');
  MotionChoice motion;
  if (plus != std::string::npos) motion.motion = source.substr(plus + 1);
  const AnimatedAsset animated(asset, source.substr(0, plus), motion, {frames, 30});
  return {open_asset(asset), truths(animated, find_bodies(animated.asset()))};
}

StudyRow row_of(const std::vector<StudyCharacter>& characters, VolumeShape shape, int at_most) {
  StudyRow out{};
  for (const StudyCharacter& character : characters) {
    const Colliders colliders = fit_volumes(character.asset, shape, at_most);
    const ColliderFit fit = measure_fit(character.asset, colliders);
    const double percent = 100 / colliders.height;
    out.fit.volumes += fit.volumes;
    out.fit.coverage += fit.coverage;
    out.fit.gap_mean += percent * fit.gap_mean;
    out.fit.gap_95 += percent * fit.gap_95;
    out.fit.protrusion_95 += percent * fit.protrusion_95;
    out.fit.volume_ratio += fit.volume_ratio;
    for (std::size_t i = 0; i < std::size(kPaddings); ++i) {
      add_counts(character.truth, colliders, kPaddings[i] / percent, out.counts[i]);
    }
  }
  return out;
}

// With the least padding that finds 95 % of what is tested.
std::string precision_at_95(const StudyRow& row) {
  for (std::size_t i = 0; i < std::size(kPaddings); ++i) {
    if (row.counts[i].recall() >= 0.95)
      return fmt::format("{:.0f} ({:+.2f})", 100 * row.counts[i].precision(), kPaddings[i]);
  }
  return "";
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 4 || argc % 2 != 0) {
    std::cerr << "usage: volume_study FRAMES ASSET SOURCE[+MOTION] [ASSET SOURCE[+MOTION]]...\n";
    return 2;
  }
  std::vector<StudyCharacter> characters;
  for (int i = 2; i < argc; i += 2) characters.push_back(character_of(argv[i], argv[i + 1], std::atoi(argv[1])));
  fmt::print(
      "| shape | at most | volumes | recall | precision | precision at 95 (padding) | not tested | inside | distance | "
      "its 95th | beyond, 95th | volume |\n");
  fmt::print("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
  const auto n = static_cast<double>(characters.size());
  for (const std::string shape : kVolumeShapes) {
    for (const int at_most : {15, 32, 64, 0}) {
      const StudyRow row = row_of(characters, volume_shape(shape), at_most);
      const PairCounts& counts = row.counts[kNoPadding];
      fmt::print("| {} | {} | {:.0f} | {:.0f} | {:.0f} | {} | {:.0f} | {:.0f} | {:.2f} | {:.2f} | {:.2f} | {:.0f} |\n",
                 shape, at_most == 0 ? "" : std::to_string(at_most), row.fit.volumes / n, 100 * counts.recall(),
                 100 * counts.precision(), precision_at_95(row),
                 100 * counts.ignored / std::max(counts.ignored + counts.tested, 1.0), 100 * row.fit.coverage / n,
                 row.fit.gap_mean / n, row.fit.gap_95 / n, row.fit.protrusion_95 / n, 100 * row.fit.volume_ratio / n);
      std::fflush(stdout);
    }
  }
  return 0;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "baker/check/heat.h"
#include "baker/check/picture.h"
#include "baker/check/poke_watch.h"
#include "baker/check/results.h"
#include "baker/events/find_events.h"
#include "baker/play/play.h"

namespace spherechain::baker {

// A checked clip: its results, and the data that the report shows.
struct ClipCheck {
  ClipResult result;
  std::string page;                   // of clip_page()
  std::vector<std::string> pictures;  // PNG: of the first frame, then of the events that have one
  std::vector<HeatSpot> heat;
};

// Checks the clips of one character after another: finds events, draws them, and fills their page.
class ClipChecker {
 public:
  // `animated`, of the character in the file `source`, must outlive it, and may play other motions in between. Throws
  // Error(kFile) where the asset has no clusters.
  ClipChecker(const AnimatedAsset& animated, const std::filesystem::path& source, Target target);

  // Called after each frame: `done` frames of `all` have been checked.
  using Progress = std::function<void(int done, int all)>;
  // All frames of one of animated.clips().
  ClipCheck check(std::size_t clip, const Progress& progress);

 private:
  void take_sample();

  const AnimatedAsset& animated_;
  BodyFrame axes_;
  EventFinder finder_;
  PokeWatch pokes_;
  Picture picture_;
  std::vector<Vec3> sample_;  // some of the rest positions: they say where the character is
  std::vector<VertexWeights> sample_weights_;
};

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "baker/events/find_events.h"
#include "baker/score/far_pairs.h"
#include "baker/score/movement.h"
#include "baker/score/subject.h"
#include "baker/score/swallowed_skin.h"
#include "baker/score/voxel_volume.h"

namespace spherechain::baker {

// The metrics of a clip, by name, in the order of metric_names(). A metric has no value where the character lacks what
// it measures, or there is no reference.
using Metrics = std::vector<std::pair<std::string, std::optional<double>>>;

// All names, as docs/cli/score.md explains them.
const std::vector<std::string>& metric_names();

// A metric whose values are from 0 to 1.
bool is_share(const std::string& name);

// The places that are compared with those of another clip.
struct ClipPlaces {
  Track joints;                             // by frame
  std::vector<std::vector<char>> end_near;  // by looked-at frame: of each limb 1 if its end is near the body
};

struct ClipScore {
  std::string clip;
  int frames = 0;
  double fps = 0;
  Metrics metrics;
};

// Scores the clips of one character, one after another.
class ClipScorer {
 public:
  // `animated` must outlive it, and may play other motions in between. `asked`: the metrics to measure; empty: all.
  ClipScorer(const AnimatedAsset& animated, std::set<std::string> asked);

  // One of animated.clips(). `progress` is called with each frame's number. `reference`: of the clip to compare with,
  // or null.
  ClipScore score(const ClipFrames& clip, const ClipPlaces* reference, const std::function<void(int)>& progress);
  // The same clip as a reference.
  ClipPlaces places(const ClipFrames& clip) const;

 private:
  // Adds those of a frame. Nearness is left out where `positions` is null.
  void add_places(int frame, const Deformation& deformation, const std::vector<Vec3>* positions, ClipPlaces& to) const;
  bool is_asked(const std::string& metric) const { return asked_.empty() || asked_.contains(metric); }

  const AnimatedAsset& animated_;
  std::set<std::string> asked_;
  ScoreSubject subject_;
  EventFinder finder_;
  SkinPlayer player_;
  SwallowedSkin swallowed_;
  std::optional<FarPairs> far_;
  VoxelVolume voxels_;
  double area_, volume_;  // of the skin at rest
};

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "baker/check/picture.h"
#include "baker/check/results.h"
#include "baker/play/play.h"
#include "baker/play/skin_player.h"

namespace spherechain::baker {

// True if two poses are equal except for the character's place, which its first bone gives.
bool same_pose(const Deformation& first, const Deformation& last, const BodyFrame& axes);

// A checked clip: its results, and the data that the report shows.
struct ClipCheck {
  ClipResult result;
  std::string page;                   // its motion and contacts: JSON with the keys of baker/page/README.md
  std::vector<std::string> pictures;  // PNG: of the first frame, then of the events that have one
  std::vector<HeatSpot> heat;         // by event, then by triangle
};

// Checks the clips of one character after another.
class ClipChecker {
 public:
  // `animated` must outlive it, and may play other motions in between. Throws Error(kFile) where the asset has no
  // clusters.
  ClipChecker(const AnimatedAsset& animated, Target target);

  // Called after each frame: `done` frames of `all` have been checked.
  using Progress = std::function<void(int done, int all)>;
  // All frames of one of animated.clips().
  ClipCheck check(std::size_t clip, const Progress& progress);

 private:
  using Triangles = std::array<std::uint32_t, 2>;  // that intersect: of part_a and of part_b
  struct Frames;                                   // what was seen, frame by frame
  void take_sample();
  static Triangles triangles_of(const TriangleContact& contact);
  Frames look(const ClipFrames& clip, const Progress& progress);
  void measure(const ClipFrames& clip, struct FramePenetration& meeting, std::vector<Triangles>& triangles);
  void find_worst(Frames& frames, const ClipFrames& clip, struct EventSpan& span);
  Event event_of(const Frames& frames, const struct EventSpan& span, const ClipFrames& clip) const;
  std::vector<HeatSpot> heat_of(const Frames& frames) const;
  void show(ClipCheck& out, const Frames& frames, const ClipFrames& clip);

  const AnimatedAsset& animated_;
  SkinPlayer player_;
  BodyParts parts_;
  double mm_;  // a unit of the source
  BodyFrame axes_;
  Picture picture_;
  std::vector<Vec3> sample_;  // some of the rest positions: they say where the character is
  std::vector<VertexWeights> sample_weights_;
};

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string>

#include "baker/play/play.h"

namespace spherechain::baker {

// Finds joints that a scale of 0 hides, with all below them: how clips take a prop or a hand away. Nothing there meets
// anything, which a user should hear of.
class HiddenJoints {
 public:
  // `animated` must outlive it.
  explicit HiddenJoints(const AnimatedAsset& animated) : animated_(animated) {}

  // A frame of a clip: its pose.
  void add(const Deformation& deformation);
  // "'Prop' has a scale of 0 in 4 of 12 frames, so it meets nothing there", joint by joint; empty where none has.
  std::string text() const;

 private:
  const AnimatedAsset& animated_;
  int frames_ = 0;
  std::map<std::size_t, int> hidden_;  // of a bone: the frames
};

// A note on all that the frames of a clip do not show: hidden joints, and the keys after the first where the clip is
// over before its second frame. Empty if there is no note.
std::string unseen_text(const HiddenJoints& hidden, const ClipFrames& clip);

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/motion/clip.h"

namespace spherechain::baker {

// The frames of a motion. `count` 0: as many as the motion has of its own, or one every 1 / fps seconds, each clip from
// its start; 40 of poses, which have no pace; 1 of the rest pose. Else `count` of them, evenly spaced from the start of
// the first clip to the end of the last. One of poses, which begin at rest, is the last.
struct FrameChoice {
  int count = 0;
  double fps = 30;  // 0: each clip's own (rate_of), 30 where it has none
};

// The frames of one clip, a run of the motion's frames. A motion that is not made of clips is one without a name.
struct ClipFrames {
  std::string name;
  const Clip* clip = nullptr;  // null where the motion is not made of clips
  int first = 0, count = 0;
  int between = 0;    // of those, how many lie between two of the clip's (MotionFrame::between)
  int own_count = 0;  // frames that the clip has at `fps`, or of its own
  double fps = 30;
};

struct MotionFrame {
  std::size_t clip = 0;  // index in MotionFrames::clips
  int number = 0;        // at `fps`, from the start of its clip
  double seconds = 0;    // from the start of its clip
  double time = 0;       // seconds from the start of the first clip
  double between = 0;    // share of the way to the next number, for contacts between two frames; else 0
  double along = 0;      // of a motion that is not made of clips: from 0, its start, to 1, its end
};

// "12", or "12.46": between two frames.
std::string frame_text(double number);

struct MotionFrames {
  std::vector<ClipFrames> clips;
  std::vector<MotionFrame> frames;
};

// Frames of clips, one clip after another.
MotionFrames frames_of(const SourceRig& rig, const std::vector<const Clip*>& clips, const FrameChoice& choice);

// So far on the way from a frame to the next of its clip.
MotionFrame frame_between(const MotionFrame& frame, const MotionFrame& next, double share);

// With frames more, of each frame those at these shares of the way to the next.
MotionFrames with_frames_between(const MotionFrames& frames, const std::vector<std::vector<double>>& shares);

// Frames of another motion. Null stands for the rest pose.
MotionFrames frames_of(const Motion* motion, const FrameChoice& choice);

}  // namespace spherechain::baker

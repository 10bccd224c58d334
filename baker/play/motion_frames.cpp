// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/play/motion_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "baker/motion/frame_times.h"

namespace spherechain::baker {
namespace {

constexpr int kPoseFrames = 40;

int nearest_number(double seconds, double fps) {
  return static_cast<int>(std::lround(std::min(seconds * fps, kFramesMax)));
}

double even_place(int frame, int count) { return count > 1 ? static_cast<double>(frame) / (count - 1) : 0.0; }

class Builder {
 public:
  // `start` is the clip's, in the motion's seconds.
  void open(const std::string& name, const Clip* clip, int own_count, double start, double fps) {
    out.clips.push_back({name, clip, static_cast<int>(out.frames.size()), 0, 0, own_count, fps});
    start_ = start;
  }
  void add(double seconds, int number, double along) {
    ++out.clips.back().count;
    out.frames.push_back({out.clips.size() - 1, number, seconds, start_ + seconds, 0, along});
  }

  MotionFrames out;

 private:
  double start_ = 0;
};

}  // namespace

MotionFrames frames_of(const SourceRig& rig, const std::vector<const Clip*>& clips, const FrameChoice& choice) {
  const ClipMotion motion(rig, clips);
  Builder builder;
  double fps = 0;  // of the clip that is open
  const auto open = [&](std::size_t c) {
    fps = even_rate(choice.fps, rate_of(*clips[c]));
    builder.open(clips[c]->name, clips[c], frames_in(clips[c]->duration, fps), motion.start(c), fps);
  };
  if (choice.count == 0) {
    for (std::size_t c = 0; c < clips.size(); ++c) {
      open(c);
      const int left = static_cast<int>(kFramesMax) - static_cast<int>(builder.out.frames.size());
      const int count = std::min(builder.out.clips.back().own_count, left);
      for (int i = 0; i < count; ++i) builder.add(i / fps, i, 0);
    }
    return std::move(builder.out);
  }
  std::size_t current = clips.size();
  for (int i = 0; i < choice.count; ++i) {
    const ClipMotion::Place place = motion.place(even_place(i, choice.count));
    if (place.clip != current) open(current = place.clip);
    builder.add(place.seconds, nearest_number(place.seconds, fps), 0);
  }
  return std::move(builder.out);
}

MotionFrames frames_of(const Motion* motion, const FrameChoice& choice) {
  const double duration = motion ? motion->duration() : 0, own_rate = motion ? motion->rate() : 0;
  const double fps = choice.fps > 0 || own_rate > 0 ? even_rate(choice.fps, own_rate) : FrameChoice().fps;
  const bool has_pace = duration > 0;
  int own_count = motion == nullptr ? 1 : motion->frame_count();
  const bool are_poses = own_count == 0 && !has_pace;
  if (own_count == 0) own_count = has_pace ? frames_in(duration, fps) : choice.count > 0 ? choice.count : kPoseFrames;
  const int count = choice.count > 0 ? choice.count : std::min(own_count, static_cast<int>(kFramesMax));
  Builder builder;
  builder.open({}, nullptr, own_count, 0, fps);
  for (int i = 0; i < count; ++i) {
    double along = count == 1 && are_poses ? 1 : even_place(i, count);
    if (!has_pace) {
      builder.add(i / fps, static_cast<int>(std::lround(along * (own_count - 1))), along);
      continue;
    }
    if (choice.count == 0) along = std::min(i / fps / duration, 1.0);
    builder.add(along * duration, nearest_number(along * duration, fps), along);
  }
  return std::move(builder.out);
}

MotionFrame frame_between(const MotionFrame& frame, const MotionFrame& next, double share) {
  MotionFrame out = frame;
  out.between = share;
  out.seconds += share * (next.seconds - frame.seconds);
  out.time += share * (next.time - frame.time);
  out.along += share * (next.along - frame.along);
  return out;
}

MotionFrames with_frames_between(const MotionFrames& frames, const std::vector<std::vector<double>>& shares) {
  MotionFrames out{frames.clips, {}};
  for (ClipFrames& clip : out.clips) {
    const int first = clip.first, end = clip.first + clip.count;
    clip.first = static_cast<int>(out.frames.size());
    for (int i = first; i < end; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const MotionFrame& frame = frames.frames[at];
      out.frames.push_back(frame);
      for (const double share : shares[at]) {
        out.frames.push_back(frame_between(frame, frames.frames[at + 1], share));
        ++clip.between;
      }
    }
    clip.count = static_cast<int>(out.frames.size()) - clip.first;
  }
  return out;
}

std::string frame_text(double number) {
  const double whole = std::floor(number);
  return number == whole ? fmt::format("{:.0f}", number) : fmt::format("{:.2f}", number);
}

}  // namespace spherechain::baker

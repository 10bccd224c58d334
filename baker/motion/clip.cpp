// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/motion/clip.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "baker/motion/frame_times.h"

namespace spherechain::baker {
namespace {

// A clip of one key is a pose: it shows for a frame.
double length_of(const Clip& clip) { return std::max(clip.duration, 1.0 / 30); }

// The mean of the gaps that are about as long as most. A few keys between do not change it, or a few that are missing.
double usual_gap(const std::vector<double>& times) {
  constexpr double kAlike = 0.2;
  std::vector<double> gaps;
  for (std::size_t k = 1; k < times.size(); ++k) gaps.push_back(times[k] - times[k - 1]);
  const auto middle = gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2);
  std::nth_element(gaps.begin(), middle, gaps.end());
  const double median = *middle;
  double sum = 0, count = 0;
  for (const double gap : gaps) {
    if (std::abs(gap - median) > kAlike * median) continue;
    sum += gap;
    ++count;
  }
  return sum / count;
}

bool keys_are_frames(const Clip& clip, double rate) {
  for (const Channel& channel : clip.channels) {
    for (const double time : channel.times) {
      if (std::abs(time * rate - std::round(time * rate)) > kFrameRounding) return false;
    }
  }
  return true;
}

}  // namespace

int frames_in(double seconds, double fps) {
  constexpr double kCountMax = 2e9;
  return static_cast<int>(std::min(seconds * fps + kFrameRounding, kCountMax)) + 1;
}

double even_rate(double fps, double own) {
  constexpr double kSame = 0.005;  // times of four digits are so far off
  if (fps <= 0 || own <= 0) return own > 0 ? own : fps;
  const double steps = own > fps ? std::round(own / fps) : 1 / std::round(fps / own);
  return std::abs(own / steps - fps) < kSame * fps ? own / steps : fps;
}

double rate_of(const Clip& clip) {
  double densest = 0;
  for (const Channel& channel : clip.channels) {
    if (channel.times.size() < 2) continue;
    if (const double gap = usual_gap(channel.times); gap > 0) densest = std::max(densest, 1 / gap);
  }
  constexpr double kOtherwise = 30, kMin = 5, kMax = 480;
  for (const double rate : {30.0, 24.0, 25.0, 60.0, 50.0, 48.0, 120.0, 100.0}) {
    // Keys that are few lie on the frames of any high rate.
    const bool is_likely = rate <= 30 || rate < 2.5 * densest;
    if (is_likely && keys_are_frames(clip, rate)) return rate;
  }
  return densest < kMin || densest > kMax ? kOtherwise : std::round(1000 * densest) / 1000;
}

std::vector<Affine> world_at(const SourceRig& rig, const Clip& clip, double seconds) {
  std::map<Index, Node> animated;
  for (const Channel& channel : clip.channels) {
    if (channel.path == ChannelPath::kMorphWeight) continue;
    const Eigen::Vector4d v = sample(channel, seconds);
    Node& node = animated.try_emplace(channel.target, rig.nodes[channel.target]).first->second;
    if (channel.path == ChannelPath::kTranslation) node.translation = v.head<3>();
    if (channel.path == ChannelPath::kRotation) node.rotation = Eigen::Quaterniond(v);
    if (channel.path == ChannelPath::kScale) node.scale = v.head<3>();
    node.local.linear() = node.rotation.toRotationMatrix() * node.scale.asDiagonal();
    node.local.translation() = node.translation;
  }
  std::vector<Affine> world;
  world.reserve(rig.nodes.size());
  auto next = animated.cbegin();
  for (Index n = 0; n < rig.nodes.size(); ++n) {
    const bool is_animated = next != animated.cend() && next->first == n;
    const Affine& local = is_animated ? next->second.local : rig.nodes[n].local;
    const int parent = rig.nodes[n].parent;
    world.push_back(parent < 0 ? local : world[static_cast<std::size_t>(parent)] * local);
    if (is_animated) ++next;
  }
  return world;
}

Deformation sample(const SourceRig& rig, const Clip& clip, double seconds) {
  Deformation out;
  for (const Morph& morph : rig.morphs) out.morphs.push_back(morph.rest_weight);
  for (const Channel& channel : clip.channels) {
    if (channel.path == ChannelPath::kMorphWeight) out.morphs[channel.target] = sample(channel, seconds)[0];
  }
  const std::vector<Affine> world = world_at(rig, clip, seconds);
  for (const Bone& bone : rig.bones) out.bones.push_back(rig.to_rest * world[bone.node] * bone.inverse_bind);
  return out;
}

double ClipMotion::start(std::size_t clip) const {
  double sum = 0;
  for (std::size_t c = 0; c < clip; ++c) sum += length_of(*clips_[c]);
  return sum;
}

ClipMotion::Place ClipMotion::place(double t) const {
  double left = t * duration();
  std::size_t clip = 0;
  while (clip + 1 < clips_.size() && left >= length_of(*clips_[clip])) left -= length_of(*clips_[clip++]);
  return {clip, left};
}

Deformation ClipMotion::at(double t) const {
  const Place here = place(t);
  return sample(rig_, *clips_[here.clip], here.seconds);
}

}  // namespace spherechain::baker

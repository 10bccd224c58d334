// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion/clip.h"

#include <algorithm>

namespace spherechain::baker {
namespace {

// A clip of one key is a pose: it shows for a frame.
double length_of(const Clip& clip) { return std::max(clip.duration, 1.0 / 30); }

}  // namespace

std::vector<Affine> world_at(const SourceRig& rig, const Clip& clip, double seconds) {
  std::vector<Node> nodes = rig.nodes;
  for (const Channel& channel : clip.channels) {
    if (channel.path == ChannelPath::kMorphWeight) continue;
    const Eigen::Vector4d v = sample(channel, seconds);
    Node& node = nodes[channel.target];
    if (channel.path == ChannelPath::kTranslation) node.translation = v.head<3>();
    if (channel.path == ChannelPath::kRotation) node.rotation = Eigen::Quaterniond(v);
    if (channel.path == ChannelPath::kScale) node.scale = v.head<3>();
    node.local.linear() = node.rotation.toRotationMatrix() * node.scale.asDiagonal();
    node.local.translation() = node.translation;
  }
  return world_of(nodes);
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

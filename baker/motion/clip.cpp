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

double ClipMotion::duration() const {
  double sum = 0;
  for (const Clip* clip : clips_) sum += length_of(*clip);
  return sum;
}

ClipMotion::Place ClipMotion::place(double t) const {
  double left = t * duration();
  for (const Clip* clip : clips_) {
    if (left < length_of(*clip) || clip == clips_.back()) return {clip, left};
    left -= length_of(*clip);
  }
  return {nullptr, 0};
}

Deformation ClipMotion::at(double t) const {
  const Place here = place(t);
  return sample(rig_, *here.clip, here.seconds);
}

std::string ClipMotion::clip_at(double t) const { return place(t).clip->name; }

}  // namespace spherechain::baker

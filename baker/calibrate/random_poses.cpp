// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/calibrate/random_poses.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "baker/import/robot_joints.h"

namespace spherechain::baker {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kPadding = 10 * kDegree, kWithoutClips = 45 * kDegree, kJitter = 5 * kDegree;
constexpr double kLastFrame = 1.0 / 30;  // seconds that the end of a clip lasts

// The axis of a rotation times its angle, which is at most 180 degrees.
Vec3 rotation_vector(const Eigen::Quaterniond& q) {
  const Vec3 axis = q.w() < 0 ? Vec3(-q.vec()) : Vec3(q.vec());
  const double sine = axis.norm();
  return sine > 0 ? Vec3(2 * std::atan2(sine, std::abs(q.w())) / sine * axis) : Vec3(Vec3::Zero());
}

Eigen::Quaterniond rotation_of(const Vec3& vector) {
  const double angle = vector.norm();
  return angle > 0 ? Eigen::Quaterniond(Eigen::AngleAxisd(angle, vector / angle)) : Eigen::Quaterniond::Identity();
}

// A channel's values at all its keys.
std::vector<Eigen::Vector4d> values_of(const Channel& channel) {
  std::vector<Eigen::Vector4d> out;
  for (const double time : channel.times) out.push_back(sample(channel, time));
  return out;
}

std::vector<Node> nodes_of(const std::vector<Joint>& joints) {
  std::vector<Node> out;
  for (const Joint& joint : joints) {
    Node node;
    node.name = joint.name;
    node.parent = joint.parent;
    const Vec3 above = joint.parent < 0 ? Vec3(Vec3::Zero()) : joints[static_cast<std::size_t>(joint.parent)].position;
    node.translation = joint.position - above;
    node.local.translation() = node.translation;
    out.push_back(node);
  }
  return out;
}

Vec3 random_in(Random& random, const Vec3& low, const Vec3& high) {
  Vec3 out;
  for (Eigen::Index k = 0; k < 3; ++k) out[k] = random.between(low[k], high[k]);
  return out;
}

}  // namespace

RandomPoses::RandomPoses(const Character& character, const std::vector<Joint>& joints) {
  const SourceRig& rig = character.rig;
  if (!rig.bones.empty()) {
    rig_.nodes = rig.nodes;
    rig_.bones = rig.bones;
    rig_.to_rest = rig.to_rest;
    for (const Morph& morph : rig.morphs) morphs_.emplace_back(morph.rest_weight, morph.rest_weight);
    if (!rig.pivots.empty()) {
      own_pivots_.assign(rig.nodes.size(), Vec3::Zero());
      for (const Bone& bone : rig.bones) own_pivots_[bone.node] = bone.inverse_bind * rig.pivots[bone.node];
    }
  } else {
    rig_.nodes = nodes_of(joints);
    for (Index j = 0; j < joints.size(); ++j) {
      rig_.bones.push_back({j, Affine(Eigen::Translation3d(-joints[j].position))});
    }
  }
  limits_.resize(rig_.nodes.size());
  if (rig.robot.is_robot) {
    rig_.robot = rig.robot;
    for (const RigJoint& joint : rig.robot.joints) limits_[joint.node].moves = true;
    plan();
    return;
  }
  if (rig.bones.empty() || rig.clips.empty()) {
    for (const Bone& bone : rig_.bones) {
      const Node& node = rig_.nodes[bone.node];
      const Vec3 widest = Vec3::Constant(kWithoutClips);
      limits_[bone.node] = {
          node.rotation, {-widest, widest}, {node.translation, node.translation}, {node.scale, node.scale}, true};
    }
    plan();
    return;
  }
  clips_ = &rig.clips;
  children_.resize(rig_.nodes.size());
  for (const Node& node : rig_.nodes) {
    if (node.parent >= 0) ++children_[static_cast<std::size_t>(node.parent)];
  }
  for (const Clip& clip : rig.clips) {
    channels_.emplace_back(rig_.nodes.size());
    for (const Channel& channel : clip.channels) {
      if (channel.path != ChannelPath::kMorphWeight) channels_.back()[channel.target].push_back(&channel);
    }
  }
  std::vector<std::vector<Eigen::Quaterniond>> turns(rig_.nodes.size());
  std::vector<std::vector<Vec3>> translations(rig_.nodes.size()), scales(rig_.nodes.size());
  std::vector<std::vector<double>> weights(morphs_.size());
  for (const Clip& clip : rig.clips) {
    for (const Channel& channel : clip.channels) {
      for (const Eigen::Vector4d& v : values_of(channel)) {
        if (channel.path == ChannelPath::kMorphWeight) weights[channel.target].push_back(v[0]);
        if (channel.path == ChannelPath::kRotation) turns[channel.target].emplace_back(v);
        if (channel.path == ChannelPath::kTranslation) translations[channel.target].push_back(v.head<3>());
        if (channel.path == ChannelPath::kScale) scales[channel.target].push_back(v.head<3>());
      }
    }
  }
  const auto range_of = [](const std::vector<Vec3>& values, const Vec3& rest) {
    if (values.empty()) return Range{rest, rest};
    Range range{values[0], values[0]};
    for (const Vec3& value : values) range = {range.low.cwiseMin(value), range.high.cwiseMax(value)};
    return range;
  };
  for (std::size_t n = 0; n < rig_.nodes.size(); ++n) {
    Limits& limits = limits_[n];
    limits.moves = !turns[n].empty() || !translations[n].empty() || !scales[n].empty();
    if (!limits.moves) continue;
    Eigen::Vector4d sum = Eigen::Vector4d::Zero();
    for (const Eigen::Quaterniond& turn : turns[n])
      sum += (turn.coeffs().dot(turns[n][0].coeffs()) < 0 ? -1 : 1) * turn.coeffs();
    limits.middle = sum.norm() > 0 ? Eigen::Quaterniond(Eigen::Vector4d(sum.normalized())) : rig_.nodes[n].rotation;
    std::vector<Vec3> vectors;
    for (const Eigen::Quaterniond& turn : turns[n])
      vectors.push_back(rotation_vector(limits.middle.conjugate() * turn));
    limits.turn = range_of(vectors, Vec3::Zero());
    limits.turn.low.array() -= kPadding;
    limits.turn.high.array() += kPadding;
    limits.translation = range_of(translations[n], rig_.nodes[n].translation);
    limits.scale = range_of(scales[n], rig_.nodes[n].scale);
  }
  for (std::size_t m = 0; m < morphs_.size(); ++m) {
    if (weights[m].empty()) continue;
    const auto [low, high] = std::minmax_element(weights[m].begin(), weights[m].end());
    morphs_[m] = {*low, *high};
  }
  plan();
}

bool RandomPoses::limit(const std::string& joint, const Vec3& low, const Vec3& high) {
  bool is_there = false;
  if (rig_.robot.is_robot) return false;  // it has limits of its own
  for (std::size_t n = 0; n < rig_.nodes.size(); ++n) {
    const Node& node = rig_.nodes[n];
    if (node.name != joint) continue;
    is_there = true;
    Limits& limits = limits_[n];
    limits.middle = node.rotation;
    limits.turn = {low, high};
    if (!limits.moves) {
      limits.translation = {node.translation, node.translation};
      limits.scale = {node.scale, node.scale};
    }
    limits.moves = true;
  }
  if (is_there) plan();
  return is_there;
}

RandomPoses::Moment RandomPoses::moment_at(double part) const {
  const auto length = [](const Clip& clip) { return clip.duration + kLastFrame; };
  double seconds = 0;
  for (const Clip& clip : *clips_) seconds += length(clip);
  seconds *= part;
  std::size_t clip = 0;
  for (; clip + 1 < clips_->size() && seconds >= length((*clips_)[clip]); ++clip) seconds -= length((*clips_)[clip]);
  return {clip, std::min(seconds, (*clips_)[clip].duration)};
}

RandomPoses::Moment RandomPoses::any_moment(Random& random) const {
  const auto clip = static_cast<std::size_t>(random.between(0, static_cast<double>(clips_->size())));
  return {clip, random.between(0, (*clips_)[clip].duration)};
}

std::vector<RandomPoses::Moment> RandomPoses::of_branches(Random& random) const {
  constexpr double kOwn = 0.5;  // of the branches have a moment of their own
  const Moment all = any_moment(random);
  std::vector<Moment> out;
  for (const Node& node : rig_.nodes) {
    const auto parent = static_cast<std::size_t>(node.parent);
    const bool is_branch = node.parent >= 0 && children_[parent] > 1;
    if (is_branch && random.between(0, 1) < kOwn) {
      out.push_back(any_moment(random));
    } else {
      out.push_back(node.parent < 0 ? all : out[parent]);
    }
  }
  return out;
}

// The moving nodes, in the order of moving_.
std::vector<RandomPoses::Parts> RandomPoses::at_moments(const std::vector<Moment>& of_node) const {
  std::vector<Parts> out;
  for (const Index n : moving_) {
    Parts parts(rig_.nodes[n]);
    for (const Channel* channel : channels_[of_node[n].clip][n]) {
      const Eigen::Vector4d value = sample(*channel, of_node[n].seconds);
      if (channel->path == ChannelPath::kTranslation) parts.translation = value.head<3>();
      if (channel->path == ChannelPath::kScale) parts.scale = value.head<3>();
      if (channel->path == ChannelPath::kRotation) parts.rotation = Eigen::Quaterniond(value);
    }
    parts.local.linear() = parts.rotation.toRotationMatrix() * parts.scale.asDiagonal();
    parts.local.translation() = parts.translation;
    out.push_back(parts);
  }
  return out;
}

void RandomPoses::turn_about_pivot(Index n, Parts& parts, const Eigen::Quaterniond& rotation) const {
  const Vec3 before = own_pivots_.empty() ? Vec3(Vec3::Zero()) : parts.local * own_pivots_[n];
  parts.rotation = rotation;
  parts.local.linear() = parts.rotation.toRotationMatrix() * parts.scale.asDiagonal();
  if (!own_pivots_.empty()) parts.local.translation() += before - parts.local * own_pivots_[n];
}

std::vector<RandomPoses::Parts> RandomPoses::bent(std::vector<Parts> moving, Random& random) const {
  for (std::size_t i = 0; i < moving.size(); ++i) {
    const Vec3 jitter = Vec3::Constant(kJitter);
    turn_about_pivot(moving_[i], moving[i], moving[i].rotation * rotation_of(random_in(random, -jitter, jitter)));
  }
  return moving;
}

std::vector<RandomPoses::Parts> RandomPoses::driven(Random& random) const {
  const RobotRig& robot = rig_.robot;
  std::vector<double> values;
  for (const RigJoint& joint : robot.joints) values.push_back(joint.zero);
  for (const Index j : driven_joints(robot)) {
    const RigJoint& joint = robot.joints[j];
    if (std::isfinite(joint.lower) && std::isfinite(joint.upper))
      values[j] = random.between(joint.lower, joint.upper);
    else if (joint.kind == RigJointKind::kHinge)
      values[j] = random.between(-std::numbers::pi, std::numbers::pi);
  }
  follow_mimics(robot, values);
  std::vector<Parts> out;
  for (const Index n : moving_) out.emplace_back(rig_.nodes[n]).local = moved_by_joints(robot, n, values);
  return out;
}

std::vector<RandomPoses::Parts> RandomPoses::turned(Random& random) const {
  if (rig_.robot.is_robot) return driven(random);
  std::vector<Parts> out;
  for (const Index n : moving_) {
    const Limits& limits = limits_[n];
    Parts& parts = out.emplace_back(rig_.nodes[n]);
    const Eigen::Quaterniond turn = limits.middle * rotation_of(random_in(random, limits.turn.low, limits.turn.high));
    if (!own_pivots_.empty()) {
      turn_about_pivot(n, parts, turn);
      continue;
    }
    const Vec3 translation = random_in(random, limits.translation.low, limits.translation.high);
    const Vec3 scale = random_in(random, limits.scale.low, limits.scale.high);
    parts.local.linear() = turn.toRotationMatrix() * scale.asDiagonal();
    parts.local.translation() = translation;
  }
  return out;
}

void RandomPoses::plan() {
  std::vector<std::uint8_t> moves;
  moving_.clear();
  for (Index n = 0; n < limits_.size(); ++n) {
    moves.push_back(limits_[n].moves ? 1 : 0);
    if (limits_[n].moves) moving_.push_back(n);
  }
  moved_ = MovedNodes(rig_, moves);
}

std::vector<Affine> RandomPoses::bones_in(const std::vector<Parts>& moving) const {
  std::vector<Affine> moved;
  auto at = moving_.begin();
  for (const Index n : moved_.list()) {
    at = std::lower_bound(at, moving_.end(), n);
    const bool moves = at != moving_.end() && *at == n;
    const Affine& local = moves ? moving[static_cast<std::size_t>(at - moving_.begin())].local : rig_.nodes[n].local;
    const int parent = rig_.nodes[n].parent;
    moved.push_back(parent < 0 ? local : moved_.world(static_cast<Index>(parent), moved) * local);
  }
  return moved_.deformation(rig_, moved);
}

RandomPoses::Pose RandomPoses::next(Random& random, int kind, double part) const {
  constexpr int kMoment = 0, kBranches = 1;
  const auto moving = [&] {
    if (clips_ == nullptr) return turned(random);
    if (kind == kMoment) return at_moments(std::vector<Moment>(rig_.nodes.size(), moment_at(part)));
    // Keys of joints that turn elsewhere than where they are bound move and turn them at a time.
    if (kind == kBranches || !own_pivots_.empty()) return bent(at_moments(of_branches(random)), random);
    return turned(random);
  };
  Pose out{bones_in(moving()), {}};
  for (const auto& [low, high] : morphs_) out.morphs.push_back(random.between(low, high));
  return out;
}

}  // namespace spherechain::baker

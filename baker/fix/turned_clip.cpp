// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/turned_clip.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace spherechain::baker {
namespace {

Eigen::Matrix3d cross_matrix(const Vec3& v) {
  Eigen::Matrix3d out;
  out << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return out;
}

// A turn d moves what is at `arm` in the joint's axes by d x arm.
Eigen::Matrix3d moves_of_arm(const Affine& axes, const Vec3& arm, const Vec3& x) {
  return -axes.linear() * cross_matrix(arm) * turn_derivative(x);
}

struct Local {
  Vec3 translation, scale;
  Eigen::Quaterniond rotation;
  bool is_animated = false;
};

}  // namespace

Eigen::Matrix3d turn_derivative(const Vec3& x) {
  const double angle = x.norm();
  const Eigen::Matrix3d c = cross_matrix(x);
  if (angle < 1e-6) return Eigen::Matrix3d::Identity() - 0.5 * c;
  return Eigen::Matrix3d::Identity() - (1 - std::cos(angle)) / (angle * angle) * c +
         (angle - std::sin(angle)) / (angle * angle * angle) * c * c;
}

Eigen::Quaterniond turned(const Eigen::Quaterniond& rotation, const Vec3& x) {
  const double angle = x.norm();
  if (angle == 0) return rotation;
  return rotation * Eigen::Quaterniond(Eigen::AngleAxisd(angle, x / angle));
}

double Hinge::bend(const Eigen::Quaterniond& rotation) const {
  const Vec3 from = rotation.inverse() * upper;
  return std::atan2(axis.dot(from.cross(lower)), from.dot(lower));
}

Eigen::Quaterniond rotation_at(const SourceRig& rig, const Clip& clip, Index node, double seconds) {
  Eigen::Quaterniond out = rig.nodes[node].rotation;
  for (const Channel& channel : clip.channels) {
    if (channel.path != ChannelPath::kRotation || channel.target != node) continue;
    out = Eigen::Quaterniond(sample(channel, seconds));
  }
  return out;
}

TurnedClip::TurnedClip(const SourceRig& rig, const Clip& clip, double fps, int frames, std::vector<TurningJoint> joints)
    : rig_(rig),
      clip_(clip),
      fps_(fps),
      frames_(frames),
      joints_(std::move(joints)),
      joint_of_node_(rig.nodes.size(), -1) {
  for (std::size_t j = 0; j < joints_.size(); ++j) joint_of_node_[joints_[j].node] = static_cast<int>(j);
  for (std::size_t n = 0; n < rig.nodes.size(); ++n) {
    const int parent = rig.nodes[n].parent;
    joint_at_or_above_.push_back(joint_of_node_[n] >= 0 || parent < 0
                                     ? joint_of_node_[n]
                                     : joint_at_or_above_[static_cast<std::size_t>(parent)]);
  }
  std::vector<std::uint8_t> moves(rig.nodes.size(), 0);
  std::vector<Index> turning;
  for (const Channel& channel : clip.channels) {
    if (channel.path != ChannelPath::kMorphWeight) moves[channel.target] = 1;
  }
  for (const TurningJoint& joint : joints_) {
    moves[joint.node] = 1;
    turning.push_back(joint.node);
  }
  moved_ = MovedNodes(rig, moves, turning);
  for (const Bone& bone : rig.bones) above_.push_back(joints_above(bone.node));
  for (const TurningJoint& joint : joints_) {
    rotations_.emplace_back();
    for (int f = 0; joint.hinge && f < frames; ++f) {
      rotations_.back().push_back(rotation_at(rig, clip, joint.node, f / fps));
    }
  }
}

Vec3 TurnedClip::within_limits(int frame, Index joint, Vec3 turn, double most) const {
  constexpr double kSlack = 0.01;  // radians
  const auto at_most = [&](const Vec3& v) { return v.norm() > most ? Vec3(most / v.norm() * v) : v; };
  turn = at_most(turn);
  const std::optional<Hinge>& hinge = joints_[joint].hinge;
  if (!hinge) return turn;
  const double bend = hinge->bend(turned(rotations_[joint][static_cast<std::size_t>(frame)], turn));
  const double allowed = std::clamp(bend, hinge->min_bend - kSlack, hinge->max_bend + kSlack);
  return at_most(turn + (allowed - bend) * hinge->axis);
}

std::vector<Index> TurnedClip::joints_above(Index node) const {
  std::vector<Index> out;
  for (int n = static_cast<int>(node); n >= 0;) {
    const int joint = joint_at_or_above_[static_cast<std::size_t>(n)];
    if (joint < 0) break;
    out.push_back(static_cast<Index>(joint));
    n = rig_.nodes[joints_[static_cast<std::size_t>(joint)].node].parent;
  }
  return out;
}

std::vector<Vec3> TurnedClip::turns_at(double frame, const Turns& turns) const {
  const int first = std::clamp(static_cast<int>(std::floor(frame)), 0, frames_ - 1);
  const auto here = static_cast<std::size_t>(first), next = static_cast<std::size_t>(std::min(first + 1, frames_ - 1));
  const double share = std::clamp(frame - first, 0.0, 1.0);
  std::vector<Vec3> out;
  for (std::size_t j = 0; j < count(); ++j) {
    out.push_back((1 - share) * turns[here * count() + j] + share * turns[next * count() + j]);
  }
  return out;
}

TurnedClip::Pose TurnedClip::pose_of(double frame, const std::vector<Vec3>& turns) const {
  const double seconds = frame / fps_;
  std::vector<Local> locals;  // as moved_ lists them
  for (const Index n : moved_.list()) {
    const Node& node = rig_.nodes[n];
    locals.push_back({node.translation, node.scale, node.rotation});
  }
  Pose out;
  for (const Morph& morph : rig_.morphs) out.deformation.morphs.push_back(morph.rest_weight);
  for (const Channel& channel : clip_.channels) {
    const Eigen::Vector4d v = sample(channel, seconds);
    if (channel.path == ChannelPath::kMorphWeight) {
      out.deformation.morphs[channel.target] = v[0];
      continue;
    }
    if (moved_.place(channel.target) < 0) continue;
    Local& local = locals[static_cast<std::size_t>(moved_.place(channel.target))];
    local.is_animated = true;
    if (channel.path == ChannelPath::kTranslation) local.translation = v.head<3>();
    if (channel.path == ChannelPath::kRotation) local.rotation = Eigen::Quaterniond(v);
    if (channel.path == ChannelPath::kScale) local.scale = v.head<3>();
  }
  std::vector<Affine> world;
  out.axes.resize(joints_.size());
  for (std::size_t i = 0; i < locals.size(); ++i) {
    const Index n = moved_.list()[i];
    const Node& node = rig_.nodes[n];
    Local& local = locals[i];
    const int joint = joint_of_node_[n];
    Affine own = node.local;
    if (local.is_animated || joint >= 0) {
      if (joint >= 0) local.rotation = turned(local.rotation, turns[static_cast<std::size_t>(joint)]);
      own.linear() = local.rotation.toRotationMatrix() * local.scale.asDiagonal();
      own.translation() = local.translation;
    }
    const Affine up = node.parent < 0 ? Affine::Identity() : moved_.world(static_cast<Index>(node.parent), world);
    world.push_back(up * own);
    if (joint >= 0) {
      Affine axes = Affine::Identity();
      axes.linear() = local.rotation.toRotationMatrix();
      axes.translation() = local.translation;
      out.axes[static_cast<std::size_t>(joint)] = rig_.to_rest * up * axes;
    }
  }
  out.deformation.bones = moved_.deformation(rig_, world);
  return out;
}

Eigen::Matrix3d turn_moves(const Affine& axes, const Vec3& at, const Vec3& x) {
  return moves_of_arm(axes, axes.linear().inverse() * (at - axes.translation()), x);
}

SpotMotion motion_of(const TurnedClip& clip, const TurnedClip::Pose& pose, const std::vector<Vec3>& rest,
                     const std::vector<VertexWeights>& weights, const SkinSpot& spot, const Vec3* turns) {
  SpotMotion out;
  std::vector<Vec3> arms(clip.count(), Vec3::Zero());  // a joint's: sum of shares times what it carries, in its axes
  std::vector<char> used(clip.count(), 0);
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const Index v = spot.vertices[corner];
    for (std::size_t k = 0; k < kMaxInfluences; ++k) {
      const double share = spot.shares[corner] * weights[v].weight[k];
      if (share == 0) continue;
      const Index bone = weights[v].joint[k];
      const Vec3 at = pose.deformation.bones[bone] * rest[v];
      out.at += share * at;
      for (const Index joint : clip.above(bone)) {
        const Affine& axes = pose.axes[joint];
        arms[joint] += share * (axes.linear().inverse() * (at - axes.translation()));
        used[joint] = 1;
      }
    }
  }
  for (Index joint = 0; joint < clip.count(); ++joint) {
    if (used[joint] == 0) continue;
    out.by_joint.emplace_back(joint, moves_of_arm(pose.axes[joint], arms[joint], turns[joint]));
  }
  return out;
}

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/motion/poses.h"

#include <algorithm>
#include <set>

#include "baker/mesh/decompose.h"

namespace spherechain::baker {
namespace {

Eigen::Quaterniond rotation_of(const Pose& pose, const std::string& joint) {
  const auto found = pose.rotations.find(joint);
  return found == pose.rotations.end() ? Eigen::Quaterniond::Identity() : found->second;
}

// From the character's axes, with its height as the unit, to the file's.
Affine to_file(const BodyFrame& frame) {
  Affine out;
  out.linear() << frame.left, frame.up, frame.forward;
  out.linear() *= frame.height;
  out.translation() = frame.origin;
  return out;
}

// How a joint at `position` moves, both in the character's axes.
Affine movement_of(const Pose& pose, const std::string& joint, const Vec3& position) {
  if (const auto found = pose.movements.find(joint); found != pose.movements.end()) return found->second;
  Affine out = Affine::Identity();
  out.linear() = rotation_of(pose, joint).toRotationMatrix();
  out.translation() = position - out.linear() * position;
  return out;
}

Affine half_way(const Affine& a, const Affine& b, const Vec3& position) {
  const auto [turn_a, stretch_a] = turn_and_stretch(a.linear());
  const auto [turn_b, stretch_b] = turn_and_stretch(b.linear());
  Affine out;
  const Eigen::Quaterniond turn = Eigen::Quaterniond(turn_a).slerp(0.5, Eigen::Quaterniond(turn_b));
  out.linear() = turn.toRotationMatrix() * (0.5 * (stretch_a + stretch_b));
  out.translation() = 0.5 * (a * position + b * position) - out.linear() * position;
  return out;
}

Pose half_way(const Pose& a, const Pose& b, const std::vector<Joint>& joints, const BodyFrame& frame) {
  std::set<std::string> turned;
  for (const auto& [joint, rotation] : a.rotations) turned.insert(joint);
  for (const auto& [joint, rotation] : b.rotations) turned.insert(joint);
  Pose middle;
  for (const std::string& joint : turned)
    middle.rotations[joint] = rotation_of(a, joint).slerp(0.5, rotation_of(b, joint));
  for (const Joint& joint : joints) {
    if (!a.movements.contains(joint.name) && !b.movements.contains(joint.name)) continue;
    const Vec3 position = to_file(frame).inverse() * joint.position;
    middle.movements[joint.name] =
        half_way(movement_of(a, joint.name, position), movement_of(b, joint.name, position), position);
  }
  return middle;
}

std::vector<double> weights_of(const Pose& pose, const std::vector<Morph>& morphs) {
  std::vector<double> out;
  for (const Morph& morph : morphs) {
    const auto found = pose.morphs.find(morph.name);
    out.push_back(found == pose.morphs.end() ? 0 : found->second);
  }
  return out;
}

using Bones = std::vector<Affine>;

Bones blend(double a, const Bones& x, double b, const Bones& y, double c, const Bones& z) {
  Bones out = x;
  for (std::size_t j = 0; j < out.size(); ++j) {
    out[j].matrix() = a * x[j].matrix() + b * y[j].matrix() + c * z[j].matrix();
  }
  return out;
}

}  // namespace

std::vector<Affine> bones_of(const std::vector<Joint>& joints, const BodyFrame& frame, const Pose& pose) {
  const auto own_of = [&](const Joint& joint) {
    Affine own = Affine::Identity();
    if (const auto moved = pose.movements.find(joint.name); moved != pose.movements.end()) {
      own = to_file(frame) * moved->second * to_file(frame).inverse();
    } else if (const auto found = pose.rotations.find(joint.name); found != pose.rotations.end()) {
      // The axis turns into the file's axes, the angle stays: no rotation stays exactly none.
      const Eigen::Quaterniond& q = found->second;
      const Vec3 axis = q.x() * frame.left + q.y() * frame.up + q.z() * frame.forward;
      own.linear() = Eigen::Quaterniond(q.w(), axis.x(), axis.y(), axis.z()).toRotationMatrix();
      own.translation() = joint.position - own.linear() * joint.position;
    }
    return own;
  };
  std::vector<Affine> out(joints.size());
  std::vector<bool> is_done(joints.size(), false);
  std::vector<std::size_t> way;  // up from a joint: its parent may come after it
  for (std::size_t j = 0; j < joints.size(); ++j) {
    for (int up = static_cast<int>(j); up >= 0 && !is_done[static_cast<std::size_t>(up)];
         up = joints[static_cast<std::size_t>(up)].parent) {
      way.push_back(static_cast<std::size_t>(up));
    }
    for (; !way.empty(); way.pop_back()) {
      const Joint& joint = joints[way.back()];
      const Affine own = own_of(joint);
      out[way.back()] = joint.parent < 0 ? own : out[static_cast<std::size_t>(joint.parent)] * own;
      is_done[way.back()] = true;
    }
  }
  return out;
}

BezierMotion::BezierMotion(const std::vector<Joint>& joints, const BodyFrame& frame, const PoseMotion& motion,
                           const std::vector<Morph>& morphs)
    : keys_{bones_of(joints, frame, {})}, morphs_{weights_of({}, morphs)} {
  Pose last;
  for (const Pose& next : motion.poses) {
    const Bones from = keys_.back(), to = bones_of(joints, frame, next);
    // The control point that leads the curve through the pose half-way: a limb swings on an arc, its length nearly
    // stays.
    keys_.push_back(blend(-0.5, from, 2, bones_of(joints, frame, half_way(last, next, joints, frame)), -0.5, to));
    keys_.push_back(to);
    morphs_.push_back(weights_of(next, morphs));
    last = next;
  }
}

Deformation BezierMotion::at(double t) const {
  const std::size_t stretches = keys_.size() / 2;
  if (stretches == 0 || t <= 0) return {keys_.front(), morphs_.front(), {}};
  if (t >= 1) return {keys_.back(), morphs_.back(), {}};
  const double along = t * static_cast<double>(stretches);
  const std::size_t stretch = std::min(static_cast<std::size_t>(along), stretches - 1);
  const double u = along - static_cast<double>(stretch);
  const Bones* key = &keys_[2 * stretch];
  std::vector<double> morphs = morphs_[stretch];
  for (std::size_t m = 0; m < morphs.size(); ++m) morphs[m] += u * (morphs_[stretch + 1][m] - morphs[m]);
  return {blend((1 - u) * (1 - u), key[0], 2 * u * (1 - u), key[1], u * u, key[2]), std::move(morphs), {}};
}

}  // namespace spherechain::baker

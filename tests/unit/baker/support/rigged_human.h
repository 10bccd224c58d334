// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <numbers>
#include <string>
#include <vector>

#include "baker/motion/poses.h"
#include "baker/rig/rig.h"
#include "human.h"

// The human with the joints and weights of the automatic rig.
struct RiggedHuman {
  const spherechain::baker::Character& character = human().character;
  const spherechain::baker::BodyFrame& frame = human().regions.frame;
  const spherechain::baker::Mesh& body = character.largest_piece.mesh;
  std::vector<spherechain::baker::Joint> joints = place_joints(human().regions);
  std::vector<spherechain::baker::VertexWeights> weights = bone_heat_weights(body, joints);

  std::size_t joint(const std::string& name) const {
    const auto found = std::find_if(joints.begin(), joints.end(), [&](const auto& j) { return j.name == name; });
    return static_cast<std::size_t>(found - joints.begin());
  }
  double weight(std::size_t vertex, const std::string& name) const {
    const spherechain::baker::VertexWeights& w = weights[vertex];
    double sum = 0;
    for (std::size_t k = 0; k < spherechain::baker::kMaxInfluences; ++k)
      sum += w.joint[k] == joint(name) ? w.weight[k] : 0.0;
    return sum;
  }
  // Left, up, forward, as fractions of the height.
  spherechain::baker::Vec3 own_axes(const spherechain::baker::Vec3& p) const {
    const spherechain::baker::Vec3 d = (p - frame.origin) / frame.height;
    return {d.dot(frame.left), d.dot(frame.up), d.dot(frame.forward)};
  }
  std::vector<spherechain::baker::Vec3> posed(const spherechain::baker::Pose& pose) const {
    return deform(body.positions, weights, bones_of(joints, frame, pose));
  }
};

inline const RiggedHuman& rigged_human() {
  static const RiggedHuman rigged;
  return rigged;
}

inline spherechain::baker::Pose turn(const std::string& joint, double degrees, const spherechain::baker::Vec3& axis) {
  spherechain::baker::Pose pose;
  pose.rotations[joint] = Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis.normalized());
  return pose;
}

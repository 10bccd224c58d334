// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion/motion.h"

namespace spherechain::baker {

std::vector<JointTransform> joint_transforms(const std::vector<Joint>& joints, const BodyFrame& frame,
                                             const Pose& pose) {
  std::vector<JointTransform> transforms;
  transforms.reserve(joints.size());
  for (const Joint& joint : joints) {
    JointTransform own{Eigen::Matrix3d::Identity(), Vec3::Zero()};
    if (const auto found = pose.rotations.find(joint.name); found != pose.rotations.end()) {
      // The axis turns into the file's axes, the angle stays: no rotation stays exactly none.
      const Eigen::Quaterniond& q = found->second;
      const Vec3 axis = q.x() * frame.left + q.y() * frame.up + q.z() * frame.forward;
      own.rotation = Eigen::Quaterniond(q.w(), axis.x(), axis.y(), axis.z()).toRotationMatrix();
      own.translation = joint.position - own.rotation * joint.position;
    }
    if (joint.parent >= 0) {
      const JointTransform& parent = transforms[static_cast<std::size_t>(joint.parent)];
      own.translation = parent.rotation * own.translation + parent.translation;
      own.rotation = parent.rotation * own.rotation;
    }
    transforms.push_back(own);
  }
  return transforms;
}

std::vector<Vec3> skin(const std::vector<Vec3>& rest, const std::vector<VertexWeights>& weights,
                       const std::vector<Joint>& joints, const BodyFrame& frame, const Pose& pose) {
  const std::vector<JointTransform> transforms = joint_transforms(joints, frame, pose);
  std::vector<Vec3> positions = rest;
  for (std::size_t v = 0; v < rest.size(); ++v) {
    for (std::size_t k = 0; k < 4 && weights[v].weight[k] > 0; ++k) {
      // Displacements, not positions: weights that sum to 1 only to rounding leave rest where it is.
      const JointTransform& t = transforms[weights[v].joint[k]];
      positions[v] += weights[v].weight[k] * (t.rotation * rest[v] + t.translation - rest[v]);
    }
  }
  return positions;
}

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "baker/play/play.h"
#include "spherechain/pose.h"

namespace spherechain::baker {

// The bones of an animated asset as a hierarchy of joints, which an engine has: a joint for each bone.
class BoneJoints {
 public:
  explicit BoneJoints(const AnimatedAsset& animated);

  // By joint; parents come first.
  const std::vector<std::uint32_t>& parents() const { return parents_; }
  // By bone.
  const std::vector<std::uint32_t>& joint_of_bone() const { return joint_of_bone_; }
  // By joint, in its parent's space. Empty where one is sheared, which no joint can be.
  std::vector<sc_transform> joints_of(const Deformation& deformation) const;
  // Where a bone's joint is, in the pose.
  Vec3 place_of(const Deformation& deformation, std::size_t bone) const {
    return world(deformation, bone).translation();
  }
  // The bones of such joints.
  std::vector<Affine> bones_of(const std::vector<sc_transform>& joints) const;

 private:
  Affine world(const Deformation& deformation, std::size_t bone) const {
    return bone < deformation.bones.size() ? deformation.bones[bone] * binds_[bone] : binds_[bone];
  }

  std::vector<Affine> binds_;       // a bone's, from its space to the rest pose
  std::vector<std::size_t> order_;  // bones, parents first
  std::vector<std::uint32_t> parents_, joint_of_bone_;
};

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#include "play/play.h"

#include "mesh/error.h"
#include "motion/poses.h"

namespace spherechain::baker {
namespace {

Vec3 to_vec3(const spherechain::Vec3& v) { return {v.x, v.y, v.z}; }

std::vector<Joint> joints_of(const Asset& asset) {
  std::vector<Joint> joints;
  for (std::size_t i = 0; i < asset.joint_count(); ++i) {
    const JointView joint = asset.joint(i);
    joints.push_back({joint.name, joint.parent, to_vec3(joint.position), to_vec3(joint.tail)});
  }
  return joints;
}

}  // namespace

AnimatedAsset::AnimatedAsset(const std::string& asset, const std::string& source, const MotionChoice& choice)
    : file_(open_asset(asset)), character_(import_character(source)) {
  const std::vector<float> rest = pack(character_.source_positions);
  if (const Status status = check_source(file_.asset, rest.data(), rest.size() / 3); status != Status::kOk) {
    throw Error(ExitCode::kFile,
                source + ": is not the mesh that " + asset + " was baked from (" + to_string(status) + ")");
  }
  if (choice.poses.empty()) return;
  const std::vector<Joint> joints = joints_of(file_.asset);
  motion_ = std::make_unique<BezierMotion>(joints, frame(), read_pose_motion(choice.poses, joints));
  weights_ = rig_weights(character_, joints);
  for (const Joint& joint : joints) bone_names_.push_back(joint.name);
}

BodyFrame AnimatedAsset::frame() const {
  const AssetInfo info = file_.asset.info();
  return {to_vec3(info.origin), to_vec3(info.left), to_vec3(info.up), to_vec3(info.forward),
          static_cast<double>(info.height)};
}

Deformation AnimatedAsset::deformation(int index, int count) const {
  if (!motion_) return {};
  return motion_->at(count > 1 ? static_cast<double>(index) / (count - 1) : 0.0);
}

std::vector<Vec3> AnimatedAsset::positions(const Deformation& deformation) const {
  return motion_ ? deform(character_.source_positions, weights_, deformation) : character_.source_positions;
}

}  // namespace spherechain::baker

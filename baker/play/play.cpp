// SPDX-License-Identifier: GPL-3.0-or-later
#include "play/play.h"

#include "mesh/error.h"

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

AnimatedAsset::AnimatedAsset(const std::string& asset, const std::string& source, const std::string& poses)
    : file_(open_asset(asset)), character_(import_character(source)) {
  const std::vector<float> rest = pack(character_.source_positions);
  if (const Status status = check_source(file_.asset, rest.data(), rest.size() / 3); status != Status::kOk) {
    throw Error(ExitCode::kFile,
                source + ": is not the mesh that " + asset + " was baked from (" + to_string(status) + ")");
  }
  if (poses.empty()) return;
  const std::vector<Joint> joints = joints_of(file_.asset);
  const PoseMotion motion = read_pose_motion(poses, joints);
  motion_.emplace(character_.source_positions, rig_weights(character_, joints), joints, frame(), motion);
}

BodyFrame AnimatedAsset::frame() const {
  const AssetInfo info = file_.asset.info();
  return {to_vec3(info.origin), to_vec3(info.left), to_vec3(info.up), to_vec3(info.forward),
          static_cast<double>(info.height)};
}

std::vector<Vec3> AnimatedAsset::positions(int index, int count) const {
  if (!motion_) return character_.source_positions;
  return motion_->at(count > 1 ? static_cast<double>(index) / (count - 1) : 0.0);
}

}  // namespace spherechain::baker

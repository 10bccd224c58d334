// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "import/import.h"
#include "mesh/error.h"
#include "motion/capture.h"
#include "roles/roles.h"

namespace spherechain::baker {
namespace {

std::vector<std::string> role_names(const Roles& roles) {
  std::vector<std::string> out;
  for (const NodeRole& node : roles.of_node) out.push_back(node.role);
  return out;
}

}  // namespace

Capture read_capture(const std::filesystem::path& file) {
  Capture capture;
  capture.file = file.string();
  capture.rig = read_source(file).rig;
  const auto longest = std::max_element(capture.rig.clips.begin(), capture.rig.clips.end(),
                                        [](const Clip& a, const Clip& b) { return a.duration < b.duration; });
  if (longest == capture.rig.clips.end()) throw Error(ExitCode::kFile, capture.file + ": has no motion");
  capture.clip = std::move(*longest);
  capture.rig.clips.clear();
  capture.roles = role_names(find_roles(capture.rig, {}));
  return capture;
}

CaptureBody body_of(const std::vector<Joint>& joints, const BodyFrame& frame) {
  CaptureBody body{frame, joints_by_role(joints), {}};
  body.joint_of_bone = body.joints.node;
  return body;
}

CaptureBody body_of(const SourceRig& rig, const std::vector<Vec3>& rest, const BodyFrame& frame,
                    const std::string& file) {
  const Roles roles = find_roles(rig, rest);
  CaptureBody body{frame, joints_by_role(rig.nodes, role_names(roles), rest_positions(rig)), {}};
  for (const char* role : {"pelvis", "left_hip", "right_hip", "left_knee", "right_knee", "left_ankle", "right_ankle"}) {
    if (roles.kind == BodyKind::kBiped && body.joints.find(role) >= 0) continue;
    throw Error(ExitCode::kFile, file + ": its skeleton is not that of a biped (a capture moves no other)");
  }
  for (const Bone& bone : rig.bones) body.joint_of_bone.push_back(body.joints.joint_of_node[bone.node]);
  return body;
}

}  // namespace spherechain::baker

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

// Roles of a biped that are not there, as words; empty where a recording can move the body, or be carried from it.
std::string missing_of(const RoleJoints& joints) {
  std::string out;
  for (const char* role : {"pelvis", "left_hip", "right_hip", "left_knee", "right_knee", "left_ankle", "right_ankle"}) {
    if (joints.find(role) >= 0) continue;
    std::string words = role;
    std::replace(words.begin(), words.end(), '_', ' ');
    out += (out.empty() ? "" : ", ") + words;
  }
  return out;
}

bool has_legs(const Capture& capture) {
  const std::vector<Vec3> places(capture.rig.nodes.size(), Vec3::Zero());
  return missing_of(joints_by_role(capture.rig.nodes, capture.roles, places)).empty();
}

// Throws Error(kFile) that begins with `file` where a recording could not move the body.
void check_legs(const RoleJoints& joints, const std::string& file) {
  const std::string missing = missing_of(joints);
  if (missing.empty()) return;
  throw Error(ExitCode::kFile, file + ": its body has no " + missing +
                                   " (a recording moves bipeds; --clip, --poses or meshes as frames move others)");
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
  // The file's own mesh may be a part of a character, such as a head.
  if (!has_legs(capture) && !capture.rig.bones.empty()) {
    capture.rig.bones.clear();
    capture.rig.weights.clear();
    capture.roles = role_names(find_roles(capture.rig, {}));
  }
  return capture;
}

CaptureBody body_of(const std::vector<Joint>& joints, const BodyFrame& frame, const std::string& file) {
  CaptureBody body{frame, joints_by_role(joints), {}};
  check_legs(body.joints, file);
  body.joint_of_bone = body.joints.node;
  return body;
}

CaptureBody body_of(const SourceRig& rig, const std::vector<Vec3>& rest, const BodyFrame& frame,
                    const std::string& file) {
  const Roles roles = find_roles(rig, rest);
  CaptureBody body{frame, joints_by_role(rig.nodes, role_names(roles), rest_positions(rig)), {}};
  if (roles.kind != BodyKind::kBiped) {
    throw Error(ExitCode::kFile, file + ": its skeleton is not that of a biped, and a recording moves no other (" +
                                     "spherechain inspect --roles says what its joints are taken for)");
  }
  check_legs(body.joints, file);
  for (const Bone& bone : rig.bones) body.joint_of_bone.push_back(body.joints.joint_of_node[bone.node]);
  return body;
}

}  // namespace spherechain::baker

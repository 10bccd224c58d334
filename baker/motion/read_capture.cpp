// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <numeric>
#include <optional>

#include "baker/import/choose_meshes.h"
#include "baker/import/import.h"
#include "baker/mesh/error.h"
#include "baker/motion/capture.h"
#include "baker/roles/roles.h"

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

namespace {

// Throws Error(kFile) if the rig has two characters: then that is why no body can be moved. Bones that move a vertex
// together belong to one.
void check_one_character(const SourceRig& rig, const std::vector<Vec3>& rest, const Vec3& up, const std::string& file) {
  std::vector<std::size_t> first(rig.bones.size());  // of the bones that hang together one that comes before
  std::iota(first.begin(), first.end(), 0);
  const auto root = [&](std::size_t bone) {
    while (first[bone] != bone) bone = first[bone] = first[first[bone]];
    return bone;
  };
  const auto for_each = [&](const VertexWeights& of, const auto& run) {
    for (std::size_t k = 0; k < of.joint.size(); ++k) {
      if (of.weight[k] > 0) run(of.joint[k]);
    }
  };
  for (const VertexWeights& of : rig.weights) {
    std::optional<std::size_t> one;
    for_each(of, [&](std::size_t bone) {
      const std::size_t a = root(bone), b = root(one.value_or(bone));
      const bool is_above = rig.bones[a].node < rig.bones[b].node;
      first[is_above ? b : a] = is_above ? a : b;
      one = bone;
    });
  }
  std::vector<SkinnedBox> skinned;
  for (const Bone& bone : rig.bones) skinned.push_back({{kNoIndex, bone.node, {}, {}, false}, {}});
  for (std::size_t v = 0; v < std::min(rest.size(), rig.weights.size()); ++v) {
    for_each(rig.weights[v], [&](std::size_t bone) { skinned[root(bone)].box.extend(rest[v]); });
  }
  std::erase_if(skinned, [](const SkinnedBox& one) { return one.box.isEmpty(); });
  const std::vector<std::string> names = characters_in(rig.nodes, skinned, up);
  if (names.empty()) return;
  throw Error(ExitCode::kFile, file + ": " + characters_text(names) +
                                   ", and a recording moves one (bake, check and fix take one by --character NAME)");
}

}  // namespace

CaptureBody body_of(const SourceRig& rig, const std::vector<Vec3>& rest, const BodyFrame& frame,
                    const std::string& file) {
  const Roles roles = find_roles(rig, rest);
  CaptureBody body{frame, joints_by_role(rig.nodes, role_names(roles), rest_positions(rig)), {}};
  const bool is_biped = roles.kind == BodyKind::kBiped;
  if (!is_biped || !missing_of(body.joints).empty()) check_one_character(rig, rest, frame.up, file);
  if (!is_biped) {
    throw Error(ExitCode::kFile, file + ": its skeleton is not that of a biped, and a recording moves no other (" +
                                     "spherechain inspect --roles says what its joints are taken for)");
  }
  check_legs(body.joints, file);
  for (const Bone& bone : rig.bones) body.joint_of_bone.push_back(body.joints.joint_of_node[bone.node]);
  return body;
}

}  // namespace spherechain::baker

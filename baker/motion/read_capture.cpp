// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "import/import.h"
#include "mesh/error.h"
#include "motion/capture.h"
#include "motion/clip.h"
#include "roles/roles.h"

namespace spherechain::baker {
namespace {

std::vector<std::string> role_names(const Roles& roles) {
  std::vector<std::string> out;
  for (const NodeRole& node : roles.of_node) out.push_back(node.role);
  return out;
}

const Node* find(const std::vector<Node>& nodes, const std::string& name) {
  const auto found = std::find_if(nodes.begin(), nodes.end(), [&](const Node& n) { return n.name == name; });
  return found == nodes.end() ? nullptr : &*found;
}

// The unit of `capture` in that of `rig` where each node that moves skin is in both, and as long; else 0.
double same_skeleton(const SourceRig& rig, const SourceRig& capture) {
  double own_sum = 0, other_sum = 0;
  std::vector<std::pair<double, double>> lengths;
  for (const Bone& bone : rig.bones) {
    const Node& own = rig.nodes[bone.node];
    const Node* other = find(capture.nodes, own.name);
    if (other == nullptr) return 0;
    // What hangs under no other bone is moved about, it has no length.
    const bool hangs = std::any_of(rig.bones.begin(), rig.bones.end(),
                                   [&](const Bone& b) { return static_cast<int>(b.node) == own.parent; });
    if (!hangs) continue;
    lengths.emplace_back(own.local.translation().norm(), other->local.translation().norm());
    own_sum += lengths.back().first;
    other_sum += lengths.back().second;
  }
  if (other_sum == 0) return 0;
  const double unit = own_sum / other_sum;
  constexpr double kSame = 0.02;
  for (const auto& [own, other] : lengths) {
    if (std::abs(own - unit * other) > kSame * own_sum / static_cast<double>(lengths.size())) return 0;
  }
  return unit;
}

// A clip of another file on the rig's own nodes of the same names.
class ClipByName : public Motion {
 public:
  ClipByName(const SourceRig& rig, const Capture& capture, double unit) : rig_(rig) {
    clip_.name = capture.clip.name;
    clip_.duration = capture.clip.duration;
    for (Channel channel : capture.clip.channels) {
      if (channel.path == ChannelPath::kMorphWeight) continue;
      const Node* own = find(rig.nodes, capture.rig.nodes[channel.target].name);
      if (own == nullptr) continue;
      channel.target = static_cast<Index>(own - rig.nodes.data());
      if (channel.path == ChannelPath::kTranslation) {
        for (double& value : channel.values) value *= unit;
      }
      clip_.channels.push_back(std::move(channel));
    }
  }
  Deformation at(double t) const override { return sample(rig_, clip_, t * clip_.duration); }
  double duration() const override { return clip_.duration; }
  double rate() const override { return rate_of(clip_); }

 private:
  const SourceRig& rig_;
  Clip clip_;
};

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

std::unique_ptr<Motion> capture_motion(const std::filesystem::path& file, const SourceRig& rig,
                                       const std::vector<Vec3>& rest, const BodyFrame& frame,
                                       const std::string& character) {
  Capture capture = read_capture(file);
  if (const double unit = same_skeleton(rig, capture.rig); unit > 0)
    return std::make_unique<ClipByName>(rig, capture, unit);
  return std::make_unique<CaptureMotion>(std::move(capture), body_of(rig, rest, frame, character));
}

}  // namespace spherechain::baker

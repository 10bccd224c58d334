// SPDX-License-Identifier: GPL-3.0-or-later
#include "play/play.h"

#include <algorithm>
#include <filesystem>

#include "mesh/error.h"
#include "motion/capture.h"
#include "motion/clip.h"
#include "motion/poses.h"
#include "motion/sequence.h"
#include "pipeline/pipeline.h"

namespace spherechain::baker {
namespace {

constexpr double kMostFrames = 1e6;

Vec3 to_vec3(const spherechain::Vec3& v) { return {v.x, v.y, v.z}; }

std::vector<Joint> joints_of(const Asset& asset) {
  std::vector<Joint> joints;
  for (std::size_t i = 0; i < asset.joint_count(); ++i) {
    const JointView joint = asset.joint(i);
    joints.push_back({joint.name, joint.parent, to_vec3(joint.position), to_vec3(joint.tail)});
  }
  return joints;
}

// What the asset was baked with: other options read other vertices, and another body may be closed.
BakeSettings settings_of(const Asset& asset, const std::string& file) {
  return make_settings("balanced", asset.info().settings, file);
}

}  // namespace

std::string MotionChoice::name() const {
  if (!poses.empty()) return std::filesystem::path(poses).filename().string();
  if (!motion.empty()) return std::filesystem::path(motion).filename().string();
  return clip;
}

AnimatedAsset::AnimatedAsset(const std::string& asset, const std::string& source, const MotionChoice& motion,
                             const FrameChoice& frames)
    : asset_name_(asset), file_(open_asset(asset)), fps_(frames.fps) {
  const BakeSettings settings = settings_of(file_.asset, asset);
  segment_settings_ = settings.segment;
  character_ = import_character(source, settings.import);
  const std::vector<float> rest = pack(character_.source_positions);
  if (const Status status = check_source(file_.asset, rest.data(), rest.size() / 3); status != Status::kOk) {
    throw Error(ExitCode::kFile,
                source + ": is not the mesh that " + asset + " was baked from (" + to_string(status) + ")");
  }
  if (!motion.poses.empty() && !is_sequence(motion.poses)) {
    play_poses(motion.poses);
  } else if (!motion.poses.empty()) {
    motion_ = std::make_unique<SequenceMotion>(character_, sequence_files(motion.poses), SequenceMotion::Path::kBezier);
  } else if (!motion.motion.empty() && !is_sequence(motion.motion)) {
    play_capture(source, motion.motion);
  } else if (!motion.motion.empty()) {
    motion_ =
        std::make_unique<SequenceMotion>(character_, sequence_files(motion.motion), SequenceMotion::Path::kFrames);
  } else if (!motion.clip.empty() || !character_.rig.clips.empty()) {
    play_clips(source, motion.clip);
  }
  frame_count_ = frames.count;
  if (frame_count_ == 0 && motion_) frame_count_ = motion_->frame_count();
  if (frame_count_ == 0 && motion_ && motion_->duration() > 0) {
    frame_count_ = static_cast<int>(std::min(motion_->duration() * fps_ + 1e-6, kMostFrames)) + 1;
  }
  if (frame_count_ == 0) frame_count_ = 40;
}

void AnimatedAsset::play_poses(const std::string& file) {
  const std::vector<Joint> joints = joints_of(file_.asset);
  if (joints.empty()) {
    throw Error(ExitCode::kFile, file + ": turns the joints of a biped, and " + asset_name_ +
                                     " has none: it is of another body (--clip, --motion or meshes as poses move it)");
  }
  motion_ = std::make_unique<BezierMotion>(joints, frame(), read_pose_motion(file, joints));
  use_rig(joints);
}

// On the source's own skeleton, where it has one.
void AnimatedAsset::play_capture(const std::string& source, const std::string& file) {
  if (!character_.rig.bones.empty()) {
    motion_ = capture_motion(file, character_.rig, character_.source_positions, frame(), source);
    return use_skin();
  }
  const std::vector<Joint> joints = joints_of(file_.asset);
  motion_ = std::make_unique<CaptureMotion>(read_capture(file), body_of(joints, frame()));
  use_rig(joints);
}

// By name, or by number where no name is that; all of them where none is asked for.
void AnimatedAsset::play_clips(const std::string& source, const std::string& wanted) {
  const SourceRig& rig = character_.rig;
  std::vector<const Clip*> clips;
  std::string names;
  for (const Clip& clip : rig.clips) {
    if (wanted.empty() || clip.name == wanted) clips.push_back(&clip);
    names += (names.empty() ? "" : ", ") + clip.name;
  }
  for (std::size_t i = 0; i < rig.clips.size() && clips.empty(); ++i) {
    if (std::to_string(i) == wanted) clips.push_back(&rig.clips[i]);
  }
  if (clips.empty()) {
    throw Error(ExitCode::kFile, source + ": has no clip '" + wanted + "' (" +
                                     (names.empty() ? "it has none at all" : "it has " + names) + ")");
  }
  if (!wanted.empty()) clips.erase(clips.begin() + 1, clips.end());  // names need not differ
  motion_ = std::make_unique<ClipMotion>(rig, clips);
  use_skin();
}

void AnimatedAsset::use_skin() {
  weights_ = character_.rig.weights;
  for (const Bone& bone : character_.rig.bones) bone_names_.push_back(character_.rig.nodes[bone.node].name);
}

void AnimatedAsset::use_rig(const std::vector<Joint>& joints) {
  if (character_.rig.bones.empty()) {
    close_body(character_, segment_settings_);  // the one whose weights the bake took
  }
  weights_ = rig_weights(character_, joints);
  for (const Joint& joint : joints) bone_names_.push_back(joint.name);
}

void AnimatedAsset::check_leaves() const {
  if (asset().leaf_count() > 0) return;
  throw Error(ExitCode::kFile, asset_name_ + ": has no leaves to find contacts with (bake it again)");
}

BodyFrame AnimatedAsset::frame() const {
  const AssetInfo info = file_.asset.info();
  return {to_vec3(info.origin), to_vec3(info.left), to_vec3(info.up), to_vec3(info.forward),
          static_cast<double>(info.height)};
}

double AnimatedAsset::time(int frame) const {
  const double duration = motion_ ? motion_->duration() : 0;
  return duration > 0 ? along(frame) * duration : frame / fps_;
}

std::string AnimatedAsset::clip_at(int frame) const { return motion_ ? motion_->clip_at(along(frame)) : std::string(); }

Deformation AnimatedAsset::deformation(int frame) const { return motion_ ? motion_->at(along(frame)) : Deformation(); }

std::vector<Vec3> AnimatedAsset::positions(const Deformation& deformation) const {
  if (!deformation.positions.empty()) return deformation.positions;
  return deform(morph(character_.source_positions, character_.rig.morphs, deformation.morphs), weights_,
                deformation.bones);
}

std::vector<float> bone_palette(const Asset& asset, const Deformation& deformation) {
  std::vector<float> out;
  for (std::size_t b = 0; b < asset.bone_count(); ++b) {
    const Affine bone = b < deformation.bones.size() ? deformation.bones[b] : Affine::Identity();
    for (Eigen::Index row = 0; row < 3; ++row) {
      for (Eigen::Index column = 0; column < 4; ++column) out.push_back(static_cast<float>(bone(row, column)));
    }
  }
  return out;
}

}  // namespace spherechain::baker

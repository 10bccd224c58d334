// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/play/play.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "baker/mesh/error.h"
#include "baker/motion/capture.h"
#include "baker/motion/carried_motion.h"
#include "baker/motion/clip.h"
#include "baker/motion/frame_times.h"
#include "baker/motion/sequence.h"
#include "baker/pipeline/pipeline.h"

namespace spherechain::baker {
namespace {

Vec3 to_vec3(const spherechain::Vec3& v) { return {v.x, v.y, v.z}; }

// Throws Error(kFile) where frames are too many to look at each.
void check_count(const MotionFrames& frames, const std::string& file) {
  const ClipFrames* longest = nullptr;
  double count = 0;
  for (const ClipFrames& clip : frames.clips) {
    count += clip.own_count;
    if (longest == nullptr || clip.own_count > longest->own_count) longest = &clip;
  }
  if (count <= kFramesMax) return;
  const std::string clip = longest->clip == nullptr ? "" : fmt::format(", most in the clip '{}'", longest->name);
  throw Error(ExitCode::kFile, fmt::format("{}: {:.0f} frames at {:.4g} a second{}: {:.0f} at most (cut it, or look at "
                                           "fewer a second: --fps)",
                                           file, count, longest->fps, clip, kFramesMax));
}

}  // namespace

BakeSettings settings_of(const OpenAsset& asset, const std::string& file) {
  try {
    return make_settings("balanced", asset->info().settings, file);
  } catch (const Error& error) {
    throw Error(error.code(), std::string(error.what()) + " (bake it again)");
  }
}

std::string MotionChoice::name() const {
  if (!poses.empty()) return std::filesystem::path(poses).filename().string();
  if (!motion.empty()) return std::filesystem::path(motion).filename().string();
  return clip;
}

AnimatedAsset::AnimatedAsset(const std::string& asset, const std::string& source, const MotionChoice& motion,
                             const FrameChoice& frames)
    : AnimatedAsset(open_asset(asset), asset, source, motion, frames) {}

AnimatedAsset::AnimatedAsset(OpenAsset asset, const std::string& name, const std::string& source,
                             const MotionChoice& motion, const FrameChoice& frames)
    : asset_name_(name), source_name_(source), file_(std::move(asset)) {
  const BakeSettings settings = settings_of(file_, name);
  roles_ = settings.roles;
  segment_settings_ = settings.segment;
  import_ = settings.import;
  character_ = import_character(source, import_);
  const std::vector<float> rest = pack(character_.source_positions);
  if (const Status status = sc_check_source(file_.handle(), SC_WHOLE_SOURCE, rest.data(), rest.size() / 3, 12);
      status != SC_OK) {
    throw Error(ExitCode::kFile,
                source + ": is not the mesh that " + name + " was baked from (" + to_string(status) + ")");
  }
  play(motion, frames);
}

SourceLook AnimatedAsset::look() const {
  ImportOptions options = import_;
  options.look = true;
  try {
    SourceLook look = read_source(source_name_, options).look;
    const bool is_whole = look.uvs.size() == character_.source_positions.size() &&
                          look.material_of.size() == character_.source_triangles.size();
    return is_whole ? std::move(look) : SourceLook();
  } catch (const std::exception&) {
    return {};
  }
}

void AnimatedAsset::play(const MotionChoice& motion, const FrameChoice& frames) {
  std::vector<const Clip*> clips;
  fps_ = frames.fps;
  motion_.reset();
  if (!motion.poses.empty() && !is_sequence(motion.poses)) {
    play_poses(motion.poses);
  } else if (!motion.poses.empty()) {
    motion_ = std::make_unique<SequenceMotion>(character_, sequence_files(motion.poses), SequenceMotion::Path::kBezier);
  } else if (!motion.motion.empty() && !is_sequence(motion.motion)) {
    play_capture(motion.motion);
  } else if (!motion.motion.empty()) {
    motion_ =
        std::make_unique<SequenceMotion>(character_, sequence_files(motion.motion), SequenceMotion::Path::kFrames);
  } else if (!motion.clip.empty() || !character_.rig.clips.empty()) {
    clips = find_clips(motion.clip);
    use_skin();
  }
  frames_ = clips.empty() ? frames_of(motion_.get(), frames) : frames_of(character_.rig, clips, frames);
  if (frames.count == 0) check_count(frames_, motion.motion.empty() ? source_name_ : motion.motion);
}

void AnimatedAsset::play_clip(const Clip& clip, const FrameChoice& frames) {
  fps_ = frames.fps;
  motion_.reset();
  use_skin();
  frames_ = frames_of(character_.rig, {&clip}, frames);
}

void AnimatedAsset::take_joints() {
  if (!weights_.empty() || motion_ != nullptr) return;
  const bool has_skeleton = !character_.rig.bones.empty();
  const std::vector<Joint> joints = has_skeleton ? own_joints(character_.rig) : joints_of(file_);
  if (joints.empty()) return;
  if (has_skeleton)
    use_skin();
  else
    use_rig(joints);
  motion_ = std::make_unique<BezierMotion>(joints, frame(), PoseMotion(), character_.rig.morphs);
}

Roles AnimatedAsset::roles() const {
  return find_roles(character_.rig, character_.source_positions, roles_, segment_settings_.body);
}

void AnimatedAsset::play_poses(const std::string& file) {
  if (rig_of_poses(file) == PoseRig::kOwn) {
    const SourceRig& rig = character_.rig;
    if (rig.bones.empty()) {
      throw Error(ExitCode::kFile, file + ": turns joints of the character's own skeleton, and " + source_name_ +
                                       " has none (without \"rig\": \"own\" it turns those of the automatic rig)");
    }
    const std::vector<Joint> joints = own_joints(rig);
    motion_ = std::make_unique<BezierMotion>(joints, frame(), read_pose_motion(file, joints, rig.morphs), rig.morphs);
    return use_skin();
  }
  if (!character_.rig.bones.empty()) {
    throw Error(ExitCode::kFile, file + ": turns the joints of the automatic rig, and " + asset_name_ +
                                     " moves with the character's own skeleton (write \"rig\": \"own\" beside the " +
                                     "poses, and turn the joints of that one)");
  }
  const std::vector<Joint> joints = joints_of(file_);
  if (joints.empty()) {
    throw Error(ExitCode::kFile, file + ": turns the joints of a biped, and " + asset_name_ +
                                     " has none: it is of another body (--clip, --motion or meshes as poses move it)");
  }
  motion_ = std::make_unique<BezierMotion>(joints, frame(), read_pose_motion(file, joints));
  use_rig(joints);
}

// On the source's own skeleton, where it has one.
void AnimatedAsset::play_capture(const std::string& file) {
  if (!character_.rig.bones.empty()) {
    motion_ = carried_motion(file, character_.rig, character_.source_positions, frame(), source_name_);
    return use_skin();
  }
  const std::vector<Joint> joints = joints_of(file_);
  motion_ = std::make_unique<CaptureMotion>(read_capture(file), body_of(joints, frame(), source_name_));
  use_rig(joints);
}

// By name, or by number where no name is that; all of them where none is asked for.
std::vector<const Clip*> AnimatedAsset::find_clips(const std::string& wanted) const {
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
    throw Error(ExitCode::kFile, source_name_ + ": has no clip '" + wanted + "' (" +
                                     (names.empty() ? "it has none at all" : "it has " + names) + ")");
  }
  if (!wanted.empty()) clips.erase(clips.begin() + 1, clips.end());  // names need not differ
  return clips;
}

void AnimatedAsset::use_skin() {
  bone_names_.clear();
  weights_ = character_.rig.weights;
  for (const Bone& bone : character_.rig.bones) bone_names_.push_back(character_.rig.nodes[bone.node].name);
}

void AnimatedAsset::use_rig(const std::vector<Joint>& joints) {
  check_clusters();  // which have the weights
  bone_names_.clear();
  weights_ = weights_of(file_, character_);
  for (const Joint& joint : joints) bone_names_.push_back(joint.name);
}

void AnimatedAsset::check_clusters() const {
  if (asset().surface().clusters.size > 0) return;
  throw Error(ExitCode::kFile, asset_name_ + ": has no clusters to find contacts with (bake it again)");
}

BodyFrame AnimatedAsset::frame() const {
  const AssetInfo info = file_->info();
  return {to_vec3(info.origin), to_vec3(info.left), to_vec3(info.up), to_vec3(info.forward),
          static_cast<double>(info.height)};
}

Deformation AnimatedAsset::deformation(const MotionFrame& at) const {
  if (const Clip* clip = clips()[at.clip].clip) return sample(character_.rig, *clip, at.seconds);
  return motion_ ? motion_->at(at.along) : Deformation();
}

std::vector<Vec3> AnimatedAsset::positions(const Deformation& deformation) const {
  if (!deformation.positions.empty()) return deformation.positions;
  return deform(morph(character_.source_positions, character_.rig.morphs, deformation.morphs), weights_,
                deformation.bones);
}

std::vector<Joint> joints_of(const OpenAsset& asset) {
  std::vector<Joint> joints;
  for (std::size_t i = 0; i < asset->joint_count(); ++i) {
    const JointView joint = asset->joint(i);
    joints.push_back({joint.name, joint.parent, to_vec3(joint.position), to_vec3(joint.tail)});
  }
  return joints;
}

double mm_per_unit(const OpenAsset& asset) { return 1000 * asset.metres_per_unit(); }

std::vector<VertexWeights> weights_of(const OpenAsset& asset, const Character& character) {
  const Surface& surface = asset.surface();
  std::vector<VertexWeights> of_vertex(surface.source_vertices.size);
  for (const spherechain::Cluster& cluster : surface.clusters) {
    for (std::size_t slot = 0; slot < cluster.vertex_count; ++slot) {
      VertexWeights& weights = of_vertex[surface.cluster_vertices[cluster.first_vertex + slot]];
      if (weights.weight[0] > 0) continue;  // another cluster has it, too
      std::vector<std::pair<double, Index>> influences;
      for (std::size_t bone = 0; bone < cluster.bone_count; ++bone) {
        const float weight = surface.slot_weights[cluster.first_weight + bone * slot_count(cluster) + slot];
        if (weight > 0) influences.emplace_back(-double{weight}, surface.cluster_bones[cluster.first_bone + bone]);
      }
      std::sort(influences.begin(), influences.end());
      for (std::size_t k = 0; k < std::min(influences.size(), kMaxInfluences); ++k) {
        weights.weight[k] = -influences[k].first;
        weights.joint[k] = influences[k].second;
      }
    }
  }
  // Triangles that the import dropped may have vertices of their own: they move like what they were welded to.
  std::vector<Index> vertex_of_skin(character.skin.positions.size(), kNoIndex);
  for (std::size_t t = 0; t < surface.place_of_source.size; ++t) {
    const std::uint32_t place = surface.place_of_source[t];
    for (std::size_t k = 0; place != kNoPlace && k < 3; ++k) {
      const Index skin = character.skin_of_source[character.source_triangles[t][k]];
      if (skin != kNoIndex) vertex_of_skin[skin] = surface.triangle_vertices[3 * place + k];
    }
  }
  std::vector<VertexWeights> out;
  for (const Index skin : character.skin_of_source) {
    const Index vertex = skin == kNoIndex ? kNoIndex : vertex_of_skin[skin];
    out.push_back(vertex == kNoIndex ? VertexWeights() : of_vertex[vertex]);
  }
  return out;
}

BodyParts body_parts_of(const OpenAsset& asset) {
  constexpr std::uint8_t kNone = 255;
  BodyParts out;
  for (std::size_t i = 0; i < asset->part_count(); ++i) {
    const sc_part part = asset->part(i);
    out.parts.push_back(
        {part.name, static_cast<Side>(part.side), part.bone, part.parent, static_cast<std::uint8_t>(part.mobility)});
  }
  out.of_triangle.assign(asset->info().triangle_count, kNone);
  const Surface& surface = asset.surface();
  for (std::size_t t = 0; t < surface.triangles.size; ++t) out.of_triangle[surface.triangles[t]] = surface.parts[t];
  return out;
}

std::vector<float> bone_palette(const OpenAsset& asset, const Deformation& deformation) {
  std::vector<float> out;
  for (std::size_t b = 0; b < asset->bone_count(); ++b) {
    const Affine bone = b < deformation.bones.size() ? deformation.bones[b] : Affine::Identity();
    for (Eigen::Index row = 0; row < 3; ++row) {
      for (Eigen::Index column = 0; column < 4; ++column) out.push_back(static_cast<float>(bone(row, column)));
    }
  }
  return out;
}

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "baker/bind/body_parts.h"
#include "baker/import/import.h"
#include "baker/motion/motion.h"
#include "baker/motion/poses.h"
#include "baker/play/asset_file.h"
#include "baker/play/motion_frames.h"
#include "baker/rig/rig.h"
#include "baker/roles/roles.h"
#include "baker/segment/segment.h"

namespace spherechain::baker {

struct BakeSettings;

// The motion to play: at most one. If empty: all clips in the source, or the rest pose if it has none.
struct MotionChoice {
  std::string poses;   // a pose file, or whole meshes that are poses (motion/sequence.h)
  std::string clip;    // name or number of a clip of the source's own
  std::string motion;  // a file of motion capture, or whole meshes that are frames

  std::string name() const;  // for people
};

// An asset, the mesh it was baked from, and the motion to play. Every command that animates starts with it.
class AnimatedAsset {
 public:
  // Throws Error(kFile) where a file has the wrong content, or the source is not the asset's.
  AnimatedAsset(const std::string& asset, const std::string& source, const MotionChoice& motion,
                const FrameChoice& frames);
  // Uses an asset that is already open; `name` is for messages.
  AnimatedAsset(OpenAsset asset, const std::string& name, const std::string& source, const MotionChoice& motion,
                const FrameChoice& frames);

  // Plays another motion in place of that one. Throws Error(kFile).
  void play(const MotionChoice& motion, const FrameChoice& frames);
  // A clip of the source's nodes that is not the source's own; it must outlive this.
  void play_clip(const Clip& clip, const FrameChoice& frames);

  // Where nothing plays, takes the joints that would move the skin, at rest: the character's own, else the automatic
  // rig's.
  void take_joints();

  // More frames between those that play now (motion_frames.h).
  void put_between(const std::vector<std::vector<double>>& shares) { frames_ = with_frames_between(frames_, shares); }

  const std::string& file() const { return asset_name_; }  // the asset's, as it was given
  const OpenAsset& asset() const { return file_; }
  const Character& character() const { return character_; }
  // Reads the source again to show its look. Empty if that fails.
  SourceLook look() const;
  // Throws Error(kFile) where the asset has no clusters, which skin contacts are found with.
  void check_clusters() const;
  BodyFrame frame() const;

  // Weights of every source vertex. Empty if nothing moves.
  const std::vector<VertexWeights>& weights() const { return weights_; }
  const std::vector<std::string>& bone_names() const { return bone_names_; }
  Roles roles() const;  // of the source's nodes, as in the bake

  int frame_count() const { return static_cast<int>(frames_.frames.size()); }
  const MotionFrame& frame_at(int frame) const { return frames_.frames[static_cast<std::size_t>(frame)]; }
  const std::vector<ClipFrames>& clips() const { return frames_.clips; }
  double fps() const { return fps_; }
  // Frames a second that a clip's keys, or a recording's poses, lie at; 0 where it has none.
  double own_rate(std::size_t clip) const {
    return clips()[clip].clip != nullptr ? rate_of(*clips()[clip].clip) : motion_ ? motion_->rate() : 0;
  }
  // Its number in its clip, and how far on to the next.
  double number(int frame) const { return frame_at(frame).number + frame_at(frame).between; }
  double time(int frame) const { return frame_at(frame).time; }
  const std::string& clip_at(int frame) const { return clips()[frame_at(frame).clip].name; }
  Deformation deformation(int frame) const { return deformation(frame_at(frame)); }
  Deformation deformation(const MotionFrame& frame) const;
  // The deformed source vertices of such a frame.
  std::vector<Vec3> positions(const Deformation& deformation) const;

 private:
  void play_poses(const std::string& file);
  void use_skin();                                 // the source's own
  void use_rig(const std::vector<Joint>& joints);  // the automatic rig, by the weights in the asset
  void play_capture(const std::string& file);
  std::vector<const Clip*> find_clips(const std::string& wanted) const;

  std::string asset_name_, source_name_;
  OpenAsset file_;
  Character character_;
  ImportOptions import_;  // of the bake, as the next two
  RoleFile roles_;
  SegmentSettings segment_settings_;
  std::vector<VertexWeights> weights_;
  std::vector<std::string> bone_names_;
  std::unique_ptr<Motion> motion_;  // null where clips or nothing plays
  MotionFrames frames_;
  double fps_;
};

// Settings that the asset was baked with: others would read other vertices, or close another body.
BakeSettings settings_of(const OpenAsset& asset, const std::string& file);

// Millimetres in one of the source's units.
double mm_per_unit(const OpenAsset& asset);

// The automatic rig's; empty for a character with bones of its own.
std::vector<Joint> joints_of(const OpenAsset& asset);

// Weights of every source vertex to the asset's bones, as the runtime skins with them. A vertex that no triangle uses
// has none.
std::vector<VertexWeights> weights_of(const OpenAsset& asset, const Character& character);

// The asset's body parts; 255 where a source triangle has none.
BodyParts body_parts_of(const OpenAsset& asset);

// The bone matrices that a game passes to the runtime: rows of a 3 by 4 matrix for each of the asset's bones. Bone
// slots without a bone get the identity.
std::vector<float> bone_palette(const OpenAsset& asset, const Deformation& deformation);

}  // namespace spherechain::baker

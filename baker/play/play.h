// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "import/import.h"
#include "motion/motion.h"
#include "play/asset_file.h"
#include "rig/rig.h"
#include "segment/segment.h"

namespace spherechain::baker {

// What to play: at most one. None: all clips of the source's own, or where it has none, the rest pose.
struct MotionChoice {
  std::string poses;   // a pose file, or whole meshes that are poses (motion/sequence.h)
  std::string clip;    // name or number of a clip of the source's own
  std::string motion;  // a file of motion capture, or whole meshes that are frames

  std::string name() const;  // for people
};

// The frames of a motion: `count` 0 means as many as it has of its own, or as its duration has at `fps`, or 40.
struct FrameChoice {
  int count = 0;
  double fps = 30;
};

// An asset, the mesh it was baked from, and the motion to play: what every command that animates starts with.
class AnimatedAsset {
 public:
  // Throws Error(kFile) where a file is not what it should be, or the source is not the asset's.
  AnimatedAsset(const std::string& asset, const std::string& source, const MotionChoice& motion,
                const FrameChoice& frames);

  const std::string& file() const { return asset_name_; }  // the asset's, as it was given
  const Asset& asset() const { return file_.asset; }
  const Character& character() const { return character_; }
  // Throws Error(kFile) where the asset has no leaves, which contacts of triangles are found with.
  void check_leaves() const;
  BodyFrame frame() const;

  // Of every source vertex; empty where nothing moves.
  const std::vector<VertexWeights>& weights() const { return weights_; }
  const std::vector<std::string>& bone_names() const { return bone_names_; }

  // Frames are evenly spaced: 0 is the motion's start, the last its end.
  int frame_count() const { return frame_count_; }
  double time(int frame) const;          // seconds
  std::string clip_at(int frame) const;  // its name, where the motion is clips
  Deformation deformation(int frame) const;
  // The deformed source vertices of such a frame.
  std::vector<Vec3> positions(const Deformation& deformation) const;

 private:
  void play_poses(const std::string& file);
  void use_skin();  // the source's own
  void use_rig(const std::vector<Joint>& joints);
  void play_capture(const std::string& source, const std::string& file);
  void play_clips(const std::string& source, const std::string& wanted);

  std::string asset_name_;
  AssetFile file_;
  Character character_;
  SegmentSettings segment_settings_;  // those of the bake
  std::vector<VertexWeights> weights_;
  std::vector<std::string> bone_names_;
  std::unique_ptr<Motion> motion_;
  int frame_count_ = 1;
  double fps_;

  double along(int frame) const { return frame_count_ > 1 ? static_cast<double>(frame) / (frame_count_ - 1) : 0.0; }
};

// What a game would hand to the runtime: rows of a 3 by 4 matrix for each of the asset's bones, the identity for what
// hangs on none.
std::vector<float> bone_palette(const Asset& asset, const Deformation& deformation);

}  // namespace spherechain::baker

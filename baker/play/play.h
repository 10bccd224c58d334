// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "import/import.h"
#include "motion/motion.h"
#include "play/asset_file.h"
#include "segment/body_plan.h"

namespace spherechain::baker {

// What to play. Nothing chosen: the rest pose is held.
struct MotionChoice {
  std::string poses;  // a pose file
};

// An asset, the mesh it was baked from, and the motion to play: what every command that animates starts with.
class AnimatedAsset {
 public:
  // Throws Error(kFile) where a file is not what it should be, or the source is not the asset's.
  AnimatedAsset(const std::string& asset, const std::string& source, const MotionChoice& choice);

  const Asset& asset() const { return file_.asset; }
  const Character& character() const { return character_; }
  BodyFrame frame() const;

  // Of every source vertex; empty where nothing moves.
  const std::vector<VertexWeights>& weights() const { return weights_; }
  const std::vector<std::string>& bone_names() const { return bone_names_; }

  // Frame `index` of `count`: the first is the motion's start, the last its end.
  Deformation deformation(int index, int count) const;
  // The deformed source vertices of such a frame.
  std::vector<Vec3> positions(const Deformation& deformation) const;

 private:
  AssetFile file_;
  Character character_;
  std::vector<VertexWeights> weights_;
  std::vector<std::string> bone_names_;
  std::unique_ptr<Motion> motion_;
};

}  // namespace spherechain::baker

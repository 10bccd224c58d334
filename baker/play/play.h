// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "import/import.h"
#include "motion/motion.h"
#include "play/asset_file.h"
#include "spherechain/refit.h"

namespace spherechain::baker {

// An asset, the mesh it was baked from, and the motion to play: what every command that animates starts with.
class AnimatedAsset {
 public:
  // `poses` may be empty: the rest pose is held. Throws Error(kFile) where a file is not what it should be, or the source is
  // not the asset's.
  AnimatedAsset(const std::string& asset, const std::string& source, const std::string& poses);

  const Asset& asset() const { return file_.asset; }
  const Character& character() const { return character_; }
  BodyFrame frame() const;

  // The deformed source vertices of frame `index` of `count`: the first is the rest pose, the last the last pose.
  std::vector<Vec3> positions(int index, int count) const;

 private:
  AssetFile file_;
  Character character_;
  std::optional<BezierMotion> motion_;
};

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "baker/pipeline/pipeline.h"

namespace spherechain::paper {

using baker::Bake;
using baker::Index;
using baker::Vec3;

struct Animation {
  std::string name;
  std::vector<std::vector<Vec3>> frames;  // deformed source vertices
};

// The character every experiment is made on, segmented once, and its two animations.
class Study {
 public:
  Study(const std::filesystem::path& character, const std::filesystem::path& poses, int frames);

  // The stages from the fit on, with a profile and settings as in a --config file.
  Bake bake(const std::string& profile, const std::string& json) const;

  // The two profiles as they are.
  const Bake& paper() const { return paper_; }
  const Bake& balanced() const { return balanced_; }
  const std::vector<Animation>& animations() const { return animations_; }
  double mm() const { return 1000 * paper_.character.metres_per_unit; }
  // Marks the region that the paper covers: the body without head, hands and feet.
  const std::vector<bool>& core() const { return core_; }

 private:
  Bake paper_, balanced_;
  std::vector<Animation> animations_;
  std::vector<bool> core_;  // a triangle of the body
};

}  // namespace spherechain::paper

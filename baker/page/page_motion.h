// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "play/play.h"

namespace spherechain::baker {

// A run of frames that one clip has.
struct PageClip {
  std::string name;
  int first_frame, frame_count;
};
// One clip called `name` where the motion is not made of clips.
std::vector<PageClip> page_clips(const AnimatedAsset& animated, const std::string& name);

// What moves the mesh, frame by frame: bones and weights of morph targets, or the vertices themselves.
class PageMotion {
 public:
  PageMotion(const Character& character, const BodyFrame& axes) : character_(character), axes_(axes) {}

  // Frames in order. `positions` are those of the deformation.
  void add(const Deformation& deformation, const std::vector<Vec3>& positions);

  // So far.
  std::size_t bytes() const;

  // Once all frames are there. A morph target that never changes is in the rest positions, and stored nowhere else.
  std::vector<Vec3> rest() const;
  nlohmann::ordered_json json() const;

 private:
  bool moves(std::size_t morph) const;

  const Character& character_;
  BodyFrame axes_;
  std::size_t frames_ = 0, morph_count_ = 0;
  std::vector<float> bones_, vertices_, morphs_;
  std::vector<float> boxes_, centers_;  // of the character in the axes, their height as the unit
};

}  // namespace spherechain::baker

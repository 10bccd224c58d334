// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "baker/import/import.h"
#include "baker/motion/motion.h"
#include "baker/segment/body_plan.h"

namespace spherechain::baker {

// Data that moves the mesh in each frame: bones and weights of morph targets, or the vertices themselves.
class PageMotion {
 public:
  PageMotion(const Character& character, const BodyFrame& axes) : character_(character), axes_(axes) {}

  // Frames in order. `positions` are those of the deformation.
  void add(const Deformation& deformation, const std::vector<Vec3>& positions);

  // The bones of the frame added last before a response corrected them.
  void add_animated(const Deformation& deformation);

  // So far.
  std::size_t bytes() const;

  // Once all frames are there. A morph target that never changes is in the rest positions, and stored nowhere else; or
  // not in them, where the page has the source's.
  enum class Still { kInRest, kInMotion };
  std::vector<Vec3> rest() const;
  nlohmann::ordered_json json(Still still = Still::kInRest) const;

 private:
  bool moves(std::size_t morph) const;

  const Character& character_;
  BodyFrame axes_;
  std::size_t morph_count_ = 0;
  std::vector<float> bones_, animated_, vertices_, morphs_;
  std::vector<float> boxes_, centers_;  // of the character in the axes, their height as the unit
};

}  // namespace spherechain::baker

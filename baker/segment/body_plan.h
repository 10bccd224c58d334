// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mesh/polyline.h"
#include "segment/curve_skeleton.h"

namespace spherechain::baker {

// The character's own axes, orthonormal and right-handed (left x up = forward). Found from its shape alone: they turn,
// move and scale with the mesh, whatever the file's up axis.
struct BodyFrame {
  Vec3 origin;  // in the plane of symmetry, at the height of the lowest vertex
  Vec3 left, up, forward;
  double height;  // extent along `up`: the length every setting is a fraction of
};

enum class Side : std::uint8_t { kNone = 0, kLeft = 1, kRight = 2 };

// The long branches of a curve skeleton, each from the junction it leaves to its tip.
struct BodyPlan {
  struct Limb {
    std::string name;  // its region's
    Side side;         // of the torso; none: in the plane of symmetry (a tail)
    double along;      // where it leaves the torso, from 0, the hip, to 1, the chest
    Polyline line;
  };

  BodyFrame frame;
  std::string facing;  // how forward was decided, for the report
  Polyline spine;      // hip junction to chest junction
  Polyline head;
  std::vector<Limb> limbs;
};

// The frame with another up axis (its part across `left`); origin and height follow.
BodyFrame with_up(BodyFrame frame, const Vec3& up, const Mesh& mesh);

// The regions of a biped, in order: R0 .. R4 of the paper.
inline constexpr std::array<const char*, 5> kRegionNames{"left_arm", "right_arm", "left_leg", "right_leg", "torso"};

// `facing` overrides what the feet say: any vector with a part along the character's forward axis.
// Throws Error(kSegmentation) where there are not five long branches, and says which is missing.
BodyPlan find_body_plan(const Mesh& mesh, const CurveSkeleton& skeleton, const std::optional<Vec3>& facing,
                        const std::string& file);

}  // namespace spherechain::baker

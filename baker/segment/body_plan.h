// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "baker/mesh/attempt.h"
#include "baker/mesh/polyline.h"
#include "baker/segment/curve_skeleton.h"

namespace spherechain::baker {

// The character's own axes, orthonormal and right-handed (left x up = forward). They are found from the body, not from
// the file's axes: they turn, move and scale with the mesh.
struct BodyFrame {
  Vec3 origin;  // in the plane of symmetry, at the height of the lowest vertex
  Vec3 left, up, forward;
  double height;  // a rigged biped's stature, else the extent along `up`, by bones the largest; unit of the settings
};

enum class Side : std::uint8_t { kNone = 0, kLeft = 1, kRight = 2 };

// How a limb ends. kHand: with a hand, foot or head behind its narrowest part. kTip: without one, as a tail does.
enum class LimbEnd : std::uint8_t { kHand, kTip };

// The long branches of a curve skeleton, each from the junction it leaves to its tip.
struct BodyPlan {
  struct Limb {
    std::string name;  // its region's
    Side side;         // of the torso; none: in the plane of symmetry (a tail)
    double along;      // where it leaves the torso, from 0, the hip, to 1, the chest
    Polyline line;
    LimbEnd end = LimbEnd::kHand;
  };

  BodyFrame frame;
  std::string facing;  // how forward was decided, for the report
  Polyline spine;      // hip junction to chest junction
  Polyline head;       // empty where there is none
  std::vector<Limb> limbs;
};

// The normal of the plane of symmetry. That is the principal axis close to `roughly`, which is exact for a symmetric
// body, or `roughly` itself where the pose is so uneven that there is none.
Vec3 lateral_axis(const Mesh& mesh, const Vec3& roughly);

// The frame with another up axis, made orthogonal to `left`. Origin and height follow.
BodyFrame with_up(BodyFrame frame, const Vec3& up, const Mesh& mesh);

// The regions of a biped, in order: R0 .. R4 of the paper.
inline constexpr std::array<const char*, 5> kRegionNames{"left_arm", "right_arm", "left_leg", "right_leg", "torso"};

// The number of ends of the long branches; a biped has five.
std::size_t count_ends(const CurveSkeleton& skeleton);

// True if the long branches are a biped's: two go on from the lower end of the spine, three leave the upper one.
bool looks_like_biped(const CurveSkeleton& skeleton);

// `facing` chooses the sign of `axis`, whose name for people is `name`. Returns a reason where the two are more than 72
// degrees apart, either way round.
std::optional<Reason> check_facing(const std::optional<Vec3>& facing, const Vec3& axis, const char* name);

// The plan of a biped. `facing` overrides what the feet say: any vector with a part along the character's forward axis.
// Without five long branches the reason says which one is missing.
Attempt<BodyPlan> find_biped_plan(const Mesh& mesh, const CurveSkeleton& skeleton, const std::optional<Vec3>& facing);

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "baker/play/bone_joints.h"
#include "baker/play/play.h"
#include "baker/score/scored_skin.h"

namespace spherechain::baker {

// A character as metrics see it: what stays the same in all frames of all its clips.
struct ScoreSubject {
  const AnimatedAsset& animated;
  BoneJoints joints;
  double height, mm;  // the character's in source units; of one of these
  BodyFrame frame;
  ScoredSkin skin;
  std::vector<Vec3> normals;                     // at rest: area-weighted, of joined vertices; unit length, or zero
  std::array<std::vector<std::size_t>, 2> ends;  // bones of hands; of feet
  bool has_limbs;                                // each limb has vertices
};

// `animated` must outlive it.
ScoreSubject score_subject(const AnimatedAsset& animated);

// Unit normals of vertices under linear blend skinning.
std::vector<Vec3> posed_normals(const ScoreSubject& subject, const Deformation& deformation);

}  // namespace spherechain::baker

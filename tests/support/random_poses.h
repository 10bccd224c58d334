// SPDX-License-Identifier: MIT
// Bone matrices of every kind a game may pass.
#pragma once

#include <cstddef>
#include <random>
#include <vector>

#include "tiny_bones.h"

namespace spherechain::test {

enum class PoseKind { kGentle, kRigid, kScaled, kSheared, kMirrored, kAny };
inline constexpr PoseKind kPoseKinds[] = {PoseKind::kGentle,  PoseKind::kRigid,    PoseKind::kScaled,
                                          PoseKind::kSheared, PoseKind::kMirrored, PoseKind::kAny};

// A matrix a bone. kGentle: turned by up to half a radian and shifted by up to a twentieth of `size`; the rest: turned
// at will and shifted by up to `size`, stretched along three axes, sheared besides, mirrored, or any figures at all.
std::vector<Matrix> random_pose(std::size_t bones, PoseKind kind, float size, std::mt19937& random);

// In [-2, 2], every third 0.
std::vector<float> random_morph_weights(std::size_t count, std::mt19937& random);

}  // namespace spherechain::test

// SPDX-License-Identifier: MIT
// Stands for a game's animation: poses the joints of an asset's automatic rig. A game has this, and its own rig,
// already.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "spherechain/asset.h"

namespace spherechain::samples {

// A matrix a bone, rows of 3 by 4, from the rest pose to the pose: what a skinning shader gets.
using Palette = std::vector<std::array<float, 12>>;

// False where the asset's bones are the source's own and not the automatic rig's joints.
bool has_automatic_rig(const Asset& asset);

Palette rest_pose(const Asset& asset);

// asset.joint_count() where there is none of that name.
std::size_t find_joint(const Asset& asset, const char* name);

// Where the joint is in this pose.
Vec3 position_of(const Asset& asset, const Palette& palette, std::size_t joint);

// Turns the joint and all that hangs on it about where it is now, by a rotation vector: its direction the axis, its
// length the angle in radians. Nothing where there is no such joint. From the tips to the root, a pose is built in the
// axes of the rest pose.
void turn(const Asset& asset, Palette& palette, std::size_t joint, const Vec3& rotation);

// The same in degrees about the character's own axes: x to its left, y up, z forward, as in samples/poses.
void turn(const Asset& asset, Palette& palette, const char* joint, const Vec3& degrees);

}  // namespace spherechain::samples

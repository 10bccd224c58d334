// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

#include "baker/motion/motion.h"
#include "baker/play/asset_file.h"
#include "baker/volumes/volume.h"

// A character as rigid bodies, the source of every export.
namespace spherechain::baker {

// A body part that moves rigidly with one bone. Its frame stands where the bone does at rest, turned as the bone is,
// without the bone's scale.
struct ColliderBody {
  std::string name;                                        // of the body part; unique
  std::string bone;                                        // the bone it follows; empty: none moves it
  int bone_index = -1;                                     // into the asset's bones; -1: none
  int parent = -1;                                         // the body it hangs on; comes before it; -1: none
  Eigen::Isometry3d rest = Eigen::Isometry3d::Identity();  // its frame -> the rest pose in metres
  Eigen::AffineCompact3d to_bone =
      Eigen::AffineCompact3d::Identity();  // its frame -> the bone's own space, scale included
  int held_by = -1;  // the body whose volumes stand for it, too: that of a small part; -1: it has its own, or none
  std::vector<Volume> volumes;  // in its frame, metres
  double turn = 0;              // radians that clips turn it in its parent at most, from the rest pose (allow_motion)
  double slide = 0;  // metres that clips move it in its parent at most, besides turning it (allow_motion); 0: it stays
};

// Why two bodies need not be tested against each other.
enum class IgnoredReason : std::uint8_t { kAdjacent, kRest, kAlways, kNever };

struct IgnoredBodies {
  int a, b;  // a < b
  IgnoredReason reason;
};

struct Colliders {
  std::string source_file;     // the character's file, without its folder
  double metres_per_unit = 1;  // of its file
  double height = 0;           // metres
  Vec3 left, up, forward;      // the character's own axes in the rest pose; orthonormal, left x up = forward
  std::vector<ColliderBody> bodies;
  std::vector<IgnoredBodies> ignored;  // sorted by (a, b), each once
};

// From the rest pose's axes to a world with up = +Z, forward = +X, left = +Y (URDF, MJCF).
Eigen::Quaterniond to_z_up(const Colliders& colliders);

// A body's frame relative to that of its parent at rest; of a body without a parent its `rest`.
Eigen::Isometry3d rest_in_parent(const Colliders& colliders, std::size_t body);

// The rotation and the place of a transform; its scale and shear left out.
Eigen::Isometry3d rigid_part(const Affine& of);

// Where each body stands in a pose (bones: rest -> posed, in source units): its frame -> the pose's space in metres.
// The bones' scale and shear are left out.
std::vector<Eigen::Isometry3d> posed(const Colliders& colliders, const std::vector<Affine>& bones);

// Pairs of bodies, a < b, of which some volumes overlap where they stand; ignored ones left out.
std::vector<std::pair<int, int>> overlapping(const Colliders& colliders, const std::vector<Eigen::Isometry3d>& at);

}  // namespace spherechain::baker

// SPDX-License-Identifier: MIT
// How a body goes from one pose to the next: where its bones are at any time, and how far its vertices stray from
// straight lines.
#pragma once

#include <cstddef>
#include <cstdint>

#include "runtime/src/base/double3.h"
#include "runtime/src/pose/transform.h"
#include "runtime/src/skin/skin_table.h"
#include "runtime/src/step/step_job.h"

namespace spherechain {

constexpr std::size_t kJointsMax = 65536;  // so that no size of memory overflows

// Upper bounds for a joint during the step: the norm of its matrix' linear part, of that part's first two derivatives
// by time, and of those of its origin.
struct Speeds {
  double size, turn, turn_change, velocity, acceleration;
};

// The skeleton at one time, as far as it was asked for.
struct Skeleton {
  double time = -1;
  Affine* joints = nullptr;
  float* bones = nullptr;  // three rows of four, as the asset has them
  std::uint8_t *has_joint = nullptr, *has_bone = nullptr;
};

// Times are dyadic. Rotations are halved again and again, which takes no function but the root: their bits are the same
// on every machine.
class BodyMotion {
 public:
  void take(WordMemory& memory, const AssetView& asset, std::size_t joint_count);
  // Starts at a motion that was checked.
  void start(const Motion& motion, const AssetView& asset, const Surface& surface);

  // How far a vertex of the sphere is at most, during the whole step, from where it would be if it went straight from
  // the start to the end; infinite where that is not known. During a share h of the step, h * h of that.
  Span<const float> strays() const { return {strays_, asset_->spheres().size}; }

  // Between the ends of the step it writes what the motion has: `vertices`, or `bones` and `morph_weights`.
  Pose pose_at(double time, float* bones, float* morph_weights, float* vertices);
  // Where the corners of a triangle are at a time between the ends.
  void corners_at(double time, std::size_t cluster, std::size_t triangle, Double3* corners);

 private:
  bool has_joints() const { return motion_->blend != SC_BLEND_LINEAR; }
  bool has_vertices() const { return motion_->body.pose.vertices != nullptr; }
  Double3 vertex_at_time(double time, std::size_t vertex) const;  // of the source
  Skeleton& skeleton_at(double time);
  const Affine& joint_at(Skeleton& skeleton, std::size_t joint);
  const float* bone_at(Skeleton& skeleton, std::size_t bone);
  float morph_weight_at(double time, std::size_t morph) const;
  Affine local_at(double time, std::size_t joint) const;
  void find_speeds();
  double stray_of_bone(std::size_t bone) const;

  const Motion* motion_ = nullptr;
  const AssetView* asset_ = nullptr;
  const Surface* surface_ = nullptr;
  float* strays_ = nullptr;        // a sphere's
  double* bone_strays_ = nullptr;  // a bone's
  Speeds* speeds_ = nullptr;       // a joint's
  std::uint32_t* chain_ = nullptr;
  static constexpr std::size_t kSkeletons = 16;
  Skeleton skeletons_[kSkeletons];
  std::size_t oldest_ = 0;
};

// Are start and end what the motion says they are, and was the table made of the asset?
Status check_motion(const Motion& motion, Surface& surface);

}  // namespace spherechain

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "moving_human.h"
#include "runtime/src/triangles/exact_triangles.h"

namespace spherechain::test {

// moving_human()'s rig between two poses. Eigen does here what a step job does with its joints.
class MovingJoints {
 public:
  enum class Order { kFlat, kDownTheSkeleton };

  // Between two palettes of matrices; `end_scale` is added along the joints' own axes.
  MovingJoints(const std::vector<float>& from, const std::vector<float>& to, Order order, double end_scale = 1);

  Motion motion(Blend blend) const;
  std::vector<float> palette_at(double time, Blend blend) const;

 private:
  std::vector<Transform> start_, end_;
  std::vector<std::uint32_t> parents_;        // empty: all stand in the pose's space
  std::vector<std::uint32_t> joint_of_bone_;  // the other way round where flat
};

Eigen::Affine3d matrix_of(const float* rows);
// The matrices of all bones as at rest.
std::vector<float> rest_palette();
// The number of that bone, and the body part that follows it.
std::size_t bone_named(const std::string& name);
std::uint32_t part_of_bone(const std::string& name);

// Triangle `source_triangle` in a pose of bones.
struct PosedTriangles {
  explicit PosedTriangles(const std::vector<float>& palette);
  TriangleCorners operator[](std::uint32_t source_triangle) const;
  std::vector<float> vertices;
};
// The error that a step may have, by default.
double step_tolerance();
// 0 where they cross.
double distance_between(const TriangleCorners& a, const TriangleCorners& b);

}  // namespace spherechain::test

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <variant>

#include "baker/mesh/mesh.h"

// The convex solids that physics engines have. Lengths in metres, in the space of the body that holds them.
namespace spherechain::baker {

struct BallVolume {
  Vec3 center;
  double radius;
};

// The convex hull of two balls: a tapered capsule; with equal radii a capsule. Where one ball holds the other it is
// that ball alone.
struct ConeVolume {
  Vec3 a, b;
  double radius_a, radius_b;
};

// Its axes are the columns of `rotation`.
struct EllipsoidVolume {
  Vec3 center;
  Eigen::Quaterniond rotation;
  Vec3 radii;
};

struct BoxVolume {
  Vec3 center;
  Eigen::Quaterniond rotation;
  Vec3 half;
};

using Volume = std::variant<BallVolume, ConeVolume, EllipsoidVolume, BoxVolume>;

// The name in capsules.json and in texts: "sphere", "capsule" (a cone of equal radii), "cone", "ellipsoid", "box".
const char* volume_name(const Volume& volume);

// The distance from the surface to the point, negative inside. For an ellipsoid it is an approximation, exact on its
// surface.
double signed_distance(const Volume& volume, const Vec3& point);

// The farthest point along a direction, which has any length but 0.
Vec3 support(const Volume& volume, const Vec3& direction);

double volume_of(const Volume& volume);  // cubic metres

// The volume after a motion, and after a similarity: radii grow by its scale (the cube root of its determinant).
Volume moved(const Volume& volume, const Eigen::AffineCompact3d& by);

// Its surface farther out by so many metres, or farther in; no radius is below a tenth of a millimetre.
Volume padded(const Volume& volume, double by);

// True if two volumes, each moved rigidly into one space, share a point. Exact to about 1e-9 m.
bool overlap(const Volume& a, const Eigen::Isometry3d& a_to_world, const Volume& b,
             const Eigen::Isometry3d& b_to_world);

}  // namespace spherechain::baker

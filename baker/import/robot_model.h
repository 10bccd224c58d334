// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "baker/import/import.h"
#include "baker/import/robot_rig.h"

namespace spherechain::baker {

// A box has half its sizes, a cylinder and a capsule radius and half the length (of a capsule between the centres of
// its caps), both along z; an ellipsoid its three radii, a sphere the same three times.
enum class ShapeKind { kMesh, kBox, kCylinder, kCapsule, kEllipsoid };

struct RobotShape {
  ShapeKind kind = ShapeKind::kMesh;
  Affine place = Affine::Identity();  // in its link
  Vec3 size = Vec3::Ones();           // of a mesh its scale
  std::filesystem::path file;         // of a mesh in a file
  Mesh mesh;                          // of a mesh in the description
  bool is_visual = false, is_collider = false;
  bool is_hull = false;  // the collider is the convex hull of the mesh
  std::optional<std::array<float, 3>> colour;
};

struct RobotLink {
  std::string name;
  int parent = -1;                   // comes before its children
  Affine base = Affine::Identity();  // in its parent, where all its joints are at rest
  std::vector<RobotShape> shapes;
};

// A robot as its file describes it. A joint's node is the number of its link.
struct RobotModel {
  std::string name;
  std::vector<RobotLink> links;
  std::vector<RigJoint> joints;
  std::vector<std::array<Index, 2>> excluded;   // links that the file says are not tested against each other
  std::vector<std::filesystem::path> included;  // further files of the description
};

// Both throw Error(kFile).
RobotModel read_urdf(const std::filesystem::path& path);
RobotModel read_mjcf(const std::filesystem::path& path);

// Triangles of a primitive, in its own space.
Mesh triangles_of(const RobotShape& shape);

// True for URDF and MJCF files, by their outermost element.
bool is_robot(const std::filesystem::path& path);
// For commands that write a glTF of the character that they read. Throws Error(kFile) where it is a robot.
void refuse_robot(const std::filesystem::path& path);
// For a child process (read_in_child.h). Links that fixed joints connect become one bone, which has the name of the
// first of them with a mesh.
SourceMesh read_robot(const std::filesystem::path& path, const ImportOptions& options);
// The meshes that a robot's file names, and files that it includes.
std::vector<std::string> files_of_robot(const std::filesystem::path& path);

}  // namespace spherechain::baker

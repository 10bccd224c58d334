// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/import/import.h"
#include "glb_writer.h"

// Reads the file with the reader under test.
spherechain::baker::SourceMesh read(const Glb& glb);

// Where a file's vertices are in the world while its nodes stand as it says, straight from the specification's section
// on skins, in the order of the nodes and their primitives: a reference with nothing of the reader in it. For files
// whose accessors are plain (floats, 16-bit joints, nothing normalized or sparse).
std::vector<Eigen::Vector3d> world_positions(const Glb& glb);

// The same from what the reader made of a file, with its nodes where `world` has them.
std::vector<Eigen::Vector3d> world_positions(const spherechain::baker::SourceMesh& mesh,
                                             const std::vector<spherechain::baker::Affine>& world);

// A column of two boxes, 8 vertices each, on two joints above one another (nodes 1 and 2), bound where the joints are
// not at rest; node 0 has the mesh, node 3 is the joints' parent.
Glb two_boxes();

// The corners and triangles of a box from -1 to 1, turned outwards.
std::vector<float> box_corners(float x, float y, float z);
std::vector<std::uint16_t> box_triangles();

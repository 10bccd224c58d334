// SPDX-License-Identifier: GPL-3.0-or-later
// A character of two parts that meet as a clip or a recording says, for `spherechain fix`.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "glb_writer.h"
#include "two_shapes.h"

// Adds a mesh, moved; returns its number.
int mesh_of(Glb& glb, const Shape& shape, double x, double y);

// A wall, and on it an arm that is stretched out at rest. In the clip "swing" it hangs down beside the wall, and would
// be as far from it as the margin if it hung straight; in each frame it is turned so many degrees towards the wall.
// Each further clip has the same name, and turns it by one degree more.
std::string wall_and_arm(const std::vector<double>& degrees, int clips = 1);

// The same motion as a BVH recording of the same joints, 30 frames a second. As a hinge the arm turns about
// one axis alone.
std::string recording_of_arm(const std::vector<double>& degrees, bool is_hinge = false);

// The JSON in a GLB.
nlohmann::json json_of(const std::string& glb);

// SPDX-License-Identifier: GPL-3.0-or-later
// Closed meshes to segment: simple ones, and the human with parts cut off and the holes closed.
#pragma once

#include "baker/pipeline/pipeline.h"

spherechain::baker::SourceMesh ball_mesh(int rings);
// A straight tube of radius 1 with round ends.
spherechain::baker::SourceMesh tube_mesh(double length, int rings);
// The body without one or two of its regions, each hole closed by a fan.
spherechain::baker::SourceMesh without_region(const spherechain::baker::Bake& bake, std::uint8_t region,
                                              std::uint8_t other = 255);

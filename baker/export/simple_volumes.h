// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/volumes/volume.h"

// Volumes for formats that have few kinds of them.
namespace spherechain::baker {

// Replacements for one volume, and the largest distance between the surfaces in metres. 0: the same solid.
struct SimpleVolumes {
  std::vector<Volume> volumes;
  double off = 0;
};

// How far apart the surfaces of two convex solids are at most: their supports differ by that much in some direction.
double surface_distance(const Volume& a, const Volume& b);

// The volume; of a cone whose one ball holds the other, that ball.
Volume without_inner_ball(const Volume& volume);

// A ball, or a cone of equal radii. A cone keeps its ends, an ellipsoid and a box their longest axis; all keep their
// volume where they can.
SimpleVolumes as_capsule(const Volume& volume);

// Balls inside a ball or a cone, no farther from each other than their radius. Any other volume gets the balls of its
// capsule.
SimpleVolumes as_balls(const Volume& volume);

// The same, but an ellipsoid alone becomes a capsule.
SimpleVolumes without_ellipsoid(const Volume& volume);

}  // namespace spherechain::baker

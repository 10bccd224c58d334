// SPDX-License-Identifier: GPL-3.0-or-later
// Depth by trying very many directions: slow, and with no code of the runtime's own measure.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "baker/mesh/mesh.h"

namespace spherechain::quality {

using baker::Vec3;

struct Corners {
  Vec3 p[3];
};

// Two body parts in a pose.
struct Parts {
  std::vector<Corners> a, b;
  std::function<bool(std::size_t, std::size_t)> counts;  // a pair of triangles that may touch is left out
};

struct Exit {
  double depth;
  Vec3 direction;
};

// The shortest way of b out of a of `directions` evenly spread ones and of those near the best of them. Free places
// shorter than `gap` are none, and so are those where one is inside the other.
Exit shortest_way(const Parts& parts, int directions, double gap);

}  // namespace spherechain::quality

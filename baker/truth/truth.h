// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "baker/truth/intersections.h"
#include "spherechain/types.h"

namespace spherechain::baker {

// A pair of spheres and the true triangle pairs between their triangles.
struct TrueContact {
  Pair spheres;
  std::vector<Pair> triangles;
};

// Intersections of a frame. Out of scope are, in this order and each pair once: those that intersect in the rest pose
// too, those within one sphere's region, and those of spheres whose pair the asset ignores.
struct FrameTruth {
  std::size_t raw_pairs = 0;
  std::size_t rest = 0, same_sphere = 0, ignored = 0;
  std::size_t degenerate = 0;         // triangles without area in this pose
  std::vector<Pair> pairs;            // the rest: the true pairs, sorted
  std::vector<Pair> neighbours;       // those of one sphere and of ignored ones, sorted
  std::vector<TrueContact> contacts;  // the true pairs by spheres, sorted
  std::vector<Pair> far;              // of the true pairs and the neighbours those between parts that are far; sorted
};

// `rest_pairs`: those of the rest pose, sorted. `is_ignored` is asked about two owners of the surface's triangles,
// `is_far` about two source triangles.
FrameTruth frame_truth(const Intersections& found, const std::vector<Pair>& rest_pairs, const TruthSurface& surface,
                       const std::function<bool(std::uint32_t, std::uint32_t)>& is_ignored,
                       const std::function<bool(const Pair&)>& is_far);

}  // namespace spherechain::baker

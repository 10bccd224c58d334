// SPDX-License-Identifier: GPL-3.0-or-later
// Trees over the chains against M1, M2 and the product, over the number of spheres.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "experiments.h"
#include "table.h"

namespace spherechain::paper {

// The trees' times include their refit. M1 and M2 are plain loops that leave ignored pairs out, as in Figure 15. The
// job is the product's, with its table and the best instruction set.
inline constexpr const char *kBinaryTree = "binary tree", *kQuadtree = "quadtree", *kOctree = "octree", *kLoopM1 = "M1",
                            *kLoopM2 = "M2", *kJob = "all_pairs";
inline constexpr std::array<const char*, 3> kTrees{kBinaryTree, kQuadtree, kOctree};

// Chains as the bake makes them, of both profiles as they are and of other settings; and the spheres of profile `paper`
// in parts, as in Figure 16.
inline constexpr const char *kBaked = "baked", *kSplit = "in parts";
inline constexpr const char *kPaperAsIs = "paper", *kBalancedAsIs = "balanced";  // sources

// trees.csv: a row a source of spheres and method; medians over frames of both animations. `repetitions` are of
// the fewest spheres; more spheres have fewer. Throws Error(kInternal) where a tree or the product finds other pairs
// than M2 in a frame; nothing is timed before all are compared.
Table measure_trees(const Study& study, const std::vector<Setting>& baked, const std::vector<std::uint32_t>& parts,
                    int repetitions);

}  // namespace spherechain::paper

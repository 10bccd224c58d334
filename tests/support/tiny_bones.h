// SPDX-License-Identifier: MIT
// A skeleton, bone weights and morph targets for a synthetic asset.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "tiny_asset.h"

namespace spherechain::test {

using Matrix = std::array<float, 12>;  // rows of 3 by 4

struct TinySkin {
  std::vector<std::vector<std::pair<std::uint32_t, double>>> weights;               // of each vertex: bone, weight
  std::vector<std::vector<std::pair<std::uint32_t, std::array<float, 3>>>> morphs;  // of each vertex: target, delta
};

// Gives sphere `i` that many pivots, weights that add up to 1, from triangles of the whole asset.
void give_pivots(TinyAsset& tiny, std::size_t i, std::uint16_t count, unsigned seed);

// Adds `bone_count` bones, the last of them the rest bone, three morph targets, one of which moves nothing, and, where
// that is the refit rule, moments. Vertices hang on up to three bones. Give pivots before.
TinySkin add_bones(TinyAsset& tiny, std::size_t bone_count, unsigned seed);

// Makes the tables of refit by moments, with batches filled up to that many pairs. No sphere may hang on more than
// kMaxMomentBones. Sets the pivot spreads.
void add_moments(TinyAsset& tiny, const TinySkin& skin, std::size_t batch_pairs = 48);

// Turns, stretches and shifts, one a bone.
std::vector<Matrix> random_matrices(std::size_t count, unsigned seed);

// Where a vertex goes, in double precision. `morph_weights` may be empty.
std::array<double, 3> moved(const TinyAsset& tiny, const TinySkin& skin, std::size_t vertex,
                            const std::vector<Matrix>& matrices, const std::vector<float>& morph_weights);

// The deformed vertices, worked out so and rounded.
std::vector<float> skinned(const TinyAsset& tiny, const TinySkin& skin, const std::vector<Matrix>& matrices,
                           const std::vector<float>& morph_weights);

}  // namespace spherechain::test

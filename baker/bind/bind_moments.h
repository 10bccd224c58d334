// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "baker/bind/bind_bones.h"

namespace spherechain::baker {

inline constexpr std::size_t kMaxMomentBones = 22;  // of a sphere: its pairs are numbered in a byte

// Contributions of bones to a sphere's centre and mean squared distance (schemas/sphere_chains.fbs, Moments).
struct SphereMoments {
  std::uint32_t sphere;
  std::vector<Index> bones;              // ascending; 1 to kMaxMomentBones
  std::vector<Eigen::Vector4d> centers;  // of each bone
  std::vector<Eigen::Matrix4d> moments;  // of each pair (b0, b0), (b0, b1) ..., (b1, b1) ...
  std::vector<std::uint8_t> places;      // of each pair: in MomentBatch::pairs; make_batches() fills it in
};

using BonePair = std::pair<Index, Index>;  // first <= second

struct MomentBatch {
  std::vector<BonePair> pairs;  // sorted, each once
  std::vector<SphereMoments> spheres;
};

// Spheres that need the same pairs of bones share a batch, because a batch's pairs are computed once. Within it,
// spheres with equal bones are side by side. A batch has up to 96 pairs (all of a human's), or one set of bones that
// has more.
std::vector<MomentBatch> make_batches(const std::vector<SphereMoments>& spheres);

// Data for the runtime's refit from bones, which does not need the pivots.
struct MomentBinding {
  Vec3 origin = Vec3::Zero();
  Index reference = 0;
  std::vector<MomentBatch> batches;
};

// No batches under the paper's rule, and where nothing moves the source. Morph targets move no sphere. `bones` and
// `rig_weights` are bind_bones()'. Throws Error(kFile) where there are more bones than the asset can number.
MomentBinding bind_moments(const Character& character, const BoneBinding& bones,
                           const std::vector<VertexWeights>& rig_weights, const Binding& binding);

}  // namespace spherechain::baker

// SPDX-License-Identifier: MIT
#include "skin/skin_inputs.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "simd/arithmetic.h"

namespace spherechain {
namespace {

BoneSize bone_size(const BoneMatrices& bones, std::size_t bone) {
  const float* m = bones.data + bone * bones.stride;
  float gram[3][3];
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = i; j < 3; ++j) {
      const float* p = m + i * bones.column;
      const float* q = m + j * bones.column;
      gram[i][j] = gram[j][i] =
          std::abs((p[0] * q[0] + p[bones.row] * q[bones.row]) + p[2 * bones.row] * q[2 * bones.row]);
    }
  }
  float most = 0, all = 0;
  for (const auto& row : gram) {
    const float sum = (row[0] + row[1]) + row[2];
    most = std::max(most, sum);
    all += sum;
  }
  if (std::isnan(all)) {  // products overflowed, with either sign: the maximum lost it
    most = std::numeric_limits<float>::infinity();
  }
  const float* t = m + 3 * bones.column;
  return {std::sqrt(most), std::max({std::abs(t[0]), std::abs(t[bones.row]), std::abs(t[2 * bones.row])})};
}

}  // namespace

SkinInputs skin_inputs(const Surface& surface, const Pose& pose) {
  const BoneMatrices bones = matrices_of(pose);
  SkinInputs in{};
  in.slot_positions = surface.slot_positions.data;
  in.slot_weights = surface.slot_weights.data;
  in.slot_morphs = surface.slot_morphs.data;
  in.cluster_bones = surface.cluster_bones.data;
  in.matrices = bones.data;
  in.stride = bones.stride;
  in.row = bones.row;
  in.column = bones.column;
  in.morph_weights = pose.morph_weights;
  return in;
}

BoundsInputs bounds_inputs(const AssetView& asset, const Surface& surface, const Pose& pose, BoneSize* sizes) {
  const BoneMatrices bones = matrices_of(pose);
  BoundsInputs in{};
  in.cluster_count = surface.clusters.size;
  in.boxes = surface.boxes.data;
  in.term_counts = surface.bounds_term_counts.data;
  in.term_bones = surface.bounds_term_bones.data;
  in.terms = surface.bounds_terms.data;
  if (pose.morph_weights != nullptr && surface.bounds_morph_counts.size > 0) {
    in.morph_counts = surface.bounds_morph_counts.data;
  }
  in.morph_targets = surface.bounds_morph_targets.data;
  in.morphs = surface.bounds_morphs.data;
  in.matrices = bones.data;
  in.stride = bones.stride;
  in.row = bones.row;
  in.column = bones.column;
  in.morph_weights = pose.morph_weights;
  in.sizes = sizes;
  for (std::size_t bone = 0; bone < asset.bone_count(); ++bone) {
    sizes[bone] = bone_size(bones, bone);
  }
  return in;
}

}  // namespace spherechain

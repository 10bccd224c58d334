// SPDX-License-Identifier: MIT
#include "spherechain/skin.h"

#include "bone_refit.h"
#include "memory.h"
#include "simd.h"
#include "skin.h"
#include "skin_surface.h"
#include "stride.h"

namespace spherechain {

SkinInputs skin_inputs(const Asset& asset, const BoneMatrices& bones, Span<const float> morph_weights) {
  const Surface& surface = asset.surface();
  SkinInputs in{};
  in.slot_positions = surface.slot_positions.data;
  in.slot_weights = surface.slot_weights.data;
  in.slot_morphs = surface.slot_morphs.data;
  in.leaf_bones = surface.leaf_bones.data;
  in.matrices = bones.data;
  in.stride = bones.stride / sizeof(float);
  in.row = row_step(bones.layout);
  in.column = column_step(bones.layout);
  in.morph_weights = morph_weights.size > 0 ? morph_weights.data : nullptr;
  return in;
}

Status SkinJob::run() const noexcept {
  const Status status = check_bone_inputs(asset, bones, morph_weights, RadiusKind::kFit);
  if (status != Status::kOk) {
    return status;
  }
  if (asset->leaf_count() == 0) {
    return Status::kNotInAsset;
  }
  if (positions == nullptr) {
    return Status::kNullArgument;
  }
  if (any_misaligned(positions)) {
    return Status::kMisaligned;
  }
  if (!is_valid_stride(stride)) {
    return Status::kBadStride;
  }
  const std::size_t count = asset->info().source_vertex_count;
  if (vertex_count < count) {
    return Status::kTooFewVertices;
  }
  Target resolved{};
  if (!resolve_target(target, resolved)) {
    return Status::kUnsupportedTarget;
  }
  const auto out = reinterpret_cast<std::uintptr_t>(positions);
  if (any_shared({MemoryRange{out, out + (count - 1) * stride + 3 * sizeof(float)}},
                 {range_of_matrices(bones, asset->bone_count()), range_of(morph_weights)})) {
    return Status::kSharedMemory;
  }
  const Surface& surface = asset->surface();
  skin_surface(skin_inputs(*asset, bones, morph_weights),
               {surface.leaves.data, surface.leaves.size, surface.leaf_vertices.data, surface.source_vertices.data},
               resolved, positions, stride / sizeof(float));
  return Status::kOk;
}

}  // namespace spherechain

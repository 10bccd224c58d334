// SPDX-License-Identifier: MIT
#include "spherechain/refit_bones.h"

#include "bone_refit.h"
#include "memory.h"
#include "simd.h"

namespace spherechain {

Status check_bone_inputs(const Asset* asset, const BoneMatrices& bones, Span<const float> morph_weights,
                         RadiusKind radius) {
  if (asset == nullptr || bones.data == nullptr || is_missing(morph_weights)) {
    return Status::kNullArgument;
  }
  if (!asset->is_open()) {
    return Status::kNotOpen;
  }
  if (any_misaligned(bones.data, morph_weights.data)) {
    return Status::kMisaligned;
  }
  if ((radius != RadiusKind::kFit && radius != RadiusKind::kDetect) || size_of(bones.layout) == 0) {
    return Status::kBadArgument;
  }
  if (bones.stride < size_of(bones.layout) || bones.stride % sizeof(float) != 0) {
    return Status::kBadStride;
  }
  if (asset->bone_count() == 0) {
    return Status::kNotInAsset;
  }
  if (bones.count < asset->bone_count()) {
    return Status::kTooFewBones;
  }
  if (morph_weights.size > 0 && morph_weights.size < asset->morph_count()) {
    return Status::kTooFewMorphs;
  }
  return Status::kOk;
}

namespace {

MomentInputs moment_inputs(const MomentTables& tables) {
  MomentInputs in{};
  in.origin = tables.origin;
  in.reference = tables.reference;
  in.own_are_upper = tables.own_are_upper;
  in.batch_count = tables.batches.size;
  in.batches = tables.batches.data;
  in.pairs = tables.pairs.data;
  in.spheres = tables.spheres.data;
  in.bone_counts = tables.bone_counts.data;
  in.bones = tables.bones.data;
  in.centers = tables.centers.data;
  in.pair_places = tables.pair_places.data;
  in.moments = tables.moments.data;
  return in;
}

}  // namespace

BoneRefitInputs bone_refit_inputs(const Asset& asset, const BoneMatrices& bones, Span<const float> morph_weights,
                                  RadiusKind radius) {
  const BoneTables& tables = asset.bone_tables();
  BoneRefitInputs in{};
  in.rest = asset.spheres().data;
  in.sphere_count = asset.spheres().size;
  in.group_count = tables.term_counts.size;
  in.bone_count = asset.bone_count();
  in.weights = tables.weights.data;
  in.term_counts = tables.term_counts.data;
  in.term_bones = tables.term_bones.data;
  in.terms = tables.terms.data;
  in.morph_term_counts = tables.morph_term_counts.data;
  in.morph_targets = tables.morph_targets.data;
  in.morph_terms = tables.morph_terms.data;
  in.rule = asset.refit_rule();
  if (in.rule == RefitRule::kMoments) {
    in.moments = moment_inputs(asset.moment_tables());
  }
  in.matrices = bones.data;
  in.stride = bones.stride / sizeof(float);
  in.layout = bones.layout;
  in.morph_weights = morph_weights.size > 0 && tables.morph_terms.size > 0 ? morph_weights.data : nullptr;
  in.radius = radius;
  return in;
}

MemoryRange range_of_matrices(const BoneMatrices& bones, std::size_t count) {
  const auto first = reinterpret_cast<std::uintptr_t>(bones.data);
  return {first, first + (count - 1) * bones.stride + size_of(bones.layout)};
}

void refit_from_bones(const BoneRefitInputs& inputs, Target resolved, Sphere* spheres) {
  if (inputs.rule == RefitRule::kMoments) {
    refit_from_moments(inputs, resolved, spheres);
  } else {
    refit_from_pivots(inputs, resolved, spheres);
  }
}

Status RefitBonesJob::run() const noexcept {
  const Status status = check_bone_inputs(asset, bones, morph_weights, radius);
  if (status != Status::kOk) {
    return status;
  }
  fetch(range_of_matrices(bones, asset->bone_count()));
  if (spheres.data == nullptr) {
    return Status::kNullArgument;
  }
  if (any_misaligned(spheres.data)) {
    return Status::kMisaligned;
  }
  const std::size_t count = asset->spheres().size;
  if (spheres.size < count) {
    return Status::kTooFewSpheres;
  }
  Target resolved{};
  if (!resolve_target(target, resolved)) {
    return Status::kUnsupportedTarget;
  }
  if (any_shared({range_of(Span<Sphere>{spheres.data, count})},
                 {range_of_matrices(bones, asset->bone_count()), range_of(morph_weights)})) {
    return Status::kSharedMemory;
  }
  refit_from_bones(bone_refit_inputs(*asset, bones, morph_weights, radius), resolved, spheres.data);
  return Status::kOk;
}

}  // namespace spherechain

// SPDX-License-Identifier: MIT
// What jobs from bones' matrices and morph weights have in common.
#pragma once

#include "fuzz_case.h"

namespace spherechain::test {

template <typename Job>
void draw_bone_inputs(Case& c, Job& job) {
  job.asset = &c.asset;
  job.bones = draw_bones(c);
  job.target = draw_target(c);
  if (c.random.one_in(2)) {
    job.morph_weights.size = c.asset.morph_count() + c.random.below(2);
    float* weights = c.arena.add<float>(job.morph_weights.size);
    fill_figures(c, weights, job.morph_weights.size);
    job.morph_weights.data = weights;
  }
}

// What the C API's job is given before the call is spoiled, and after.
template <typename Job, typename CJob>
void choose_bone_inputs(Case& c, const Job& job, CJob& c_job) {
  c_job.asset = c.c_asset;
  c_job.bones.layout = static_cast<sc_matrix_layout>(job.bones.layout);
  c_job.target = static_cast<sc_target>(draw_target(c));
}

template <typename Job, typename CJob>
void copy_bone_inputs(const Job& job, CJob& c_job) {
  c_job.bones.data = job.bones.data;
  c_job.bones.count = job.bones.count;
  c_job.bones.stride = job.bones.stride;
  c_job.morph_weights = job.morph_weights.data;
  c_job.morph_weight_count = job.morph_weights.size;
}

constexpr std::uint32_t kBoneWays = 10;
template <typename Job, typename CJob>
void spoil_bone_inputs(Case& c, Job& job, CJob& c_job, std::uint32_t way, Spoiled& spoiled) {
  switch (way) {
    case 0:
    case 1:
      return spoil_asset(c, job, c_job, way, spoiled);
    case 2:
      job.bones.data = nullptr;
      return spoiled.with(Status::kNullArgument);
    case 3:
      job.bones.count = c.random.up_to(c.asset.bone_count() - 1);
      return spoiled.with(Status::kTooFewBones);
    case 4: {
      const std::size_t strides[] = {
          0, 44, size_of(job.bones.layout) - 4, size_of(job.bones.layout) + 2, 999, ~std::size_t{0}};
      job.bones.stride = c.random.pick(strides);
      return spoiled.with(Status::kBadStride);
    }
    case 5:
      job.bones.layout = draw_none<MatrixLayout>(c, 4);
      c_job.bones.layout = draw_c_none(c, 4);
      return spoiled.with(Status::kBadArgument);
    case 6:
      job.target = draw_none<Target>(c, 7);
      c_job.target = draw_c_none(c, 7);
      return spoiled.with(Status::kUnsupportedTarget);
    case 7:
      put_askew(c, job.bones.data);
      return spoiled.with(Status::kMisaligned);
    case 8:
      job.morph_weights = {nullptr, c.asset.morph_count() + 1};
      return spoiled.with(Status::kNullArgument);
    default:
      if (c.asset.morph_count() > 1) {
        job.morph_weights = {c.arena.add<float>(3), c.asset.morph_count() - 1};
        spoiled.with(Status::kTooFewMorphs);
      }
  }
}

}  // namespace spherechain::test

// SPDX-License-Identifier: MIT
// A skin in a pose, as jobs on its triangles are given it.
#pragma once

#include <cstddef>

#include "contact_scene.h"
#include "memory.h"
#include "spherechain/asset.h"
#include "spherechain/filter.h"
#include "spherechain/refit_bones.h"
#include "spherechain/triangle_contacts.h"

namespace spherechain {

// The vertices, or the bones, or both: then leaves are bounded by the bones.
struct ContactPose {
  const Asset* asset;  // open, with a surface
  const float* positions;
  std::size_t vertex_count, stride;
  BoneMatrices bones;
  Span<const float> morph_weights;
};

template <typename Job>
ContactPose pose_of(const Job& job) {
  return {job.asset, job.positions, job.vertex_count, job.stride, job.bones, job.morph_weights};
}

// kOk where the fields of the pose are what its job asks for.
Status check_pose(const ContactPose& pose);

// What is read, of a pose that is checked.
struct PoseRanges {
  MemoryRange positions, matrices, morph_weights;
};
PoseRanges ranges_of(const ContactPose& pose);

// Of a checked pose, with enough words: nothing is ignored or disabled, no leaf is bounded yet.
ContactScene scene_of(const ContactPose& pose, Span<std::uint64_t> words);

// The same for all pairs of spheres but those ignored or disabled, by the asset or by a checked filter.
ContactScene scene_of_all(const ContactPose& pose, const Filter* filter, Span<std::uint64_t> words);

}  // namespace spherechain

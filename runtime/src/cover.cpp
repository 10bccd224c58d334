// SPDX-License-Identifier: MIT
#include "spherechain/cover.h"

#include <algorithm>
#include <cmath>

#include "arithmetic.h"
#include "bone_refit.h"
#include "cover_kernel.h"
#include "memory.h"
#include "simd.h"
#include "skin.h"

namespace spherechain {
namespace {

constexpr std::size_t kSizesKept = 512;  // bones whose sizes are worked out once: 4 KiB of stack

// Around the leaves [first, last) of one sphere: about the middle of their box. Its few roundings are each a unit in
// the last place of what they are of: eight of those are added, and what a root loses whose squares are too small.
Sphere cover_of(const Sphere* first, const Sphere* last) {
  float low[3] = {first->x - first->radius, first->y - first->radius, first->z - first->radius};
  float high[3] = {first->x + first->radius, first->y + first->radius, first->z + first->radius};
  for (const Sphere* leaf = first + 1; leaf != last; ++leaf) {
    const float center[3] = {leaf->x, leaf->y, leaf->z};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], center[axis] - leaf->radius);
      high[axis] = std::max(high[axis], center[axis] + leaf->radius);
    }
  }
  Sphere cover{0.5F * (low[0] + high[0]), 0.5F * (low[1] + high[1]), 0.5F * (low[2] + high[2]), 0};
  for (const Sphere* leaf = first; leaf != last; ++leaf) {
    const float dx = leaf->x - cover.x;
    const float dy = leaf->y - cover.y;
    const float dz = leaf->z - cover.z;
    cover.radius = std::max(cover.radius, std::sqrt((dx * dx + dy * dy) + dz * dz) + leaf->radius);
  }
  cover.radius = cover.radius * (1.0F + 8.0F / 16777216.0F) + 0x1p-60F;
  return cover;
}

void cover_spheres(const Asset& asset, const Sphere* leaves, Sphere* spheres) {
  const Surface& surface = asset.surface();
  std::size_t leaf = 0;
  for (std::size_t s = 0; s < asset.spheres().size; ++s) {
    const std::size_t first = leaf;
    while (leaf < surface.leaves.size && surface.leaves[leaf].sphere == s) {
      ++leaf;
    }
    const Vec3& center = asset.spheres()[s].center;
    spheres[s] = leaf > first ? cover_of(leaves + first, leaves + leaf) : Sphere{center.x, center.y, center.z, 0};
  }
}

}  // namespace

CoverInputs cover_inputs(const Asset& asset, const BoneMatrices& bones, Span<const float> morph_weights,
                         Span<BoneSize> sizes) {
  const Surface& surface = asset.surface();
  CoverInputs in{};
  in.leaf_count = surface.leaves.size;
  in.balls = surface.leaf_balls.data;
  if (surface.leaf_boxes.size > 0) {
    in.boxes = surface.leaf_boxes.data;
  }
  in.term_counts = surface.cover_term_counts.data;
  in.term_bones = surface.cover_term_bones.data;
  in.terms = surface.cover_terms.data;
  if (morph_weights.size > 0 && surface.cover_morph_counts.size > 0) {
    in.morph_counts = surface.cover_morph_counts.data;
  }
  in.morph_targets = surface.cover_morph_targets.data;
  in.morphs = surface.cover_morphs.data;
  in.matrices = bones.data;
  in.stride = bones.stride / sizeof(float);
  in.row = row_step(bones.layout);
  in.column = column_step(bones.layout);
  in.morph_weights = morph_weights.data;
  in.sizes = sizes.data;
  in.size_count = std::min(asset.bone_count(), sizes.size);
  for (std::size_t bone = 0; bone < in.size_count; ++bone) {
    sizes.data[bone] = bone_size(in, bone);
  }
  return in;
}

BoneSize bone_size(const CoverInputs& in, std::size_t bone) {
  const float* m = in.matrices + bone * in.stride;
  float gram[3][3];
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = i; j < 3; ++j) {
      const float* p = m + i * in.column;
      const float* q = m + j * in.column;
      gram[i][j] = gram[j][i] = std::abs((p[0] * q[0] + p[in.row] * q[in.row]) + p[2 * in.row] * q[2 * in.row]);
    }
  }
  float most = 0;
  for (const auto& row : gram) {
    most = std::max(most, (row[0] + row[1]) + row[2]);
  }
  const float* t = m + 3 * in.column;
  return {std::sqrt(most), std::max({std::abs(t[0]), std::abs(t[in.row]), std::abs(t[2 * in.row])})};
}

Status CoverJob::run() const noexcept {
  const Status status = check_bone_inputs(asset, bones, morph_weights, RadiusKind::kFit);
  if (status != Status::kOk) {
    return status;
  }
  if (asset->leaf_count() == 0) {
    return Status::kNotInAsset;
  }
  if (leaves.data == nullptr || is_missing(spheres)) {
    return Status::kNullArgument;
  }
  if (any_misaligned(leaves.data, spheres.data)) {
    return Status::kMisaligned;
  }
  const std::size_t count = asset->spheres().size;
  if (leaves.size < asset->leaf_count() || (spheres.size > 0 && spheres.size < count)) {
    return Status::kTooFewSpheres;
  }
  Target resolved{};
  if (!resolve_target(target, resolved)) {
    return Status::kUnsupportedTarget;
  }
  const Span<Sphere> written{leaves.data, asset->leaf_count()};
  if (any_shared({range_of(written), range_of(Span<Sphere>{spheres.data, spheres.size > 0 ? count : 0})},
                 {range_of_matrices(bones, asset->bone_count()), range_of(morph_weights)})) {
    return Status::kSharedMemory;
  }
  BoneSize sizes[kSizesKept];
  cover_leaves_from_bones(cover_inputs(*asset, bones, morph_weights, {sizes, kSizesKept}), resolved, leaves.data);
  if (spheres.size > 0) {
    cover_spheres(*asset, leaves.data, spheres.data);
  }
  return Status::kOk;
}

}  // namespace spherechain

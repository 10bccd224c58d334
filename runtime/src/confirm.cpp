// SPDX-License-Identifier: MIT
#include "spherechain/confirm.h"

#include "contact_collector.h"
#include "contact_pose.h"
#include "simd.h"

namespace spherechain {
namespace {

bool shares_memory(const ConfirmJob& job) {
  const Span<std::uint64_t> words{job.context->words.data, TriangleContactContext::words_needed(*job.asset)};
  const PoseRanges pose = ranges_of(pose_of(job));
  return any_shared(
      {range_of(job.pairs), range_of(words)},
      {pose.positions, pose.matrices, pose.morph_weights, range_of(job.asset->triangles()), range_of(job.candidates)});
}

bool name_spheres(Span<const Pair> pairs, std::size_t sphere_count) {
  for (const Pair& pair : pairs) {
    if (pair.a >= sphere_count || pair.b >= sphere_count || pair.a == pair.b) {
      return false;
    }
  }
  return true;
}

Status check(const ConfirmJob& job, Target& resolved) {
  if (job.asset == nullptr || job.context == nullptr || is_missing(job.context->words) || is_missing(job.candidates) ||
      is_missing(job.pairs)) {
    return Status::kNullArgument;
  }
  if (!job.asset->is_open()) {
    return Status::kNotOpen;
  }
  if (any_misaligned(job.context->words.data, job.candidates.data, job.pairs.data)) {
    return Status::kMisaligned;
  }
  if (job.asset->leaf_count() == 0) {
    return Status::kNotInAsset;
  }
  const Status status = check_pose(pose_of(job));
  if (status != Status::kOk) {
    return status;
  }
  if (!name_spheres(job.candidates, job.asset->spheres().size)) {
    return Status::kBadArgument;
  }
  if (job.context->words.size < TriangleContactContext::words_needed(*job.asset)) {
    return Status::kContextTooSmall;
  }
  if (!resolve_target(job.target, resolved)) {
    return Status::kUnsupportedTarget;
  }
  return shares_memory(job) ? Status::kSharedMemory : Status::kOk;
}

}  // namespace

Status ConfirmJob::run() noexcept {
  Target resolved{};
  const Status status = check(*this, resolved);
  if (status != Status::kOk) {
    return status;
  }
  const ContactScene scene = scene_of(pose_of(*this), context->words);
  ContactCollector collector(*asset, {}, {}, {}, {});
  if (scene.has_balls && candidates.size > 0) {
    bound_leaves(resolved, scene);
  }
  std::size_t count = 0;
  for (const Pair& candidate : candidates) {
    if (!skins_touch(resolved, scene, candidate, collector)) {
      continue;
    }
    if (count < pairs.size) {
      pairs[count] = candidate;
    }
    ++count;
  }
  pair_count = count;
  return pairs.size > 0 && count > pairs.size ? Status::kOverflow : Status::kOk;
}

}  // namespace spherechain

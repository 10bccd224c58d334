// SPDX-License-Identifier: MIT
#include "spherechain/detect_skin.h"

#include "contact_collector.h"
#include "contact_pose.h"
#include "simd.h"

namespace spherechain {
namespace {

bool shares_memory(const DetectSkinJob& job) {
  const Span<std::uint64_t> words{job.context->words.data, TriangleContactContext::words_needed(*job.asset)};
  const PoseRanges pose = ranges_of(pose_of(job));
  return any_shared(
      {range_of(job.pairs), range_of(words)},
      {pose.positions, pose.matrices, pose.morph_weights, range_of(job.asset->triangles()),
       range_of(job.asset->ignored()), job.filter == nullptr ? MemoryRange{} : range_of(job.filter->ignored),
       job.filter == nullptr ? MemoryRange{} : range_of(job.filter->disabled)});
}

Status check(const DetectSkinJob& job, Target& resolved) {
  if (job.asset == nullptr || job.context == nullptr || is_missing(job.context->words) || is_missing(job.pairs)) {
    return Status::kNullArgument;
  }
  if (!job.asset->is_open()) {
    return Status::kNotOpen;
  }
  if (any_misaligned(job.context->words.data, job.pairs.data)) {
    return Status::kMisaligned;
  }
  if (job.asset->leaf_count() == 0) {
    return Status::kNotInAsset;
  }
  const Status status = check_pose(pose_of(job));
  if (status != Status::kOk) {
    return status;
  }
  if (job.filter != nullptr) {
    const Status filter_status = check_filter(*job.asset, *job.filter);
    if (filter_status != Status::kOk) {
      return filter_status;
    }
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

Status DetectSkinJob::run() noexcept {
  Target resolved{};
  const Status status = check(*this, resolved);
  if (status != Status::kOk) {
    return status;
  }
  const ContactScene scene = scene_of_all(pose_of(*this), filter, context->words);
  ContactCollector collector(*asset, {}, {}, {}, pairs);
  find_spheres(resolved, scene, collector);
  collector.finish();
  pair_count = collector.sphere_contact_count();
  return collector.overflowed() ? Status::kOverflow : Status::kOk;
}

}  // namespace spherechain

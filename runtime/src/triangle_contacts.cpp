// SPDX-License-Identifier: MIT
#include "spherechain/triangle_contacts.h"

#include "contact_collector.h"
#include "contact_pose.h"
#include "simd.h"

namespace spherechain {
namespace {

bool shares_memory(const TriangleContactJob& job) {
  const Span<std::uint64_t> words{job.context->words.data, TriangleContactContext::words_needed(*job.asset)};
  const MemoryRange written[] = {range_of(job.pairs), range_of(job.contacts), range_of(job.sphere_contacts),
                                 range_of(words)};
  const PoseRanges pose = ranges_of(pose_of(job));
  const MemoryRange read[] = {pose.positions,
                              pose.matrices,
                              pose.morph_weights,
                              range_of(job.asset->triangles()),
                              range_of(job.asset->ignored()),
                              job.filter == nullptr ? MemoryRange{} : range_of(job.filter->ignored),
                              job.filter == nullptr ? MemoryRange{} : range_of(job.filter->disabled)};
  return any_shared(written, read);
}

Status check(const TriangleContactJob& job, Target& resolved) {
  if (job.asset == nullptr || job.context == nullptr || is_missing(job.context->words) || is_missing(job.pairs) ||
      is_missing(job.contacts) || is_missing(job.sphere_contacts)) {
    return Status::kNullArgument;
  }
  if (!job.asset->is_open()) {
    return Status::kNotOpen;
  }
  if (any_misaligned(job.context->words.data, job.pairs.data, job.contacts.data, job.sphere_contacts.data)) {
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
  if (job.scope != ContactScope::kApart && job.scope != ContactScope::kNeighbours && job.scope != ContactScope::kAll) {
    return Status::kBadArgument;
  }
  if (!resolve_target(job.target, resolved)) {
    return Status::kUnsupportedTarget;
  }
  return shares_memory(job) ? Status::kSharedMemory : Status::kOk;
}

}  // namespace

Status TriangleContactJob::run() noexcept {
  Target resolved{};
  const Status status = check(*this, resolved);
  if (status != Status::kOk) {
    return status;
  }
  ContactScene scene = scene_of_all(pose_of(*this), filter, context->words);
  scene.apart = scope != ContactScope::kNeighbours;
  scene.neighbours = scope != ContactScope::kApart;
  ContactCollector collector(*asset, pairs, contacts, sphere_contacts, {});
  find_candidates(resolved, scene, collector);
  collector.finish();
  pair_count = collector.pair_count();
  sphere_contact_count = collector.sphere_contact_count();
  return collector.overflowed() ? Status::kOverflow : Status::kOk;
}

}  // namespace spherechain

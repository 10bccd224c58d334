// SPDX-License-Identifier: MIT
#include "crowd_checks.h"

#include "bone_refit.h"
#include "memory.h"
#include "spherechain/detect.h"

namespace spherechain {
namespace {

// What the bones of one instance take.
std::size_t instance_bytes(const CrowdJob& job) {
  return (job.asset->bone_count() - 1) * job.bones.stride + size_of(job.bones.layout);
}

bool shares_memory(const CrowdJob& job, std::size_t stride) {
  const std::size_t n = job.asset->spheres().size;
  const std::size_t before_last = job.instance_count == 0 ? 0 : job.instance_count - 1;
  const std::size_t spheres = job.instance_count == 0 || job.spheres == nullptr ? 0 : before_last * stride + n;
  const std::size_t floats = job.instance_count == 0 || job.bones.data == nullptr
                                 ? 0
                                 : (before_last * job.instance_stride + instance_bytes(job)) / sizeof(float);
  const bool has_filter = job.filter != nullptr;
  const MemoryRange written[] = {range_of(job.counts), range_of(job.bits), range_of(job.pairs),
                                 range_of(job.context->words)};
  const MemoryRange read[] = {range_of(Span<const Sphere>{job.spheres, spheres}),
                              range_of(job.asset->ignored()),
                              range_of(Span<const float>{job.bones.data, floats}),
                              range_of(job.morph_weights),
                              has_filter ? range_of(job.filter->ignored) : MemoryRange{},
                              has_filter ? range_of(job.filter->disabled) : MemoryRange{},
                              has_filter ? range_of(job.filter->padding) : MemoryRange{}};
  return any_shared(written, read);
}

Status check_bones(const CrowdJob& job) {
  if (job.spheres != nullptr) {
    return Status::kBadArgument;
  }
  const Status status = check_bone_inputs(job.asset, job.bones, {}, job.radius);
  if (status != Status::kOk) {
    return status;
  }
  constexpr std::size_t kMostBytes = 0xFFFFFFFFU;
  if (job.bones.stride > kMostBytes / job.asset->bone_count() || job.instance_stride > kMostBytes ||
      job.instance_stride % sizeof(float) != 0 || job.instance_stride < instance_bytes(job)) {
    return Status::kBadStride;
  }
  return job.morph_weights.size == 0 || job.morph_weights.size / job.instance_count >= job.asset->morph_count()
             ? Status::kOk
             : Status::kTooFewMorphs;
}

// Counts whose product with anything here cannot wrap.
bool sizes_fit(const CrowdJob& job, std::size_t stride) {
  constexpr std::size_t kMost = 0xFFFFFFFFU;
  constexpr std::uint64_t kMostSpheres = std::uint64_t{1} << 56;
  return job.instance_count < kMost && stride < kMost && (stride == 0 || job.instance_count <= kMostSpheres / stride) &&
         job.task_count > 0 && job.task_count < kMost &&
         (job.counts.size == 0 ? job.pairs.size == 0 : job.counts.size >= job.instance_count) &&
         (job.bits.size == 0 || job.bits.size == job.instance_count * DetectJob::bit_words(*job.asset)) &&
         (job.radius == RadiusKind::kFit || job.radius == RadiusKind::kDetect);
}

}  // namespace

Status check_crowd(const CrowdJob& job, std::size_t stride) {
  const bool has_bones = job.bones.data != nullptr;
  if ((job.spheres == nullptr && !has_bones && job.instance_count > 0) || is_missing(job.morph_weights) ||
      job.context == nullptr || is_missing(job.context->words) || is_missing(job.counts) || is_missing(job.bits) ||
      is_missing(job.pairs)) {
    return Status::kNullArgument;
  }
  if (any_misaligned(job.spheres, job.bones.data, job.morph_weights.data, job.context->words.data, job.counts.data,
                     job.bits.data, job.pairs.data)) {
    return Status::kMisaligned;
  }
  if (!sizes_fit(job, stride)) {
    return Status::kBadArgument;
  }
  if (stride < job.asset->spheres().size) {
    return Status::kTooFewSpheres;
  }
  if (has_bones && job.instance_count > 0) {
    const Status status = check_bones(job);
    if (status != Status::kOk) {
      return status;
    }
  }
  if (job.filter != nullptr) {
    const Status status = check_filter(*job.asset, *job.filter);
    if (status != Status::kOk) {
      return status;
    }
  }
  if (job.context->words.size < CrowdContext::words_needed(*job.asset, job.task_count)) {
    return Status::kContextTooSmall;
  }
  return shares_memory(job, stride) ? Status::kSharedMemory : Status::kOk;
}

}  // namespace spherechain

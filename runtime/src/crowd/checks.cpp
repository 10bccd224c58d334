// SPDX-License-Identifier: MIT
#include "runtime/src/crowd/checks.h"

#include <initializer_list>

#include "runtime/src/base/memory.h"
#include "runtime/src/base/pair_bits.h"
#include "runtime/src/base/status.h"
#include "runtime/src/pairs/filter.h"
#include "runtime/src/refit/inputs.h"

namespace spherechain {
namespace {

constexpr std::size_t kMaxCount = 0xFFFFFFFFU;  // products of counts cannot wrap

// Size of one instance's bone matrices, in bytes.
std::size_t instance_bytes(const AssetView& asset, const CrowdJob& job) {
  return (asset.bone_count() - 1) * bone_stride(job.pose) + size_of(job.pose.bone_layout);
}

// From the first instance to the end of the last one.
MemoryRange range_of_instances(const AssetView& asset, const CrowdJob& job) {
  if (job.instance_count == 0) {
    return {};
  }
  const std::size_t before_last = job.instance_count - 1;
  if (job.pose.bones == nullptr) {
    return range_of(Span<const Sphere>{job.spheres, before_last * sphere_stride(asset, job) + asset.spheres().size});
  }
  const std::size_t bytes = before_last * bone_stride(asset, job) + instance_bytes(asset, job);
  return range_of(Span<const float>{job.pose.bones, bytes / sizeof(float)});
}

bool is_aliased(const AssetView& asset, const CrowdJob& job) {
  const Filter filter = filter_of(asset, job.ignored_pairs);
  return any_shared({range_of(Span<std::uint32_t>{job.counts, job.count_capacity}),
                     range_of(Span<std::uint64_t>{job.bits, job.bit_words}),
                     range_of(Span<std::uint64_t>{job.part_pairs, job.part_pair_words}),
                     range_of(Span<CrowdPair>{job.pairs, job.pair_capacity}),
                     range_of(Span<std::uint64_t>{job.scratch, job.scratch_words})},
                    {range_of_instances(asset, job), range_of(asset.ignored()), range_of(&filter)});
}

Status check_instances(const AssetView& asset, const CrowdJob& job) {
  if (job.instance_count >= kMaxCount) {
    return refuse(SC_BAD_VALUE, SC_FIELD_INSTANCES);
  }
  if (job.pose.vertices != nullptr) {
    return refuse(SC_BAD_VALUE, SC_FIELD_VERTICES);
  }
  if (job.pose.bones == nullptr) {
    const Status status = check_list(job.spheres, job.instance_count, SC_FIELD_SPHERES);
    if (status != SC_OK || job.spheres == nullptr) {
      return status;
    }
    const std::size_t stride = sphere_stride(asset, job);
    return stride >= asset.spheres().size && stride < kMaxCount &&
                   job.instance_count <= SIZE_MAX / sizeof(Sphere) / stride
               ? done()
               : refuse(SC_BAD_STRIDE, SC_FIELD_INSTANCE_STRIDE);
  }
  if (job.spheres != nullptr) {
    return refuse(SC_BAD_VALUE, SC_FIELD_SPHERES);
  }
  const Status status = check_refit_bones(asset, job.pose, job.radius);
  if (status != SC_OK) {
    return status;
  }
  if (bone_stride(job.pose) > kMaxCount / asset.bone_count()) {
    return refuse(SC_BAD_STRIDE, SC_FIELD_BONE_STRIDE);
  }
  const std::size_t stride = bone_stride(asset, job);
  return stride <= kMaxCount && stride % sizeof(float) == 0 && stride >= instance_bytes(asset, job) &&
                 job.instance_count <= SIZE_MAX / stride
             ? done()
             : refuse(SC_BAD_STRIDE, SC_FIELD_INSTANCE_STRIDE);
}

Status check_outputs(const AssetView& asset, const CrowdJob& job) {
  for (const Status& status :
       {check_list(job.scratch, 1, SC_FIELD_SCRATCH), check_list(job.counts, job.count_capacity, SC_FIELD_COUNTS),
        check_list(job.bits, job.bit_words, SC_FIELD_BITS),
        check_list(job.part_pairs, job.part_pair_words, SC_FIELD_PART_PAIRS),
        check_list(job.pairs, job.pair_capacity, SC_FIELD_PAIRS)}) {
    if (status != SC_OK) {
      return status;
    }
  }
  const bool needs_counts = job.counts != nullptr || job.pair_capacity > 0;
  if (needs_counts && job.count_capacity < job.instance_count) {
    return refuse(job.counts == nullptr ? SC_NULL : SC_TOO_SMALL, SC_FIELD_COUNTS);
  }
  if (job.bit_words > 0 && job.bit_words != job.instance_count * words_for(pairs_of(asset.spheres().size))) {
    return refuse(SC_BAD_VALUE, SC_FIELD_BITS);
  }
  if (job.part_pair_words > 0 && job.part_pair_words != job.instance_count * part_pair_words(asset)) {
    return refuse(SC_BAD_VALUE, SC_FIELD_PART_PAIRS);
  }
  return done();
}

}  // namespace

std::size_t part_pair_words(const AssetView& asset) { return words_for(asset.part_count() * asset.part_count()); }

std::size_t sphere_stride(const AssetView& asset, const CrowdJob& job) {
  return job.instance_stride == 0 ? asset.spheres().size : job.instance_stride;
}

std::size_t bone_stride(const AssetView& asset, const CrowdJob& job) {
  return job.instance_stride == 0 ? asset.bone_count() * bone_stride(job.pose) : job.instance_stride;
}

Status check_crowd(const AssetView& asset, const CrowdJob& job) {
  for (const Status& status : {check_instances(asset, job), check_outputs(asset, job),
                               check_list(job.ignored_pairs, 0, SC_FIELD_IGNORED_PAIRS)}) {
    if (status != SC_OK) {
      return status;
    }
  }
  if (!is_radius(job.radius)) {
    return refuse(SC_BAD_VALUE, SC_FIELD_RADIUS);
  }
  if (task_count(job) >= kMaxCount) {
    return refuse(SC_BAD_VALUE, SC_FIELD_TASKS);
  }
  if (job.scratch_words < sc_crowd_scratch_words(job.asset, task_count(job))) {
    return refuse(SC_TOO_SMALL, SC_FIELD_SCRATCH);
  }
  return is_aliased(asset, job) ? refuse(SC_ALIASED, SC_FIELD_OUTPUT) : done();
}

}  // namespace spherechain

// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "spherechain/abi.h"
#include "spherechain/asset.h"
#include "spherechain/filter.h"
#include "spherechain/refit_bones.h"
#include "spherechain/simd.h"
#include "spherechain/status.h"
#include "spherechain/types.h"

namespace spherechain {

// The caller's scheduler: `parallel_for` calls task(data, i) once for each i below `count`, on any threads in any
// order, and returns when all have returned. Null: one after the other on the calling thread; the runtime starts no
// thread.
struct TaskHook {
  void (*parallel_for)(void* user, std::size_t count, void (*task)(void* data, std::size_t i), void* data) = nullptr;
  void* user = nullptr;
};

// Scratch memory of one CrowdJob at a time, owned by the caller.
struct SPHERECHAIN_API CrowdContext {
  Span<std::uint64_t> words;

  // Words needed for a job of `task_count` tasks; what they hold does not matter. A human of 73 spheres and 19 bones
  // and one task: some 80 KiB. 0 where it is not open.
  static std::size_t words_needed(const Asset& asset, std::size_t task_count) noexcept;
};

struct CrowdPair {
  std::uint32_t instance;
  Pair pair;

  friend constexpr bool operator==(const CrowdPair& l, const CrowdPair& r) {
    return l.instance == r.instance && l.pair == r.pair;
  }
};

// M2 for many instances of one asset, one instance a lane: for each, exactly the pairs a DetectJob reports, whatever
// the target, the instance's neighbours, the number of tasks and of threads. The instances come as spheres, or as
// bones: then each is refitted as a RefitBonesJob would, into scratch memory, so that bones in, pairs out is one call.
//
// Fill in the fields and call run(). Allocates nothing, takes no lock; jobs with other outputs and contexts may run at
// the same time.
struct SPHERECHAIN_API CrowdJob {
  const Asset* asset = nullptr;     // open
  const Sphere* spheres = nullptr;  // instance i's are spheres[i * stride] and on, from refits with the same `radius`
  std::size_t instance_count = 0;   // below 2^32
  std::size_t stride = 0;           // spheres from one instance to the next; at least the asset's, or 0: as many

  // Instead of `spheres`: instance 0's matrices, and the bytes from one instance's first matrix to the next's: a
  // multiple of 4, at least what the asset's bones take. Morph weights: asset->morph_count() an instance, or empty.
  BoneMatrices bones;
  std::size_t instance_stride = 0;
  Span<const float> morph_weights;

  RadiusKind radius = RadiusKind::kDetect;
  Target target = Target::kBest;
  const Filter* filter = nullptr;   // null: the asset's ignored pairs, all spheres as they are
  CrowdContext* context = nullptr;  // required
  TaskHook hook;
  std::size_t task_count = 1;  // at least 1: into how many tasks the instances are dealt, for the hook

  Span<std::uint32_t> counts;  // out: pairs of each instance; at least instance_count. May be empty without `pairs`
  Span<std::uint64_t> bits;    // out: DetectJob::bit_words() words an instance, as its `bits`; or empty
  // Out: sorted by instance, then pair; may be empty. Each of several tasks lists into an equal share of it first;
  // where one has more pairs than that, all cost a second pass: leave room for twice the pairs. What lies past
  // pair_count is written too.
  Span<CrowdPair> pairs;

  // Out: how many pairs there are, also where `pairs` was too small.
  std::size_t pair_count = 0;

  // kOk; kOverflow where `pairs` was not empty and too small (the first are written); kNullArgument, kNotOpen,
  // kBadStride, kNotInAsset, kTooFewBones, kTooFewMorphs, kTooFewSpheres (a stride below the asset's spheres),
  // kContextTooSmall, kBadArgument (both spheres and bones; a count or a buffer's size that does not fit),
  // kUnsupportedTarget, kBadFilter, kMisaligned, kSharedMemory: nothing is written, the count keeps its value.
  Status run() noexcept;
};

}  // namespace spherechain

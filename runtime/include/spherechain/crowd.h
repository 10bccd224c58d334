/* SPDX-License-Identifier: MIT */
/* Spheres and their pairs for many instances of one asset, one instance a SIMD lane. On a GPU: cuda.h. */
#pragma once

#include "spherechain/detect.h"
#include "spherechain/pose.h"

typedef struct sc_crowd_pair {
  uint32_t instance;
  sc_pair pair; /* of spheres */
} sc_crowd_pair;

/* For each instance exactly the pairs that a detect job reports, on every target and with any number of tasks. The
 * instances come as bones, or as spheres that are refitted already.
 *
 * Allocates nothing, takes no lock. Jobs on other outputs and scratch memory may run at the same time. */
typedef struct sc_crowd_job {
  const sc_asset* asset SC_ZERO;
  size_t instance_count SC_ZERO;    /* below 2^32 */
  sc_pose pose SC_ZERO;             /* bones of instance 0; morph weights are not read; no vertices */
  const sc_sphere* spheres SC_ZERO; /* or the spheres of instance 0, of refits with the same radius */
  /* From one instance to the next: bytes (bones; a multiple of 4) or entries (spheres). 0: side by side. */
  size_t instance_stride SC_ZERO;
  sc_radius radius SC_ZERO;
  sc_target target SC_ZERO;
  const sc_filter* filter SC_ZERO;
  uint64_t* scratch SC_ZERO; /* sc_crowd_scratch_words() words */
  size_t scratch_words SC_ZERO;
  /* Into how many tasks the instances are divided (0 counts as 1), and the caller's scheduler: it calls task(data, i)
   * once for each i below count, on any threads in any order, and returns when all have. Null: one after another. */
  size_t task_count SC_ZERO;
  void (*parallel_for)(void* user, size_t count, void (*task)(void* data, size_t i), void* data) SC_ZERO;
  void* user SC_ZERO;
  uint32_t* counts SC_ZERO; /* out: pairs of each instance; required with `pairs`, else may be null */
  size_t count_capacity SC_ZERO;
  uint64_t* bits SC_ZERO; /* out: sc_pair_words() words an instance; or null */
  size_t bit_words SC_ZERO;
  sc_crowd_pair* pairs SC_ZERO; /* out: sorted by instance, then pair; or null. What lies past pair_count is written
                                   too. With several tasks leave room for twice the pairs, or it takes a second pass */
  size_t pair_capacity SC_ZERO;
  size_t pair_count SC_ZERO; /* out: how many there are, also where `pairs` is too small */
#if defined(__cplusplus)
  sc_status run() noexcept;
#endif
} sc_crowd_job;

#if defined(__cplusplus)
extern "C" {
#endif

/* SC_OK; SC_OVERFLOW: the first pairs are written; or as sc_detect() and sc_refit(): nothing is written. */
SPHERECHAIN_API sc_status sc_detect_crowd(sc_crowd_job* job) SC_NOEXCEPT;

/* 0 where the asset is not open. A human of 73 spheres and 19 bones, one task: some 80 KiB. */
SPHERECHAIN_API size_t sc_crowd_scratch_words(const sc_asset* asset, size_t task_count) SC_NOEXCEPT;

#if defined(__cplusplus)
}
inline sc_status sc_crowd_job::run() noexcept { return sc_detect_crowd(this); }
namespace spherechain {
using CrowdJob = sc_crowd_job;
using CrowdPair = sc_crowd_pair;
}  // namespace spherechain
#endif

/* SPDX-License-Identifier: MIT */
/* Many characters: the pairs of spheres of each (on a GPU: cuda.h), and which of them may meet. */
#pragma once

#include "spherechain/pose.h"

typedef struct sc_crowd_pair {
  uint32_t instance;
  sc_pair pair; /* of spheres */
} sc_crowd_pair;

/* The pairs of spheres of many instances of one asset, one instance a SIMD lane: for each exactly those that
 * sc_find_sphere_pairs() reports, on every target and with any number of tasks. The instances come as bones, or as
 * spheres that are refitted already.
 *
 * Allocates nothing, takes no lock. Jobs on other outputs and scratch memory may run at the same time. */
typedef struct sc_crowd_job {
  uint32_t struct_size SC_SIZE_OF(sc_crowd_job);
  const sc_asset* asset SC_ZERO;
  size_t instance_count SC_ZERO; /* below 2^32 */
  /* Bones of instance 0 in the asset's order, not in that of a model's joints: sc_gather_bones(). Morph weights are not
   * read; no vertices. */
  sc_pose pose SC_ZERO;
  const sc_sphere* spheres SC_ZERO; /* or the spheres of instance 0, of refits with the same radius */
  /* From one instance to the next: bytes (bones; a multiple of 4) or entries (spheres). 0: side by side. */
  size_t instance_stride SC_ZERO;
  sc_radius radius SC_ZERO;
  sc_target target SC_ZERO;
  const uint64_t* ignored_pairs SC_ZERO; /* sc_pair_words() words; null: the asset's ignored pairs */
  uint64_t* scratch SC_ZERO;             /* sc_crowd_scratch_words() words */
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
  /* out: the pairs of body parts of which spheres overlap, as sc_query.part_pairs has them: of n parts (n n + 63) / 64
   * words an instance, bit a n + b where a <= b; or null. Spheres are an alarm and can miss a contact: ask the exact
   * questions of an alarmed character with these pairs for speed, or about all of them. */
  uint64_t* part_pairs SC_ZERO;
  size_t part_pair_words SC_ZERO; /* of all instances */
  sc_crowd_pair* pairs SC_ZERO;   /* out: sorted by instance, then pair; or null. Entries past pair_count are written
                                     too. With several tasks leave room for twice the pairs, or it takes a second pass */
  size_t pair_capacity SC_ZERO;
  size_t pair_count SC_ZERO; /* out: how many there are, also where `pairs` is too small */
#if defined(__cplusplus)
  sc_status run() noexcept;
#endif
} sc_crowd_job;

/* A character or a prop among those of an sc_scene_job. */
typedef struct sc_scene_body {
  const sc_sphere* spheres SC_ZERO; /* refitted; or null: the box counts */
  size_t sphere_count SC_ZERO;
  sc_vec3 low SC_ZERO, high SC_ZERO; /* without spheres: a box around the body, as sc_get_bounds() has it; finite */
  /* Moves the spheres, or the box, into the scene: a prop is refitted once, then moved. A scale that differs by axis
   * makes spheres of its largest. Null: they are there. */
  const sc_transform* transform SC_ZERO;
  uint32_t layer SC_ZERO; /* below 32 */
} sc_scene_body;

/* Which of hundreds of characters and props may meet? The job lists two bodies if a sphere of one overlaps a sphere of
 * the other. If one of them has no spheres, it lists them if their boxes touch. Between boxes of sc_get_bounds() no
 * pair whose skins meet is missing; those with a transform are larger by a millionth of their distance from the origin.
 * Spheres are an alarm; those with a negative radius touch nothing.
 *
 * Allocates nothing, takes no lock. Jobs on other outputs and scratch memory may run at the same time. */
typedef struct sc_scene_job {
  uint32_t struct_size SC_SIZE_OF(sc_scene_job);
  const sc_scene_body* bodies SC_ZERO;
  size_t body_count SC_ZERO; /* at most 2^24 */
  /* 32 words; null: all layers meet. Bit k of word l: bodies of layer l meet those of layer k, and bit l of word k. */
  const uint32_t* layers SC_ZERO;
  const sc_pair* ignored SC_ZERO; /* bodies that never meet: a rider and his horse; sorted, each once; null: none */
  size_t ignored_count SC_ZERO;
  uint64_t* scratch SC_ZERO; /* sc_scene_scratch_words() words; nothing is kept there between runs */
  size_t scratch_words SC_ZERO;
  sc_pair* pairs SC_ZERO; /* out: of places in `bodies`; sorted, each once; null: count only */
  size_t pair_capacity SC_ZERO;
  size_t pair_count SC_ZERO; /* out: how many there are, also where `pairs` is too small */
#if defined(__cplusplus)
  sc_status run() noexcept;
#endif
} sc_scene_job;

#if defined(__cplusplus)
extern "C" {
#endif

/* SC_OK; SC_OVERFLOW: the first pairs are written; or SC_NULL, SC_MISALIGNED, SC_TOO_SMALL, SC_BAD_STRIDE,
 * SC_BAD_VALUE, SC_ALIASED, SC_NOT_OPEN, SC_NOT_IN_ASSET, SC_UNSUPPORTED_TARGET: nothing is written. */
SPHERECHAIN_API sc_status sc_detect_crowd(sc_crowd_job* job) SC_NOEXCEPT;

/* 0 where the asset is not open. A human of 73 spheres and 19 bones, one task: some 80 KiB. */
SPHERECHAIN_API size_t sc_crowd_scratch_words(const sc_asset* asset, size_t task_count) SC_NOEXCEPT;

/* SC_OK; SC_OVERFLOW: the first pairs of the sorted list are written; SC_NULL, SC_MISALIGNED, SC_TOO_SMALL,
 * SC_BAD_VALUE, SC_ALIASED: nothing is written. */
SPHERECHAIN_API sc_status sc_find_meetings(sc_scene_job* job) SC_NOEXCEPT;
SPHERECHAIN_API size_t sc_scene_scratch_words(size_t body_count) SC_NOEXCEPT;

#if defined(__cplusplus)
}
inline sc_status sc_crowd_job::run() noexcept { return sc_detect_crowd(this); }
inline sc_status sc_scene_job::run() noexcept { return sc_find_meetings(this); }
namespace spherechain {
using CrowdJob = sc_crowd_job;
using CrowdPair = sc_crowd_pair;
using SceneBody = sc_scene_body;
using SceneJob = sc_scene_job;
}  // namespace spherechain
#endif

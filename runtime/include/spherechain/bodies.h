/* SPDX-License-Identifier: MIT */
/* Where do two characters, or a character and a prop, penetrate each other? Exact, as skin_contacts.h is for one. */
#pragma once

#include "spherechain/penetrations.h"

/* One of two bodies. Both stand in one space; two bodies may be of one asset. */
typedef struct sc_job_body {
  const sc_asset* asset SC_ZERO;         /* open, with triangles; a character, or what `bake --prop` wrote */
  sc_pose pose SC_ZERO;                  /* as of an sc_skin_contact_job; a prop has one bone */
  const uint64_t* skin_table SC_ZERO;    /* from sc_prepare_skin(), of this asset */
  const uint64_t* ignored_parts SC_ZERO; /* bit p: body part p meets nothing; null: all parts meet */
} sc_job_body;

/* A character or a prop among those of an sc_scene_job. */
typedef struct sc_scene_body {
  const sc_sphere* spheres SC_ZERO; /* refitted; or null: the box counts */
  size_t sphere_count SC_ZERO;
  sc_vec3 low SC_ZERO, high SC_ZERO; /* without spheres: a box around the body, as sc_bound_body() has it; finite */
  /* Moves the spheres, or the box, into the scene: a prop is refitted once, then moved. A scale that differs by axis
   * makes spheres of its largest. Null: they are there. */
  const sc_transform* transform SC_ZERO;
  uint32_t layer SC_ZERO; /* below 32 */
} sc_scene_body;

/* Which of hundreds of characters and props may meet? All pairs of bodies with a sphere each that overlap; where one of
 * the two has no spheres, whose boxes touch. Between boxes of sc_bound_body() no pair whose skins meet is missing; those
 * with a transform are larger by a millionth of their distance from the origin. Spheres are an alarm; those with a
 * negative radius touch nothing.
 *
 * Allocates nothing, takes no lock. Jobs on other outputs and scratch memory may run at the same time. */
typedef struct sc_scene_job {
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

/* All triangles of two bodies' skins that intersect. In what it lists, `_a` and the first index are of body a, `_b` and
 * the second of body b: nothing is swapped. Nothing is left out but the parts that the bodies ignore.
 *
 * Allocates nothing, takes no lock. Jobs on other outputs and scratch memory may run at the same time. */
typedef struct sc_body_contact_job {
  sc_job_body a SC_ZERO, b SC_ZERO;
  sc_target target SC_ZERO;     /* the same contacts on every one */
  int32_t spheres_only SC_ZERO; /* 1: find pairs of spheres alone; each ends at its first contact. Cheapest */
  uint64_t* scratch SC_ZERO;    /* sc_body_scratch_words() words; nothing is kept there between runs */
  size_t scratch_words SC_ZERO;
  /* Out. As of an sc_skin_contact_job: sorted, each once; null: count only. */
  sc_part_contact* parts SC_ZERO;
  size_t part_capacity SC_ZERO;
  sc_pair* spheres SC_ZERO;
  size_t sphere_capacity SC_ZERO;
  sc_triangle_contact* triangles SC_ZERO;
  size_t triangle_capacity SC_ZERO;
  /* A bit for each two parts whose triangles are listed; the others' are not counted either. Null: all are listed. Of one
   * body with n parts it is bit a n + b - a (a + 1) / 2, a <= b; of two, bit a n + b, where b has n parts. */
  const uint64_t* listed_parts SC_ZERO;
  size_t part_count SC_ZERO, sphere_count SC_ZERO, triangle_count SC_ZERO;
#if defined(__cplusplus)
  sc_status run() noexcept;
#endif
} sc_body_contact_job;

/* Measures two bodies' contacts: fill a and b as in the sc_body_contact_job that found `contacts`, and pass its whole
 * list of triangles. What an sc_penetration_job says holds here, too. `part` is of body a, `other` of body b.
 * Classes are SC_CLASS_SHELL (most of it is hidden), SC_CLASS_TOUCH and SC_CLASS_PENETRATION. They compare with the unit and the height of body a's asset: of a character and a prop, a is the character.
 *
 * Allocates nothing, takes no lock. Jobs on other outputs and scratch memory may run at the same time. */
typedef struct sc_body_penetration_job {
  sc_job_body a SC_ZERO, b SC_ZERO; /* ignored_parts is not read */
  sc_target target SC_ZERO;
  const sc_triangle_contact* contacts SC_ZERO; /* null: none */
  size_t contact_count SC_ZERO;
  const sc_penetration* previous SC_ZERO; /* null: none */
  size_t previous_count SC_ZERO;
  int32_t quick SC_ZERO;
  const sc_rule* rule SC_ZERO;
  uint64_t* scratch SC_ZERO; /* sc_body_penetration_scratch_words() words; nothing is kept there between runs */
  size_t scratch_words SC_ZERO;
  sc_penetration* penetrations SC_ZERO; /* out: sorted by (part, other) */
  size_t penetration_capacity SC_ZERO;
  /* Bit k: penetrations of class k are listed and counted; 0: all. A job that only counts counts all. */
  uint32_t classes SC_ZERO;
  size_t kept_count SC_ZERO; /* in: entries that the list has already, of other contacts; they are counted, too */
  size_t penetration_count SC_ZERO;
#if defined(__cplusplus)
  sc_status run() noexcept;
#endif
} sc_body_penetration_job;

/* The body parts with a vertex below the ground, and how deep it is straight down. `other` is SC_FLOOR; the direction is
 * `up`; `volume` is of the part below the ground, known where its skin does not end there; the box is around that part.
 * Classes are SC_CLASS_TOUCH and SC_CLASS_PENETRATION.
 *
 * Allocates nothing, takes no lock. Jobs on other outputs and scratch memory may run at the same time. */
typedef struct sc_floor_job {
  sc_job_body body SC_ZERO;
  sc_target target SC_ZERO; /* the same bits on every one */
  sc_vec3 up SC_ZERO;       /* of unit length */
  float height SC_ZERO;     /* of the plane: up . p = height on it */
  /* Null, or: how far the ground is above the plane at p; called for each vertex of the skin, in no certain order. */
  float (*terrain)(const void* user, sc_vec3 p) SC_ZERO;
  const void* user SC_ZERO;
  const sc_rule* rule SC_ZERO; /* as of an sc_penetration_job */
  uint64_t* scratch SC_ZERO; /* sc_floor_scratch_words() words; nothing is kept there between runs */
  size_t scratch_words SC_ZERO;
  sc_penetration* penetrations SC_ZERO; /* out: sorted by `part`; null, with a capacity of 0: count only */
  size_t penetration_capacity SC_ZERO;
  uint32_t classes SC_ZERO; /* as of an sc_penetration_job */
  size_t penetration_count SC_ZERO;
#if defined(__cplusplus)
  sc_status run() noexcept;
#endif
} sc_floor_job;

#if defined(__cplusplus)
extern "C" {
#endif

/* Errors as of sc_find_skin_contacts(); the field does not say which of the two bodies is meant. */
SPHERECHAIN_API sc_status sc_find_body_contacts(sc_body_contact_job* job) SC_NOEXCEPT;

/* Words of scratch memory; 0 where an asset is not open or has no triangles. */
SPHERECHAIN_API size_t sc_body_scratch_words(const sc_asset* a, const sc_asset* b) SC_NOEXCEPT;

/* Errors as of sc_measure_penetrations(). */
SPHERECHAIN_API sc_status sc_measure_body_penetrations(sc_body_penetration_job* job) SC_NOEXCEPT;
SPHERECHAIN_API size_t sc_body_penetration_scratch_words(const sc_asset* a, const sc_asset* b,
                                                         size_t contact_count) SC_NOEXCEPT;

/* Errors as of sc_measure_penetrations(); SC_BAD_VALUE with SC_FIELD_FLOOR: `up` or `height` is none. */
SPHERECHAIN_API sc_status sc_find_floor_penetrations(sc_floor_job* job) SC_NOEXCEPT;
SPHERECHAIN_API size_t sc_floor_scratch_words(const sc_asset* asset) SC_NOEXCEPT;

/* A box that holds all of the body's skin for certain: from bones somewhat too large, without reading a vertex; from
 * vertices alone exact. Reads asset, pose and skin_table. Errors as of sc_find_skin_contacts(). */
SPHERECHAIN_API sc_status sc_bound_body(const sc_job_body* body, sc_vec3* low, sc_vec3* high) SC_NOEXCEPT;

/* SC_OK; SC_OVERFLOW: the first pairs of the sorted list are written; SC_NULL, SC_MISALIGNED, SC_TOO_SMALL,
 * SC_BAD_VALUE, SC_ALIASED: nothing is written. */
SPHERECHAIN_API sc_status sc_find_meetings(sc_scene_job* job) SC_NOEXCEPT;
SPHERECHAIN_API size_t sc_scene_scratch_words(size_t body_count) SC_NOEXCEPT;

/* Words of a bit for each body part. 0 where the asset is not open. */
SPHERECHAIN_API size_t sc_part_words(const sc_asset* asset) SC_NOEXCEPT;

#if defined(__cplusplus)
}
inline sc_status sc_body_contact_job::run() noexcept { return sc_find_body_contacts(this); }
inline sc_status sc_body_penetration_job::run() noexcept { return sc_measure_body_penetrations(this); }
inline sc_status sc_floor_job::run() noexcept { return sc_find_floor_penetrations(this); }
inline sc_status sc_scene_job::run() noexcept { return sc_find_meetings(this); }
namespace spherechain {
using SceneBody = sc_scene_body;
using SceneJob = sc_scene_job;
using FloorJob = sc_floor_job;
using JobBody = sc_job_body;
using BodyContactJob = sc_body_contact_job;
using BodyPenetrationJob = sc_body_penetration_job;
}  // namespace spherechain
#endif

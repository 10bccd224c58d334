/* SPDX-License-Identifier: MIT */
/* Where does the skin penetrate itself? Exact: all triangles that intersect, and none else. */
#pragma once

#include "spherechain/contacts.h"
#include "spherechain/detect.h"
#include "spherechain/pose.h"

/* The skin is where the vertices put it; without vertices the job skins what it needs from the bones. With both, the
 * bones bound the search, and each vertex must be where its bone weights put it, up to rounding; else give vertices
 * alone (docs/arithmetic.md).
 *
 * Left out: triangles that share a position at rest (neighbours), triangles that intersect in the rest pose, and
 * ignored pairs.
 *
 * Allocates nothing, takes no lock. Jobs on other outputs and scratch memory may run at the same time. */
typedef struct sc_skin_contact_job {
  const sc_asset* asset SC_ZERO; /* open, with triangles */
  sc_pose pose SC_ZERO;
  sc_scope scope SC_ZERO;
  sc_target target SC_ZERO;
  int32_t spheres_only SC_ZERO;       /* 1: find pairs of spheres alone; each ends at its first contact. Cheapest */
  const uint64_t* skin_table SC_ZERO; /* from sc_prepare_skin(), of this asset */
  const sc_filter* filter SC_ZERO;    /* null: the asset's ignored pairs */
  /* Null, or: only these pairs of spheres, ignored or not, a <= b; a = b: within one sphere's triangles. Sorted, each
   * once. Then scope and filter must be zero. */
  const sc_pair* candidates SC_ZERO;
  size_t candidate_count SC_ZERO;
  uint64_t* scratch SC_ZERO; /* sc_skin_scratch_words() words; nothing is kept there between runs */
  size_t scratch_words SC_ZERO;
  /* Out. Lists are sorted, entries are listed once; null: count only. Counts say how many there are, also where a list
   * is too small. With spheres_only there are no parts and no triangles. Triangles that are not listed cost less. */
  sc_part_contact* parts SC_ZERO;
  size_t part_capacity SC_ZERO;
  sc_pair* spheres SC_ZERO; /* a = b: within one sphere's triangles */
  size_t sphere_capacity SC_ZERO;
  sc_triangle_contact* triangles SC_ZERO;
  size_t triangle_capacity SC_ZERO;
  /* A bit for each two parts whose triangles are listed; the others' are not counted either. Null: all are listed. Of
   * one body with n parts it is bit a n + b - a (a + 1) / 2, a <= b; of two, bit a n + b, where b has n parts. */
  const uint64_t* listed_parts SC_ZERO;
  size_t part_count SC_ZERO, sphere_count SC_ZERO, triangle_count SC_ZERO;
#if defined(__cplusplus)
  sc_status run() noexcept;
#endif
} sc_skin_contact_job;

#if defined(__cplusplus)
extern "C" {
#endif

/* SC_OK; SC_OVERFLOW: the first entries of the sorted list are written; SC_NULL, SC_MISALIGNED, SC_TOO_SMALL,
 * SC_BAD_STRIDE, SC_BAD_VALUE, SC_ALIASED, SC_NOT_OPEN, SC_NOT_IN_ASSET, SC_UNSUPPORTED_TARGET: nothing is written.
 * The same contacts on every target. A position that is not finite intersects nothing; matrices that are not finite
 * may lose contacts. */
SPHERECHAIN_API sc_status sc_find_skin_contacts(sc_skin_contact_job* job) SC_NOEXCEPT;

/* Expands the asset's packed skin into `words`, sc_skin_table_words() of them, once. Any number of jobs may share the
 * table; it must not change. 64-byte alignment is fastest. SC_OK, SC_NULL, SC_MISALIGNED, SC_TOO_SMALL, SC_NOT_OPEN,
 * SC_NOT_IN_ASSET (the asset has no triangles). */
SPHERECHAIN_API size_t sc_skin_table_words(const sc_asset* asset) SC_NOEXCEPT;
SPHERECHAIN_API sc_status sc_prepare_skin(const sc_asset* asset, uint64_t* words, size_t word_count) SC_NOEXCEPT;

/* Words of scratch memory; 0 where the asset is not open or has no triangles. */
SPHERECHAIN_API size_t sc_skin_scratch_words(const sc_asset* asset) SC_NOEXCEPT;

#if defined(__cplusplus)
}
inline sc_status sc_skin_contact_job::run() noexcept { return sc_find_skin_contacts(this); }
namespace spherechain {
using SkinContactJob = sc_skin_contact_job;
}  // namespace spherechain
#endif

/* SPDX-License-Identifier: MIT */
/* Which spheres touch? A cheap alarm, about a microsecond: it gives false alarms and can miss contacts. The skin's
 * answer is exact: skin_contacts.h. */
#pragma once

#include "spherechain/filter.h"

/* The overlap test of all pairs of spheres that are not ignored. Rest pairs, most of which touch at rest, are
 * reported where they come closer than rest_scale times the sum of their radii (docs/arithmetic.md).
 *
 * Allocates nothing, takes no lock. Jobs on other outputs may run at the same time. Needs 25 KiB of stack. */
typedef struct sc_detect_job {
  const sc_asset* asset SC_ZERO; /* open */
  const sc_sphere* spheres SC_ZERO;
  size_t sphere_count SC_ZERO; /* at least the asset's */
  sc_radius radius SC_ZERO;    /* of the spheres: which refit made them */
  sc_target target SC_ZERO;
  /* At most one of the two. A table from sc_prepare_detect(), with this asset and radius, is faster and holds the
   * filter it was made with; neither: the asset's own ignored pairs. */
  const uint64_t* table SC_ZERO;
  const sc_filter* filter SC_ZERO;
  sc_pair* pairs SC_ZERO; /* out: sorted, each once; null: count only */
  size_t pair_capacity SC_ZERO;
  uint64_t* bits SC_ZERO; /* out: bit b(b-1)/2 + a of each pair; sc_pair_words() words exactly; or null. Cheapest */
  size_t bit_words SC_ZERO;
  size_t pair_count SC_ZERO; /* out: how many there are, also where `pairs` is too small */
#if defined(__cplusplus)
  sc_status run() noexcept;
#endif
} sc_detect_job;

#if defined(__cplusplus)
extern "C" {
#endif

/* SC_OK; SC_OVERFLOW: the first pairs are written, pair_count says how many there are; SC_NULL, SC_MISALIGNED,
 * SC_TOO_SMALL, SC_BAD_VALUE, SC_ALIASED, SC_NOT_OPEN, SC_UNSUPPORTED_TARGET: nothing is written. */
SPHERECHAIN_API sc_status sc_detect(sc_detect_job* job) SC_NOEXCEPT;

/* Fills a table for detect jobs with this asset and radius, and with all that `filter` (or null) says now. Halves the
 * time of a detection; any number of jobs may share it. `words` is the caller's, sc_detect_table_words() of them. */
SPHERECHAIN_API size_t sc_detect_table_words(const sc_asset* asset) SC_NOEXCEPT;
SPHERECHAIN_API sc_status sc_prepare_detect(const sc_asset* asset, sc_radius radius, const sc_filter* filter,
                                            uint64_t* words, size_t word_count) SC_NOEXCEPT;

#if defined(__cplusplus)
}
inline sc_status sc_detect_job::run() noexcept { return sc_detect(this); }
namespace spherechain {
using DetectJob = sc_detect_job;
}  // namespace spherechain
#endif

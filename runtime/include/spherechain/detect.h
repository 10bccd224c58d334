/* SPDX-License-Identifier: MIT */
/* Which spheres touch? A cheap alarm, about a microsecond: it gives false alarms and can miss contacts. The skin's
 * answer is exact: skin_contacts.h. */
#pragma once

#include "spherechain/asset.h"

/* The pairs of spheres that a detection leaves out: the asset's own at first (sc_reset_filter), then edited by the
 * caller. The buffer is the caller's. A job reads the filter while it runs: do not edit it then. */
typedef struct sc_filter {
  /* Bit b(b-1)/2 + a, a < b: this pair of spheres is ignored. sc_pair_words() words. */
  uint64_t* ignored SC_ZERO;
  size_t ignored_words SC_ZERO;
} sc_filter;

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

/* Words of a bit for each pair. 0 where the asset is not open. */
SPHERECHAIN_API size_t sc_pair_words(const sc_asset* asset) SC_NOEXCEPT;

/* Fills a table for detect jobs with this asset and radius, and with all that `filter` (or null) says now. Halves the
 * time of a detection; any number of jobs may share it. `words` is the caller's, sc_detect_table_words() of them. */
SPHERECHAIN_API size_t sc_detect_table_words(const sc_asset* asset) SC_NOEXCEPT;
SPHERECHAIN_API sc_status sc_prepare_detect(const sc_asset* asset, sc_radius radius, const sc_filter* filter,
                                            uint64_t* words, size_t word_count) SC_NOEXCEPT;

/* These edit a filter's buffer. SC_BAD_VALUE: a sphere or region does not exist; nothing is written then. */
/* The asset's own pairs. */
SPHERECHAIN_API sc_status sc_reset_filter(const sc_asset* asset, sc_filter* filter) SC_NOEXCEPT;
/* `ignored` 0 reports the pair again, also where the asset itself ignores it. */
SPHERECHAIN_API sc_status sc_ignore_pair(const sc_asset* asset, sc_filter* filter, uint32_t a, uint32_t b,
                                         int ignored) SC_NOEXCEPT;
/* Each pair of a sphere of one region with a sphere of the other; the same region twice: the pairs within it. */
SPHERECHAIN_API sc_status sc_ignore_regions(const sc_asset* asset, sc_filter* filter, size_t region, size_t other,
                                            int ignored) SC_NOEXCEPT;
#if defined(__cplusplus)
}
inline sc_status sc_detect_job::run() noexcept { return sc_detect(this); }
namespace spherechain {
using Filter = sc_filter;
using DetectJob = sc_detect_job;
}  // namespace spherechain
#endif

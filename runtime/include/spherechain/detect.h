/* SPDX-License-Identifier: MIT */
/* Q2: which spheres touch? A cheap alarm, about a microsecond: it gives false alarms and can miss contacts. The skin's
 * answer is exact: skin_contacts.h. */
#pragma once

#include "spherechain/asset.h"

/* What a detection leaves out, and what it adds to the spheres: the asset's own at first (sc_reset_filter), then edited
 * by the caller. The buffers are the caller's. A job reads the filter while it runs: do not edit it then. */
typedef struct sc_filter {
  /* Bit b(b-1)/2 + a, a < b: this pair of spheres is ignored. sc_pair_words() words. */
  uint64_t* ignored SC_ZERO;
  size_t ignored_words SC_ZERO;
  /* Bit i: sphere i touches nothing. sc_sphere_words() words; or null: all are enabled. */
  uint64_t* disabled SC_ZERO;
  size_t disabled_words SC_ZERO;
  /* Added to each sphere's radius, in the spheres' units; as many as spheres; or null: none. May be negative. A radius
   * that is below 0 or not finite after it touches nothing. Of no effect on skin contacts. */
  float* padding SC_ZERO;
  size_t padding_count SC_ZERO;
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

/* The overlap test of cones: a link of two spheres stands for the convex hull of both. Reports pairs of links, by their
 * numbers in the table. Two links without a sphere in common touch where a ball on the way from one sphere to the other
 * overlaps one of the other link (docs/arithmetic.md). A link of a sphere with itself is that sphere.
 *
 * Allocates nothing, takes no lock. Jobs on other outputs may run at the same time. Needs 32 KiB of stack. */
typedef struct sc_cone_job {
  const sc_asset* asset SC_ZERO;    /* open */
  const sc_sphere* spheres SC_ZERO; /* refitted at the radius wanted */
  size_t sphere_count SC_ZERO;      /* at least the asset's */
  sc_target target SC_ZERO;
  const uint64_t* table SC_ZERO; /* from sc_prepare_cones(), with this asset */
  sc_pair* pairs SC_ZERO;        /* out: of links; sorted, each once; null: count only */
  size_t pair_capacity SC_ZERO;
  size_t pair_count SC_ZERO; /* out: how many there are, also where `pairs` is too small */
#if defined(__cplusplus)
  sc_status run() noexcept;
#endif
} sc_cone_job;

#if defined(__cplusplus)
extern "C" {
#endif

/* SC_OK; SC_OVERFLOW: the first pairs are written, pair_count says how many there are; SC_NULL, SC_MISALIGNED,
 * SC_TOO_SMALL, SC_BAD_VALUE, SC_ALIASED, SC_NOT_OPEN, SC_UNSUPPORTED_TARGET: nothing is written. */
SPHERECHAIN_API sc_status sc_detect(sc_detect_job* job) SC_NOEXCEPT;

/* Words of a bit for each pair, and for each sphere. 0 where the asset is not open. */
SPHERECHAIN_API size_t sc_pair_words(const sc_asset* asset) SC_NOEXCEPT;
SPHERECHAIN_API size_t sc_sphere_words(const sc_asset* asset) SC_NOEXCEPT;

/* Fills a table for detect jobs with this asset and radius, and with all that `filter` (or null) says now. Halves the
 * time of a detection; any number of jobs may share it. `words` is the caller's, sc_detect_table_words() of them. */
SPHERECHAIN_API size_t sc_detect_table_words(const sc_asset* asset) SC_NOEXCEPT;
SPHERECHAIN_API sc_status sc_prepare_detect(const sc_asset* asset, sc_radius radius, const sc_filter* filter,
                                            uint64_t* words, size_t word_count) SC_NOEXCEPT;

/* These edit a filter's buffers. SC_BAD_VALUE: a sphere, region or figure does not exist; nothing is written then. */
/* The asset's own pairs; every sphere enabled, no padding. */
SPHERECHAIN_API sc_status sc_reset_filter(const sc_asset* asset, sc_filter* filter) SC_NOEXCEPT;
/* `ignored` 0 reports the pair again, also where the asset itself ignores it. */
SPHERECHAIN_API sc_status sc_ignore_pair(const sc_asset* asset, sc_filter* filter, uint32_t a, uint32_t b,
                                         int ignored) SC_NOEXCEPT;
/* Each pair of a sphere of one region with a sphere of the other; the same region twice: the pairs within it. */
SPHERECHAIN_API sc_status sc_ignore_regions(const sc_asset* asset, sc_filter* filter, size_t region, size_t other,
                                            int ignored) SC_NOEXCEPT;
SPHERECHAIN_API sc_status sc_disable_sphere(const sc_asset* asset, sc_filter* filter, uint32_t sphere,
                                            int disabled) SC_NOEXCEPT;
SPHERECHAIN_API sc_status sc_pad_sphere(const sc_asset* asset, sc_filter* filter, uint32_t sphere,
                                        float padding) SC_NOEXCEPT;

/* Status as of sc_detect(). A sphere that is not finite, has a radius below 0, or has a coordinate or radius above 2^30
 * takes its links with it: these touch nothing. */
SPHERECHAIN_API sc_status sc_detect_cones(sc_cone_job* job) SC_NOEXCEPT;

/* The asset's own links, sorted: spheres of one region that follow each other in a chain and are neighbours on the
 * body; spheres without any, alone. Writes the first `capacity` and returns how many there are. 0 of an asset that is
 * not open or has more than 256 spheres. */
SPHERECHAIN_API size_t sc_chain_links(const sc_asset* asset, sc_pair* links, size_t capacity) SC_NOEXCEPT;

/* Fills a table for cone jobs with this asset, which any number of them may share. A link is two spheres in any order,
 * or one twice; spheres in no link are left out. `words` is the caller's, sc_cone_table_words() of them: about 4 bytes
 * an ordered pair of links. That is 0 of more than 256 links, the most that a table has.
 *
 * Never reported are links that share a sphere, have one that `filter` disables, or whose spheres are all ignored with
 * each other in `filter`, or where that is null, in the asset. Its padding is of no effect.
 *
 * `rest`, or null: the asset's spheres at rest, of the radius that jobs will have. Links that touch there are reported
 * only where they would with all radii multiplied by 0.9 of what makes them just touch at rest.
 *
 * SC_OK; SC_NULL, SC_MISALIGNED, SC_TOO_SMALL, SC_BAD_VALUE (field `pairs`: more than 256 links; `index`: a link has a
 * sphere that does not exist), SC_ALIASED, SC_NOT_OPEN: nothing is written. */
SPHERECHAIN_API size_t sc_cone_table_words(size_t link_count) SC_NOEXCEPT;
SPHERECHAIN_API sc_status sc_prepare_cones(const sc_asset* asset, const sc_filter* filter, const sc_pair* links,
                                           size_t link_count, const sc_sphere* rest, uint64_t* words,
                                           size_t word_count) SC_NOEXCEPT;
/* From then on links a < b are reported where they touch with all radii multiplied by `scale`, 0 to 4; with any other:
 * never. For scales that are calibrated. No job may run meanwhile. SC_NULL, SC_MISALIGNED, SC_TOO_SMALL; SC_BAD_VALUE:
 * `words` is no table, or has no such links. */
SPHERECHAIN_API sc_status sc_scale_cones(uint64_t* words, size_t word_count, uint32_t a, uint32_t b,
                                         float scale) SC_NOEXCEPT;

#if defined(__cplusplus)
}
inline sc_status sc_cone_job::run() noexcept { return sc_detect_cones(this); }
inline sc_status sc_detect_job::run() noexcept { return sc_detect(this); }
namespace spherechain {
using Filter = sc_filter;
using DetectJob = sc_detect_job;
using ConeJob = sc_cone_job;
}  // namespace spherechain
#endif

/* SPDX-License-Identifier: MIT */
/* Which spheres never meet? */
#pragma once

#include "spherechain/asset.h"

/* The pairs of spheres that a question leaves out: the asset's own at first (sc_reset_filter), then edited by the
 * caller. The buffer is the caller's. A question reads the filter while it runs: do not edit it then. */
typedef struct sc_filter {
  /* Bit b(b-1)/2 + a, a < b: this pair of spheres is ignored. sc_pair_words() words. */
  uint64_t* ignored SC_ZERO;
  size_t ignored_words SC_ZERO;
} sc_filter;

#if defined(__cplusplus)
extern "C" {
#endif

/* Words of a bit for each pair of spheres. 0 where the asset is not open. */
SPHERECHAIN_API size_t sc_pair_words(const sc_asset* asset) SC_NOEXCEPT;
/* Words of a bit for each body part. 0 where the asset is not open. */
SPHERECHAIN_API size_t sc_part_words(const sc_asset* asset) SC_NOEXCEPT;

/* These edit a filter's buffer. SC_BAD_VALUE: a sphere or part does not exist; nothing is written then. */
/* The asset's own pairs. */
SPHERECHAIN_API sc_status sc_reset_filter(const sc_asset* asset, sc_filter* filter) SC_NOEXCEPT;
/* `ignored` 0 reports the pair again, also where the asset itself ignores it. */
SPHERECHAIN_API sc_status sc_ignore_pair(const sc_asset* asset, sc_filter* filter, uint32_t a, uint32_t b,
                                         int ignored) SC_NOEXCEPT;
/* Each pair of a sphere of one body part with a sphere of the other (sc_rest_sphere.part); the same part twice: the
 * pairs within it. */
SPHERECHAIN_API sc_status sc_ignore_parts(const sc_asset* asset, sc_filter* filter, size_t part, size_t other,
                                          int ignored) SC_NOEXCEPT;
#if defined(__cplusplus)
}
namespace spherechain {
using Filter = sc_filter;
}
#endif

/* SPDX-License-Identifier: MIT */
/* Where are the character's spheres in this pose? */
#pragma once

#include "spherechain/pose.h"

/* Moves the spheres with the bones, or with the deformed vertices. From bones it never touches the mesh: a sphere's
 * centre and radius are the moments of its pivots, which follow from the matrices (docs/arithmetic.md). Both ways give
 * the same spheres but for rounding. Where the pose has both, bones are taken. Morph weights move no sphere.
 *
 * Allocates nothing, takes no lock. Jobs on other buffers may run at the same time. Needs 40 KiB of stack. */
typedef struct sc_refit_job {
  const sc_asset* asset SC_ZERO; /* open */
  sc_pose pose SC_ZERO;          /* bones or vertices */
  sc_radius radius SC_ZERO;
  sc_target target SC_ZERO;
  sc_sphere* spheres SC_ZERO; /* out: the asset's, in its order; in the pose's space */
  size_t sphere_capacity SC_ZERO;
#if defined(__cplusplus)
  sc_status run() const noexcept;
#endif
} sc_refit_job;

#if defined(__cplusplus)
extern "C" {
#endif

/* SC_OK, or SC_NULL, SC_MISALIGNED, SC_TOO_SMALL, SC_BAD_STRIDE, SC_BAD_VALUE, SC_ALIASED, SC_NOT_OPEN,
 * SC_NOT_IN_ASSET (bones, but the asset has none, or is of profile `paper`), SC_UNSUPPORTED_TARGET: then nothing is
 * written. What is not finite gives spheres that are not finite; they touch nothing. */
SPHERECHAIN_API sc_status sc_refit(const sc_refit_job* job) SC_NOEXCEPT;

#if defined(__cplusplus)
}
inline sc_status sc_refit_job::run() const noexcept { return sc_refit(this); }
namespace spherechain {
using RefitJob = sc_refit_job;
}
#endif

/* SPDX-License-Identifier: MIT */
/* How deep, which way out, how much, and what kind? A measure of what the exact contacts found. */
#pragma once

#include "spherechain/rule.h"
#include "spherechain/skin_contacts.h"

/* Measures the contacts of one pose. Fill asset, pose, scope, filter and skin_table as in the sc_skin_contact_job that
 * found `contacts`, and pass its whole list of triangles. Classes compare with the character's height: the asset's,
 * times the scale of the root's bone (the first part that hangs on none), where the pose has bones. Deformed vertices
 * alone must have the asset's scale.
 *
 * Depth is the shortest of the ways along several directions; a straight way may exist that is a little shorter.
 * Give the last frame's results as `previous`: the direction of a fault stays while the way is at most a quarter longer
 * than the shortest, so that it does not flicker. Depth and class do not depend on it.
 *
 * Allocates nothing, takes no lock. Jobs on other outputs and scratch memory may run at the same time. */
typedef struct sc_penetration_job {
  const sc_asset* asset SC_ZERO; /* open, with triangles */
  sc_pose pose SC_ZERO;
  sc_scope scope SC_ZERO;
  sc_target target SC_ZERO; /* the same bits on every one */
  const uint64_t* skin_table SC_ZERO;
  const sc_filter* filter SC_ZERO;
  const sc_triangle_contact* contacts SC_ZERO; /* null: none */
  size_t contact_count SC_ZERO;
  const sc_penetration* previous SC_ZERO; /* null: none */
  size_t previous_count SC_ZERO;
  int32_t quick SC_ZERO; /* 1: along one direction, without volume and visibility, but for likely faults: these are
                            measured in full, so that both forms find the same faults. For games */
  const sc_rule* rule SC_ZERO; /* null: sc_default_rule() */
  uint64_t* scratch SC_ZERO;   /* sc_penetration_scratch_words() words; nothing is kept there between runs */
  size_t scratch_words SC_ZERO;
  /* Out. Sorted by the two parts, the lesser number first. The count says how many there are, also where the list is
   * too small. */
  sc_penetration* penetrations SC_ZERO; /* null, with a capacity of 0: count only */
  size_t penetration_capacity SC_ZERO;
  /* Bit k: penetrations of class k are listed and counted; 0: all. A job that only counts counts all. */
  uint32_t classes SC_ZERO;
  size_t kept_count SC_ZERO; /* in: entries that the list has already, of other contacts; they are counted, too */
  size_t penetration_count SC_ZERO;
#if defined(__cplusplus)
  sc_status run() noexcept;
#endif
} sc_penetration_job;

#if defined(__cplusplus)
extern "C" {
#endif

/* SC_OK; SC_OVERFLOW: the worst entries are written; SC_NULL, SC_MISALIGNED, SC_TOO_SMALL, SC_BAD_STRIDE, SC_ALIASED,
 * SC_NOT_OPEN, SC_NOT_IN_ASSET, SC_UNSUPPORTED_TARGET, SC_BAD_VALUE (also: a contact names a triangle that is not in
 * the asset's skin): nothing is written. `previous` may not overlap `penetrations`. */
SPHERECHAIN_API sc_status sc_measure_penetrations(sc_penetration_job* job) SC_NOEXCEPT;

/* Words of scratch memory for so many contacts; 0 where the asset is not open or has no triangles. */
SPHERECHAIN_API size_t sc_penetration_scratch_words(const sc_asset* asset, size_t contact_count) SC_NOEXCEPT;

#if defined(__cplusplus)
}
inline sc_status sc_penetration_job::run() noexcept { return sc_measure_penetrations(this); }
namespace spherechain {
using PenetrationJob = sc_penetration_job;
}  // namespace spherechain
#endif

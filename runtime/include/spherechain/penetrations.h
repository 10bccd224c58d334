/* SPDX-License-Identifier: MIT */
/* How deep, which way out, how much, and what kind? A measure of what the exact contacts found. */
#pragma once

#include "spherechain/skin_contacts.h"

/* What a person would call it. The first that applies. From SC_CLASS_DEEP_FOLD on it is a fault. */
SC_ENUM(sc_penetration_class){
    SC_CLASS_REST = 0,        /* the two spots touch in the rest pose, too */
    SC_CLASS_SHELL = 1,       /* another layer of the same place (a garment on the body), or most of it is hidden */
    SC_CLASS_TOUCH = 2,       /* less deep than the job's touch_depth; or no fold, and little goes in */
    SC_CLASS_FOLD = 3,        /* of neighbours on the body, near the joint: an elbow, a groin */
    SC_CLASS_DEEP_FOLD = 4,   /* a fold of one piece of skin, deeper than 4.5 % of the character's height */
    SC_CLASS_PENETRATION = 5, /* all else: a fault */
};

/* A point on the skin. */
typedef struct sc_skin_point {
  sc_vec3 position;  /* the pose's space */
  uint32_t triangle; /* the source's number */
  float weights[3];  /* of the triangle's corners; their sum is 1 */
} sc_skin_point;

/* Two body parts that intersect. Lengths in the pose's units. */
typedef struct sc_penetration {
  uint32_t part_a, part_b; /* part_a <= part_b; equal where a part meets itself */
  sc_penetration_class kind;
  float depth;          /* > 0: part_b, moved so far in `direction`, no longer intersects part_a. Of a part that meets
                           itself: of the triangles that intersect */
  sc_vec3 direction;    /* unit length. Moves part_b; its negative moves part_a */
  int32_t is_closed;    /* 1: the line where the parts cross closes, and `volume` is known */
  float volume;         /* of part_b inside part_a; 0 where not closed, and with `quick` */
  float contour_length; /* of the line where the parts cross */
  float visible;        /* 0 to 1: the share of that line that can be seen from outside; with `quick` 1 */
  sc_skin_point deepest_a, deepest_b; /* the points that part last; deepest_a - deepest_b = depth * direction */
} sc_penetration;

/* Measures the contacts of one pose. Fill asset, pose, scope, filter and skin_table as in the sc_skin_contact_job that
 * found `contacts`, and pass its whole list of triangles. Classes compare with the character's height: the asset's,
 * times the scale of the root's bone (the first part that hangs on none), where the pose has bones. Deformed vertices
 * alone must have the asset's scale.
 *
 * Depth is the shortest of the ways along several directions; a straight way may exist that is a little shorter.
 * Give the last frame's results as `previous`: a direction stays while it is at most a quarter longer than the
 * shortest, so that it does not flicker.
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
  int32_t quick SC_ZERO;     /* 1: one direction, no volume, no visibility, no previous frame. For games */
  float touch_depth SC_ZERO; /* >= 0. 0: 3 mm, by the asset's metres_per_unit, but at least 0.19 % and at most 0.66 % of
                                the height; but for folds, up to ten times that where little goes in: depth / thickness
                                of the thinner part * seen contour / side of a square like the smaller part < 0.25 */
  uint64_t* scratch SC_ZERO; /* sc_penetration_scratch_words() words; nothing is kept there between runs */
  size_t scratch_words SC_ZERO;
  /* Out. Sorted by (part_a, part_b). The count says how many there are, also where the list is too small. */
  sc_penetration* penetrations SC_ZERO; /* null, with a capacity of 0: count only */
  size_t penetration_capacity SC_ZERO;
  size_t penetration_count SC_ZERO;
#if defined(__cplusplus)
  sc_status run() noexcept;
#endif
} sc_penetration_job;

#if defined(__cplusplus)
extern "C" {
#endif

/* SC_OK; SC_OVERFLOW: the first entries are written; SC_NULL, SC_MISALIGNED, SC_TOO_SMALL, SC_BAD_STRIDE, SC_ALIASED,
 * SC_NOT_OPEN, SC_NOT_IN_ASSET, SC_UNSUPPORTED_TARGET, SC_BAD_VALUE (also: a contact names a triangle that is not in
 * the asset's skin): nothing is written. `previous` may not overlap `penetrations`. */
SPHERECHAIN_API sc_status sc_measure_penetrations(sc_penetration_job* job) SC_NOEXCEPT;

/* Words of scratch memory for so many contacts; 0 where the asset is not open or has no triangles. */
SPHERECHAIN_API size_t sc_penetration_scratch_words(const sc_asset* asset, size_t contact_count) SC_NOEXCEPT;

/* "rest", "shell", "touch", "fold", "deep_fold", "penetration"; never null. */
SPHERECHAIN_API const char* sc_penetration_class_name(sc_penetration_class kind) SC_NOEXCEPT;

#if defined(__cplusplus)
}
inline sc_status sc_penetration_job::run() noexcept { return sc_measure_penetrations(this); }
namespace spherechain {
using PenetrationClass = sc_penetration_class;
using SkinPoint = sc_skin_point;
using Penetration = sc_penetration;
using PenetrationJob = sc_penetration_job;
}  // namespace spherechain
#endif

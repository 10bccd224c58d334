/* SPDX-License-Identifier: MIT */
/* Between two frames: what touches on the way from one pose to the next, and when? */
#pragma once

#include "spherechain/bodies.h"

/* How a body goes from one pose to the next. */
SC_ENUM(sc_blend){
    SC_BLEND_LINEAR = 0, /* matrices, vertices and morph weights: each number on its own */
    SC_BLEND_SLERP = 1,  /* joints: rotations at constant speed; translations, scales and morph weights linearly */
    SC_BLEND_NLERP = 2,  /* joints: rotations as quaternions, linearly, brought back to unit length */
};

/* A body, and where it stands a step later. Of one body alone ignored_parts is not read.
 *
 * SC_BLEND_LINEAR: from body.pose to `end`, both with bones, or both with vertices.
 * SC_BLEND_SLERP, SC_BLEND_NLERP: from start_joints to end_joints, each in its parent's space, composed down the
 * skeleton as engines do; poses have morph weights at most, no bones and no vertices. The bone b of the asset gets the
 * world matrix of its joint times the asset's inverse bind matrix (sc_asset_bone()); joints may be there that move no
 * bone; a bone without a joint stays at rest. A rotation goes the shorter way round: of one that turns a joint by half
 * a turn or more in one step, that way is assumed; of exactly half a turn, the sign that the quaternions have. */
typedef struct sc_motion {
  sc_job_body body SC_ZERO;
  sc_pose end SC_ZERO;
  sc_blend blend SC_ZERO;
  const sc_transform* start_joints SC_ZERO;
  const sc_transform* end_joints SC_ZERO;
  size_t joint_count SC_ZERO;            /* at most 65536 */
  const uint32_t* parents SC_ZERO;       /* of a joint an earlier one, or SC_NO_JOINT; null: of all SC_NO_JOINT */
  const uint32_t* joint_of_bone SC_ZERO; /* of each bone of the asset: sc_bind_joints(); null: joint b moves bone b */
} sc_motion;

/* All pairs of body parts that touch on the way from one pose to the next: of body a with itself, where b.body.asset is
 * null, else of a and b. Nothing is missing and nothing made up, but for the tolerance: what comes no further into
 * contact than that, measured as the change of the distance of two corners of the skin, may be found or not; and times
 * are as exact. Of corners that move against each other by more than 32768 tolerances in the step, about three heights,
 * it is larger. Left out is what sc_find_skin_contacts(), or sc_find_body_contacts(), leaves out.
 *
 * Allocates nothing, takes no lock. Jobs on other outputs and scratch memory may run at the same time. */
typedef struct sc_step_job {
  sc_motion a SC_ZERO, b SC_ZERO;
  sc_target target SC_ZERO;        /* the same contacts, and times, on every one */
  const sc_filter* filter SC_ZERO; /* of one body; null: the asset's ignored pairs */
  float tolerance SC_ZERO;         /* a share of the height of a's asset; 0: 0.0001 */
  uint64_t* scratch SC_ZERO;       /* sc_step_scratch_words() words; nothing is kept there between runs */
  size_t scratch_words SC_ZERO;
  /* Out: sorted by (part_a, part_b), each once; null: count only. Of n parts at most n (n + 1) / 2; of two bodies n m.
   */
  sc_step_contact* contacts SC_ZERO;
  size_t contact_capacity SC_ZERO;
  size_t contact_count SC_ZERO; /* out: how many there are, also where `contacts` is too small */
#if defined(__cplusplus)
  sc_status run() noexcept;
#endif
} sc_step_job;

#if defined(__cplusplus)
extern "C" {
#endif

/* Errors as of sc_find_body_contacts(); and SC_BAD_VALUE: SC_FIELD_END (vertices at one end alone), SC_FIELD_BLEND,
 * SC_FIELD_JOINTS (not finite, a quaternion of length zero, a pose with bones or vertices beside them; or a step so
 * wild that the skin may be 256 heights off straight lines), SC_FIELD_MORPH_WEIGHTS (as wild, or not finite),
 * SC_FIELD_PARENTS, SC_FIELD_TOLERANCE (not finite, negative, above 1). The field does not say which of two bodies is
 * meant. Matrices and vertices that are not finite touch nothing. */
SPHERECHAIN_API sc_status sc_find_step_contacts(sc_step_job* job) SC_NOEXCEPT;

/* Words of scratch memory for those assets and numbers of joints; b null: one body. Of two bodies those that have
 * vertices need more. 0 where an asset is not open or has no triangles, or there are too many joints. */
SPHERECHAIN_API size_t sc_step_scratch_words(const sc_motion* a, const sc_motion* b) SC_NOEXCEPT;

#if defined(__cplusplus)
}
inline sc_status sc_step_job::run() noexcept { return sc_find_step_contacts(this); }
namespace spherechain {
using Blend = sc_blend;
using Motion = sc_motion;
using StepJob = sc_step_job;
}  // namespace spherechain
#endif

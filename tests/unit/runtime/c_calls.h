/* SPDX-License-Identifier: MIT */
/* The results that a C99 program gets from every function of spherechain.h, for a C++ test to compare. */
#pragma once

#include "spherechain/spherechain.h"

enum { C_CALLS_SPHERES = 32, C_CALLS_ROOM = 4096 };

typedef struct c_calls_result {
  const char* failed; /* the call that did not give what it should; null: none */
  sc_sphere spheres[C_CALLS_SPHERES];
  sc_pair pairs[C_CALLS_ROOM];
  size_t pair_count;
  sc_triangle_contact triangles[C_CALLS_ROOM];
  size_t triangle_count;
  sc_part_contact parts[64];
  size_t part_count;
  sc_crowd_pair crowd_pairs[C_CALLS_ROOM];
  size_t crowd_pair_count;
  size_t body_triangle_count, body_part_count; /* of the body and itself */
  size_t floor_part_count;                     /* below a floor that is high */
  sc_step_contact step_contacts[64];           /* from the pose to the one at rest */
  size_t step_contact_count;
} c_calls_result;

#if defined(__cplusplus)
extern "C"
#endif
    /* Calls about an asset with bones: 3 by 4 matrices side by side, and the source's rest pose. */
    void
    c_call_all(const void* data, size_t size, const float* matrices, size_t bone_count, const float* rest,
               size_t vertex_count, c_calls_result* result);

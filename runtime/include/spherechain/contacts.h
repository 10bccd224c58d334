/* SPDX-License-Identifier: MIT */
/* Results: contacts, penetrations, and touches between two poses. */
#pragma once

#include "spherechain/rule.h"

/* Which triangles are paired, by the spheres that they belong to. */
SC_ENUM(sc_scope){
    SC_SCOPE_APART = 0,      /* of two spheres that are not ignored: no neighbours on the body. Layers of one place are
                                left out: a garment on the body, the skin below it */
    SC_SCOPE_NEIGHBOURS = 1, /* of one sphere, or of two that are ignored: folds of elbow and knee; 40 times dearer */
    SC_SCOPE_ALL = 2, SC_SCOPE_LAYERS = 3, /* as SC_SCOPE_APART, and layers of one place */
};

/* Two body parts whose skins intersect. */
typedef struct sc_part_contact {
  uint32_t part_a, part_b; /* part_a <= part_b; equal where a part meets itself */
  uint32_t triangle_pairs; /* >= 1 */
  sc_vec3 low, high;       /* a box around the triangles that intersect; the pose's space */
} sc_part_contact;

/* Two triangles that intersect. Fields that end with _a are of triangle_a. */
typedef struct sc_triangle_contact {
  uint32_t triangle_a, triangle_b; /* the source's numbers, triangle_a < triangle_b */
  uint32_t sphere_a, sphere_b;
  uint32_t part_a, part_b;
  sc_vec3 from, to; /* the segment in which they cross, rounded. If they lie in one plane: the longest piece of an edge
                       inside the other triangle */
} sc_triangle_contact;

#define SC_FLOOR 0xFFFFFFFFu /* in place of a body part and of a triangle: the ground */

/* A point on the skin. */
typedef struct sc_skin_point {
  sc_vec3 position;  /* the pose's space */
  uint32_t triangle; /* the source's number */
  float weights[3];  /* of the triangle's corners; their sum is 1 */
} sc_skin_point;

/* Two body parts that intersect. Lengths in the pose's units. */
typedef struct sc_penetration {
  /* `part` goes into `other`. Within one body it is the more mobile of the two (sc_part.mobility), or the smaller if
   * both are alike; a part may meet itself. Between two bodies, `part` belongs to the first. */
  uint32_t part, other;
  uint32_t joint; /* moves `part`, in the order of the model's joints; SC_NO_JOINT where none does */
  sc_penetration_class kind;
  /* In the pose's space, of unit length. `part`, moved by distance * direction, no longer intersects `other`. If a part
   * meets itself, one side of the triangles that intersect moves. */
  sc_vec3 direction;
  float fault_depth; /* how much deeper than the rule allows, the less the less of it can be seen; 0: not deeper. It is
                        continuous in `measures`, and does not depend on `previous` */
  float distance;    /* measures.depth; up to 1.5 times as much where `previous` keeps the direction. While a part goes
                        inside, from 75 to 100 % of sc_rule.inside, depth lies between two ways out; this is one of them */
  sc_vec3 centre;    /* of the line where the parts cross; of the ground: of the box */
  sc_vec3 low, high; /* a box around that line; of the ground: around the skin below it */
  sc_skin_point deepest, deepest_other; /* the points that part last; deepest_other - deepest = distance * direction */
  sc_measures measures;
  uint32_t reserved[4]; /* 0 */
} sc_penetration;

#define SC_NO_TRIANGLE 0xFFFFFFFFu

/* Two body parts that touch in a step. Times are shares of the step: 0 is its start, 1 its end. */
typedef struct sc_step_contact {
  uint32_t part_a, part_b;
  int32_t at_start, at_end;        /* 1: they intersect in that pose: ask for its contacts */
  float begin;                     /* the first time at which they touch; 0 with at_start */
  float end;                       /* the last time; 1 with at_end. They may part and meet again before it */
  uint32_t triangle_a, triangle_b; /* these touch at `begin`; the source's numbers; SC_NO_TRIANGLE with at_start */
  sc_vec3 at;                      /* where these triangles touch; zero with at_start */
} sc_step_contact;

#if defined(__cplusplus)
namespace spherechain {
using Scope = sc_scope;
using PartContact = sc_part_contact;
using TriangleContact = sc_triangle_contact;
using SkinPoint = sc_skin_point;
using Penetration = sc_penetration;
using StepContact = sc_step_contact;
}  // namespace spherechain
#endif

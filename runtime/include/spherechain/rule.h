/* SPDX-License-Identifier: MIT */
/* The rule that decides which intersections of two body parts are a fault. */
#pragma once

#include "spherechain/types.h"

/* The class of an intersection, as a person would name it. The first class that applies is taken, SC_CLASS_INSIDE
 * before all. From SC_CLASS_DEEP_FOLD on they are faults. */
SC_ENUM(sc_penetration_class){
    SC_CLASS_REST = 0,        /* the two spots touch in the rest pose, too */
    SC_CLASS_SHELL = 1,       /* another layer of the same place (a garment on the body), or most of it is hidden */
    SC_CLASS_TOUCH = 2,       /* shallow; or up to touch_times deeper, no fold, and little is swallowed */
    SC_CLASS_FOLD = 3,        /* neighbours on the body meet near their joint: an elbow, a groin */
    SC_CLASS_DEEP_FOLD = 4,   /* a fold within one piece of skin that is deep: a fault */
    SC_CLASS_PENETRATION = 5, /* everything else: a fault */
    SC_CLASS_INSIDE = 6,      /* the middle of the one part is inside the other, or a fault goes through it */
};

/* How two body parts hang together. */
SC_ENUM(sc_relation){
    SC_RELATION_APART = 0,
    SC_RELATION_NEAR = 1,       /* one hangs on a part that hangs on the other: a thigh and the abdomen */
    SC_RELATION_SIBLINGS = 2,   /* both hang on the same third part */
    SC_RELATION_JOINED = 3,     /* one hangs on the other, or a part meets itself */
    SC_RELATION_TWO_BODIES = 4, /* they are of two bodies */
};

/* The measurements of two body parts that intersect. Without sc_query.previous the class follows from them
 * alone, so you can store them and classify them again; in the ground it follows from the depth alone. A quick query
 * (sc_query.full = 0) measures only as much as its own rule needs. The measurements of a full one fit any rule if
 * `extent` is known, or if the rule sets touch_depth. */
typedef struct sc_measures {
  float depth;          /* > 0: the way out; the pose's units */
  float volume;         /* of the one part inside the other; negative: not known. The pose's units */
  float contour_length; /* of the line where the parts cross; the pose's units */
  float visible;        /* 0 to 1: the share of that line that can be seen from outside; 1 where it was not looked at */
  float touching;       /* 0 to 1: of the triangle pairs that intersect, the share that touches at rest */
  float facing;         /* -1 to 1: 1 where the sides lie flat on each other */
  float rest_distance;  /* between the two spots at rest, a share of the height; infinite of two bodies */
  float thickness;      /* of the thinner part, there, in the pose's units; negative: not known */
  float extent;         /* depth / thickness * seen length / side of a square with the area of the smaller part;
                           negative: not known, for the class does not depend on it */
  float height, metre;  /* how long the character's height and a metre are in the pose's units */
  sc_relation relation;
  int32_t is_one_piece; /* 1: the two spots are of one piece of skin */
  float swallowed;      /* 0 to 1: of points in the middle of `part` the share that is inside `other`; where that holds
                           most of them, inside any part. 0 while no centre of its spheres is inside */
  int32_t through;      /* 1: a sphere's centre is inside, and its limb comes out again on the other side */
  uint32_t reserved[4]; /* 0 */
} sc_measures;

/* The limits of the classes. Each reason that excuses an intersection (touch, fold, shell) allows a depth. An
 * intersection is a fault where it is deeper than all of these, visible, and not there at rest (docs/concepts.md).
 * "Near at rest" is a share: 1 for spots closer than half of the field's limit, a half at it, 0 from one and a half
 * times it on. Lengths are shares of the character's height, except touch_depth and touch_metres. If a default changes,
 * the version changes. */
typedef struct sc_rule {
  uint32_t version;  /* SC_RULE_VERSION; others are refused */
  float touch_depth; /* 0: the next five fields decide what is a touch. Else depth alone decides: shallower
                        intersections are touches, deeper ones are not. In the pose's units */
  float touch_metres, touch_min, touch_max; /* skins up to this depth only touch: touch_metres, but not less than
                                               touch_min and not more than touch_max */
  float touch_times; /* an intersection up to so many times deeper is still a touch if it is no fold and its
                        sc_measures.extent is below `extent` */
  float extent;      /* touch: sc_measures.extent is below this, see touch_times */
  float at_rest;     /* rest: at least this share of the triangle pairs touches at rest */
  float hidden;      /* shell: less than this share of the line is visible */
  float shell;       /* shell: two pieces of skin whose spots are near at rest, up to that share of loose_depth */
  float fold;        /* fold: a joint lies between the two parts and their spots are near at rest: up to that share of
                        fold_depth or loose_depth. Parts that hang on each other: always */
  float neighbours;  /* fold: the same of any two parts. A joint may lack a bone */
  float fold_depth;  /* within one piece of skin. A deeper fold of spots closer than the limit is a deep fold */
  float loose_depth; /* of two pieces of skin; on parts that hang on each other any depth is allowed */
  float inside;      /* inside: at least this share of the part is swallowed; or it comes out again. From three quarters
                        of it on the allowed depths shrink to 0 */
  float reserved[4]; /* 0; others are refused */
} sc_rule;

#define SC_RULE_VERSION 4

#if defined(__cplusplus)
extern "C" {
#endif

SPHERECHAIN_API sc_rule sc_default_rule(void) SC_NOEXCEPT;

/* A pure function. `rule` null: sc_default_rule(). */
SPHERECHAIN_API sc_penetration_class sc_classify(const sc_rule* rule, const sc_measures* measures) SC_NOEXCEPT;

/* "rest", "shell", "touch", "fold", "deep_fold", "penetration", "inside"; never null. */
SPHERECHAIN_API const char* sc_penetration_class_name(sc_penetration_class kind) SC_NOEXCEPT;

#if defined(__cplusplus)
}
namespace spherechain {
using PenetrationClass = sc_penetration_class;
using Relation = sc_relation;
using Measures = sc_measures;
using Rule = sc_rule;
/* True for the classes that a person sees as a fault. */
inline bool is_fault(PenetrationClass kind) noexcept { return kind >= SC_CLASS_DEEP_FOLD; }
}  // namespace spherechain
#endif

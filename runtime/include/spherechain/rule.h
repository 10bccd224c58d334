/* SPDX-License-Identifier: MIT */
/* Which measurements of two body parts in each other are a fault? */
#pragma once

#include "spherechain/types.h"

/* A contact of two parts as a person would call it: the first class that applies. From SC_CLASS_DEEP_FOLD on it is a
 * fault. */
SC_ENUM(sc_penetration_class){
    SC_CLASS_REST = 0,        /* the two spots touch in the rest pose, too */
    SC_CLASS_SHELL = 1,       /* another layer of the same place (a garment on the body), or most of it is hidden */
    SC_CLASS_TOUCH = 2,       /* hardly deep; or no fold, and little goes in */
    SC_CLASS_FOLD = 3,        /* of neighbours on the body, near the joint: an elbow, a groin */
    SC_CLASS_DEEP_FOLD = 4,   /* a deep fold of one piece of skin */
    SC_CLASS_PENETRATION = 5, /* all else: a fault */
};

/* How two body parts hang together. */
SC_ENUM(sc_relation){
    SC_RELATION_APART = 0,
    SC_RELATION_NEAR = 1,       /* one hangs on a part that hangs on the other: a thigh and the abdomen */
    SC_RELATION_SIBLINGS = 2,   /* both hang on the same third part */
    SC_RELATION_JOINED = 3,     /* one hangs on the other, or a part meets itself */
    SC_RELATION_TWO_BODIES = 4, /* they are of two bodies */
};

/* The measurements of two body parts that intersect. A class follows from them alone, so stored results can be
 * classified again: quick ones by the rule that they were asked with; those of SC_DETAIL_FULL by other rules too, where
 * `swallowed` is known or the rule sets touch_depth. */
typedef struct sc_measures {
  float depth;          /* > 0: the way out; the pose's units */
  float volume;         /* of the one part inside the other; negative: not known. The pose's units */
  float contour_length; /* of the line where the parts cross; the pose's units */
  float visible;        /* 0 to 1: the share of that line that can be seen from outside; 1 where it was not looked at */
  float touching;       /* 0 to 1: the share of that line that touches at rest */
  float facing;         /* -1 to 1: 1 where the sides lie flat on each other */
  float rest_distance;  /* between the two spots at rest, a share of the height; infinite of two bodies */
  float thickness;      /* of the thinner part, there, in the pose's units; negative: not known */
  float swallowed;      /* depth / thickness * visible length / side of a square like the smaller part; negative: not
                           known, for the class does not depend on it */
  float height, metre;  /* how long the character's height and a metre are in the pose's units */
  sc_relation relation;
  int32_t is_one_piece; /* 1: the two spots are of one piece of skin */
} sc_measures;

/* The limits of a class. A fault is what a person would mend; sc_default_rule() was tuned on pictures that people
 * classed (docs/concepts.md). Lengths are shares of the character's height, but for `touch_depth` and `touch_metres`. A
 * change of a default is a new version. */
typedef struct sc_rule {
  uint32_t version;  /* SC_RULE_VERSION; others are refused */
  float touch_depth; /* the pose's units. Below it parts just touch, and what is deeper is no touch; 0: the next five */
  float touch_metres, touch_min, touch_max; /* a touch is less deep than touch_metres metres, but at least touch_min and
                                               at most touch_max */
  float touch_times; /* or up to so many times that, where less goes in than `swallowed` and it is no fold */
  float swallowed;
  float at_rest;     /* more of the line touches at rest: it was modelled so */
  float hidden;      /* less of the line is visible */
  float shell;       /* two spots of two pieces are closer at rest: layers of one place */
  float fold;        /* two spots of parts that are near each other are closer at rest */
  float neighbours;  /* two spots of any parts are closer at rest: a joint may have no bone of its own */
  float fold_facing; /* sides that face each other more fold: a thigh lies flat on the abdomen */
  float deep_fold;   /* a fold of one piece that is deeper is a fault */
} sc_rule;

#define SC_RULE_VERSION 2

#if defined(__cplusplus)
extern "C" {
#endif

SPHERECHAIN_API sc_rule sc_default_rule(void) SC_NOEXCEPT;

/* A pure function. `rule` null: sc_default_rule(). */
SPHERECHAIN_API sc_penetration_class sc_classify(const sc_rule* rule, const sc_measures* measures) SC_NOEXCEPT;

/* "rest", "shell", "touch", "fold", "deep_fold", "penetration"; never null. */
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

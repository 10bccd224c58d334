// SPDX-License-Identifier: MIT
// The class of two body parts in each other: which measurements make a fault. A pure function of the numbers below.
#pragma once

#include "spherechain/penetrations.h"

namespace spherechain {

// Lengths are shares of the character's height, except where they are in metres.
struct Rule {
  double touch_depth = 0;  // in the pose's units, a depth below it is a touch; 0: the next three decide
  double touch_metres = 0.003, touch_min = 0.0019, touch_max = 0.0066;  // files without a unit make giants and dwarfs
  double touch_most = 10;                                               // no touch is deeper than so many times that
  double swallowed = 0.25;                                              // a touch goes in less, see Measures
  double at_rest = 0.5;       // more of the contour touches at rest: so it was modelled
  double hidden = 0.3;        // less of the contour is visible
  double shell = 0.035;       // two spots of two pieces are closer at rest: they are layers of one place
  double fold = 0.11;         // two spots of parts that are near each other are closer at rest
  double neighbours = 0.055;  // two spots of any parts are closer at rest: a joint may have no bone of its own
  double fold_facing = 0.2;   // more: a thigh lies flat on the abdomen
  double deep_fold = 0.045;   // a fold of one piece that is deeper is a fault
};

enum class Relation {
  kApart,
  kNear,      // one hangs on a part that hangs on the other: a thigh and the abdomen
  kSiblings,  // both hang on the same third part
  kJoined,    // one hangs on the other, or a part meets itself
};

struct Measures {
  double height, metre;  // how long they are in the pose's units
  Relation relation;
  bool are_two_bodies, is_one_piece;  // is_one_piece: of skin
  double rest_distance;               // between the two spots; a share of the height
  double touching;                    // share of the contour that touches at rest
  double facing;                      // 1 where the sides lie flat on each other
  double depth = 0;                   // in the pose's units
  double visible = 1;                 // share of the contour that can be seen
  double swallowed =
      0;  // depth / thickness of the thinner part * seen contour / side of a square like the smaller part
};

// The rule of a job: its touch_depth may be 0.
inline Rule rule_of(float touch_depth) {
  Rule out;
  out.touch_depth = double{touch_depth};
  return out;
}

// The depth below which two skins just touch.
double touch_depth_of(const Rule& rule, double metre, double height);
bool is_fold(const Rule& rule, const Measures& of);
// Does the class depend on `swallowed`, which is the dearest to measure?
bool depends_on_swallowed(const Rule& rule, const Measures& of);
PenetrationClass classify(const Rule& rule, const Measures& of);

}  // namespace spherechain

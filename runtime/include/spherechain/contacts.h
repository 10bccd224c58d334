// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "spherechain/abi.h"
#include "spherechain/asset.h"
#include "spherechain/filter.h"
#include "spherechain/status.h"
#include "spherechain/types.h"

namespace spherechain {

// A sphere's surrounding region: the source triangles asset.triangles()[first] to [first + count - 1].
struct TriangleRange {
  std::uint32_t first, count;
};

// How two spheres touch. Lengths in the spheres' units.
struct Contact {
  Pair pair;
  float depth;     // ra + rb - d: how far one sphere must move along the normal to part them
  float severity;  // volume that is in both balls, units cubed: the smaller ball's where it is inside the other
  Vec3 normal;     // from a's centre to b's, unit length; (1, 0, 0) where the centres are less than 1e-19 apart
  Vec3 point;      // on the line of centres, the middle of what of it is in both balls
  TriangleRange triangles_a, triangles_b;
};

// From pairs to what a game does about them: push apart, weigh, look at the triangles.
//
// The arithmetic is fixed, in single precision without contraction, so that every machine gives the same figures. With
// e = cb - ca, d = sqrt((ex*ex + ey*ey) + ez*ez), s = ra + rb, q = ra - rb:
//   depth     s - d
//   normal    e / d
//   severity  0 where depth <= 0; 4.18879f * (r*r*r), r the smaller radius, where d <= |q|; else
//             (0.261799f * (depth*depth)) * ((d*d + (2*d)*s) - (3*q)*q) / d
//   point     ca + t * normal,  t = 0.5f * (max(-ra, d - rb) + min(ra, d + rb))
//
// Near pairs are measured like all others, by their full radii. Pairs that do not touch have no depth above 0 and no
// severity; spheres that are not finite give figures that are not, and one padded to below 0 a depth and a severity
// that are no numbers. A radius below 0 without padding, which no refit gives, goes into the formulas as it is.
//
// Fill in the fields and call run(). Allocates nothing, takes no lock; jobs with other outputs may run at the same
// time.
struct SPHERECHAIN_API ContactJob {
  const Asset* asset = nullptr;    // open
  Span<const Sphere> spheres;      // at least asset->spheres().size: those the pairs were found among
  Span<const Pair> pairs;          // from DetectJob, or any a < b
  const Filter* filter = nullptr;  // null, or the one the pairs were found with: its padding counts
  Span<Contact> contacts;          // out: one a pair, in their order; may be empty, for the deepest alone

  // Out.
  std::size_t contact_count = 0;  // as many as pairs, also where `contacts` was too small
  std::size_t deepest = 0;        // the pair of the greatest depth above 0, the first of several; contact_count: none

  // kOk; kOverflow where `contacts` was not empty and too small: the first are written; kNullArgument, kNotOpen,
  // kTooFewSpheres, kBadFilter, kBadArgument (a pair of spheres that do not exist, or a >= b), kMisaligned,
  // kSharedMemory: nothing is written, the counts keep their values.
  Status run() noexcept;
};

}  // namespace spherechain

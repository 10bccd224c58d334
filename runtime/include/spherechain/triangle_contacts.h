// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "spherechain/abi.h"
#include "spherechain/asset.h"
#include "spherechain/filter.h"
#include "spherechain/refit_bones.h"
#include "spherechain/simd.h"
#include "spherechain/status.h"
#include "spherechain/surface.h"
#include "spherechain/types.h"

namespace spherechain {

// Do two triangles have a point in common? Exactly, for all finite floats: touching counts, and so does overlap in one
// plane. A degenerate triangle, its corners on one line, intersects nothing; neither does one that is not finite. Needs
// the processor's default rounding, to nearest; where it takes subnormal floats as zero, so does this.
SPHERECHAIN_API bool triangles_intersect(const Vec3 (&a)[3], const Vec3 (&b)[3]) noexcept;

// What two triangles have in common, rounded.
struct TriangleOverlap {
  Vec3 from, to;  // the segment; of triangles in one plane the longest piece of an edge that lies in the other triangle
  Vec3 normal;    // unit length, of one of the two planes
  float depth;    // moving b so far along the normal parts the two: the least of such moves along the two normals; >= 0
};

// Of triangles that intersect.
SPHERECHAIN_API TriangleOverlap overlap_triangles(const Vec3 (&a)[3], const Vec3 (&b)[3]) noexcept;

// Two triangles that intersect, and where.
struct TriangleContact {
  TrianglePair triangles;
  TriangleOverlap overlap;

  friend constexpr bool operator<(const TriangleContact& l, const TriangleContact& r) {
    return l.triangles < r.triangles;
  }
};

// What the surrounding regions of two spheres have in common, or one's region with itself.
struct SphereContact {
  Pair spheres;             // a < b; a = b within one region
  std::uint32_t count;      // pairs of triangles; >= 1
  TriangleContact deepest;  // of those the one of the greatest depth, of several the least pair

  friend constexpr bool operator<(const SphereContact& l, const SphereContact& r) { return l.spheres < r.spheres; }
};

// Which triangles a TriangleContactJob pairs, by the spheres whose surrounding regions they are of.
enum class ContactScope : std::uint8_t {
  kApart = 0,       // of two spheres that are not ignored: what touches that is no neighbour on the body
  kNeighbours = 1,  // of one sphere, and of two that are ignored: folds at elbow, knee, armpit and fingers
  kAll = 2,
};

// Scratch memory of one TriangleContactJob at a time, owned by the caller. Keeps nothing from one run to the next.
struct SPHERECHAIN_API TriangleContactContext {
  Span<std::uint64_t> words;

  // Words needed for `asset`; 0 where it has no surface.
  static std::size_t words_needed(const Asset& asset) noexcept;
};

// Which triangles of the skin intersect: all of them, none else, exactly. Spheres and radii play no part in it: the
// job goes from what bounds surrounding regions to boxes of leaves to triangles, and decides in exact arithmetic. With
// bones, where all morph weights are 0, a region is bounded by the hull of some points (Surface::outlines), else by a
// box.
//
// Left out are triangles of spheres outside the scope, by the pairs that the asset or the filter ignores, and of
// spheres that the filter disables (its padding is of no effect); triangles that share a position at rest, which are
// neighbours on the skin; and those that intersect in the rest pose (Surface::rest_contacts). Neighbours' contacts take
// forty times as long (docs/performance.md), for all that lies side by side has to be told apart.
//
// The positions are what the caller gives; or, where `positions` is null, what the job skins from bones, and then only
// of the leaves that could touch another. Who gives positions and bones spares the job reading all positions: leaves
// are bounded by the bones. Then each position must be where its weights of the bones put it, to roundings of single
// precision in whatever order: within (2 N + 8) u Q of there, in cover.h's words, but N of its leaf alone. What is not
// (cloth, corrected shapes, weights of fewer bits) may touch unnoticed; what is found is true of the positions even so.
// Any position that is not finite makes its triangles intersect nothing; matrices or weights that are not finite bound
// nothing, so contacts from them may be missing, and differ between targets. Else the contacts are the same on every
// target.
//
// What it costs goes with the triangles that come close to others. Those that a pose shrinks to points, as a palette of
// zeros does, are left out early; a pose millions of heights off, where floats hardly tell vertices apart, has most
// triangles touch, and may take a second.
//
// Fill in the fields and call run(). Allocates nothing, takes no lock; jobs with other outputs and contexts may run at
// the same time.
struct SPHERECHAIN_API TriangleContactJob {
  const Asset* asset = nullptr;      // open, with a surface
  const float* positions = nullptr;  // deformed vertices in the source's order, x y z after another; or null
  std::size_t vertex_count = 0;      // at least asset->info().source_vertex_count
  std::size_t stride = 12;           // bytes from one vertex to the next; a multiple of 4, at least 12
  BoneMatrices bones;                // as in RefitBonesJob; beside positions they may be null
  Span<const float> morph_weights;   // with bones: as in RefitBonesJob
  Target target = Target::kBest;
  const Filter* filter = nullptr;             // null: the asset's ignored pairs
  ContactScope scope = ContactScope::kApart;  // neighbours' contacts are a class of their own
  TriangleContactContext* context = nullptr;  // required
  Span<TrianglePair> pairs;                   // out: source triangle numbers, sorted, each once; may be empty
  Span<TriangleContact> contacts;             // out: the same with where they intersect; may be empty
  Span<SphereContact> sphere_contacts;        // out: sorted by their spheres, each pair once; may be empty

  // Out. Counts are what there is, also where a buffer was too small for it.
  std::size_t pair_count = 0;  // of triangles
  std::size_t sphere_contact_count = 0;

  // kOk; kOverflow where a buffer was not empty and too small (the first entries of the sorted list are written, the
  // counts say what is needed); kNullArgument, kNotOpen, kNotInAsset, kTooFewVertices, kBadStride, kTooFewBones,
  // kTooFewMorphs, kContextTooSmall, kBadArgument, kUnsupportedTarget, kBadFilter, kMisaligned, kSharedMemory (what is
  // written overlaps anything else): nothing is written, the counts keep their values.
  Status run() noexcept;
};

}  // namespace spherechain

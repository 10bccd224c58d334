// SPDX-License-Identifier: MIT
// What the stages of a TriangleContactJob, a DetectSkinJob and a ConfirmJob hand to each other.
#pragma once

#include <cstddef>
#include <cstdint>

#include "cover_kernel.h"
#include "exact_triangles.h"
#include "skin.h"
#include "spherechain/simd.h"
#include "spherechain/surface.h"
#include "spherechain/types.h"

namespace spherechain {

// Vectors of any target may be read, and written, this far past the end of what is there.
inline constexpr std::size_t kContactPadding = 16;

// Along which a leaf's vertices are spanned: the axes x, y and z and the diagonals of their planes, x + y, y + z, z +
// x, x - y, y - z and z - x. Most leaves whose boxes touch are apart along a diagonal. And room for a vector.
inline constexpr std::size_t kDirections = 9, kSpanLanes = 16;

// Of a bone's matrix by columns of four.
inline constexpr std::size_t kColumnFloats = 16;

// Boxes coordinate by coordinate.
struct BoxColumns {
  float* low[3];
  float* high[3];
};

// Bare arrays, as in SkinInputs.
struct ContactScene {
  const Surface* surface = nullptr;
  std::size_t sphere_count = 0;
  Span<const std::uint64_t> ignored, disabled;  // the latter may be empty
  bool apart = true, neighbours = false;        // which of them to pair: see ContactScope
  const float* positions = nullptr;             // the source's; null: from bones
  bool has_balls = false;                       // bounded by bones
  bool has_outlines = false;                    // and sphere by sphere first: leaves only as needed
  std::size_t stride = 0;                       // floats
  SkinInputs skin{};                            // from bones
  CoverInputs cover{};                          // likewise
  // Scratch memory.
  BoxColumns spheres, leaves;
  std::uint32_t* first_leaf = nullptr;  // a sphere's, and the end
  std::uint8_t* is_loaded = nullptr;    // a leaf's: are its vertices and its span below?
  std::uint8_t* is_bounded = nullptr;   // a sphere's: are its leaves' boxes there, and, of a ConfirmJob, its own?
  float* spans = nullptr;               // of leaf after leaf: the least in each direction, then the greatest
  float* slots = nullptr;               // x, y, z of a leaf's vertices, of leaf after leaf
  float* ball_columns[4] = {};          // from bones: around the leaves, by coordinates, the radius last
  BoneSize* bone_sizes = nullptr;       // from bones
  // With outlines.
  std::uint32_t* group_terms = nullptr;  // where in the cover's terms a group of leaves starts
  std::uint8_t* is_group_bounded = nullptr;
  float* columns = nullptr;          // of bone after bone four of four floats, the fourth the translation
  float* outlines = nullptr;         // of sphere after sphere the points' x, y and z in the pose
  float* outline_margins = nullptr;  // how far from the points' hull the sphere's vertices are at most
};

// Where triangles that intersect go. In a file of its own, for kernels must not call templates of the standard library.
class ContactCollector;

// Two triangles of two leaves whose boxes touch, and whose planes may cross: the decision.
struct Candidate {
  std::size_t leaf_a, leaf_b;
  std::size_t triangle_a, triangle_b;  // in Asset::triangles()
  TriangleCorners a, b;
  bool meets;  // is known to: no more to decide
};
void begin_spheres(ContactCollector& collector, Pair spheres);
bool decide(ContactCollector& collector, const Candidate& candidate);  // is it a contact?

// Hands all candidates that there are, and a few more, to the collector.
void find_candidates(Target resolved, const ContactScene& scene, ContactCollector& collector);

// The same, but of each two spheres no more once one candidate is a contact.
void find_spheres(Target resolved, const ContactScene& scene, ContactCollector& collector);

// Bounds all leaves and spheres.
void bound_leaves(Target resolved, const ContactScene& scene);

// Is there a contact between the regions of two spheres? From positions bounds what is not bounded yet; by bones all
// is.
bool skins_touch(Target resolved, const ContactScene& scene, Pair spheres, ContactCollector& collector);

}  // namespace spherechain

// SPDX-License-Identifier: MIT
// Where two body parts cross: the segments in which their triangles meet, and what they say about the way out.
#pragma once

#include "runtime/src/depth/posed_skin.h"
#include "spherechain/contacts.h"

namespace spherechain {

// Two triangles that meet, a of the first body part, or of the first body.
struct Segment3 {
  std::uint32_t a, b;  // places in their bodies' Surface::triangles
  Double3 from, to;    // in the direction of normal a x normal b: around what lies inside, seen from where it came
  Double3 normal_a, normal_b;  // of unit length; zero of degenerate triangles
  double length;
};

struct Contour {
  Span<Segment3> segments;
  Double3 center{};  // of the segments, by length
  double length = 0;
  bool is_closed = false;    // its lines have no ends
  Double3 area{};            // the area that it encloses, as a vector: part b comes out along it
  Double3 largest_area{};    // of the longest of its connected pieces
  Double3 normals{};         // mean of normal a - normal b
  double facing = 0;         // mean of -(normal a . normal b): 1 where the sides lie flat on each other
  double rest_distance = 0;  // median distance of the triangles that meet, at rest; of two bodies infinite
  double touching = 0;       // share of them that are closer than `kTouching` of `height` at rest
  bool is_one_piece = true;  // of one body's skin
};

// Words of scratch memory, and what it is for.
struct ContourScratch {
  std::uint32_t* patch = nullptr;         // a segment's, while they are joined
  std::uint32_t* last_segment = nullptr;  // of a triangle; kNoPlace between calls
  double* lengths = nullptr;              // of a patch

  void take(WordMemory& memory, std::size_t contact_count, std::size_t triangle_count);
  void clear(std::size_t triangle_count);
};

Contour contour_of(const Skins& skins, Span<Segment3> segments, double height, ContourScratch& scratch);

}  // namespace spherechain

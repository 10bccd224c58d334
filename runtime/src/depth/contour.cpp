// SPDX-License-Identifier: MIT
#include "runtime/src/depth/contour.h"

#include <algorithm>

#include "runtime/src/depth/distance.h"

namespace spherechain {
namespace {

constexpr double kOpen = 1e-3;        // of its length: a contour whose ends are farther apart is open
constexpr double kTouching = 0.001;   // of the height
constexpr std::size_t kSampled = 48;  // pairs whose distance at rest is measured

std::uint32_t first_of(std::uint32_t* patch, std::uint32_t i) {
  while (patch[i] != i) {
    i = patch[i] = patch[patch[i]];
  }
  return i;
}

// Segments that share a triangle follow one another on a contour.
void join_patches(const Skins& skins, const Span<Segment3>& segments, ContourScratch& scratch) {
  const std::uint32_t first_of_b = skins.first_triangle_of_b();
  for (std::uint32_t i = 0; i < segments.size; ++i) {
    scratch.patch[i] = i;
    for (const std::uint32_t triangle : {segments[i].a, first_of_b + segments[i].b}) {
      std::uint32_t& last = scratch.last_segment[triangle];
      if (last != kNoPlace) {
        const std::uint32_t p = first_of(scratch.patch, i), q = first_of(scratch.patch, last);
        scratch.patch[std::max(p, q)] = std::min(p, q);
      }
      last = i;
    }
  }
  for (const Segment3& segment : segments) {
    scratch.last_segment[segment.a] = scratch.last_segment[first_of_b + segment.b] = kNoPlace;
  }
}

void measure_rest(const Skins& skins, double height, ContourScratch& scratch, Contour& out) {
  if (!skins.are_one()) {
    out.rest_distance = HUGE_VAL;
    out.is_one_piece = false;
    return;
  }
  const PosedSkin& skin = skins.a;
  const std::size_t step = (out.segments.size + kSampled - 1) / kSampled;
  double* const distances = scratch.lengths;
  std::size_t count = 0, touching = 0;
  for (std::size_t i = 0; i < out.segments.size; i += step) {
    const Segment3& segment = out.segments[i];
    const double distance = distance_of(skin.rest_corners(segment.a), skin.rest_corners(segment.b));
    touching += distance < kTouching * height ? 1 : 0;
    distances[count++] = distance;
    out.is_one_piece = out.is_one_piece && skin.piece(segment.a) == skin.piece(segment.b);
  }
  // By an order of its own: a shared library would export the standard one's instances.
  std::nth_element(distances, distances + count / 2, distances + count, [](double l, double r) { return l < r; });
  out.rest_distance = distances[count / 2];
  out.touching = static_cast<double>(touching) / static_cast<double>(count);
}

}  // namespace

void ContourScratch::take(WordMemory& memory, std::size_t contact_count, std::size_t triangle_count) {
  memory.take(patch, contact_count);
  memory.take(last_segment, triangle_count);
  memory.take(lengths, contact_count);
}

void ContourScratch::clear(std::size_t triangle_count) {
  std::fill(last_segment, last_segment + triangle_count, kNoPlace);
}

Contour contour_of(const Skins& skins, Span<Segment3> segments, double height, ContourScratch& scratch) {
  Contour out;
  out.segments = segments;
  Double3 middle{0, 0, 0}, gap{0, 0, 0};
  double facing = 0;
  for (const Segment3& s : segments) {
    out.length += s.length;
    middle = middle + (0.5 * s.length) * (s.from + s.to);
    gap = gap + (s.to - s.from);
    out.normals = out.normals + s.length * (s.normal_a - s.normal_b);
    facing -= s.length * dot(s.normal_a, s.normal_b);
  }
  out.center = out.length > 0 ? (1 / out.length) * middle : segments[0].from;
  out.facing = out.length > 0 ? facing / out.length : 0;
  out.is_closed = length(gap) <= kOpen * out.length && out.length > 0;
  join_patches(skins, segments, scratch);
  std::fill(scratch.lengths, scratch.lengths + segments.size, 0.0);
  for (std::uint32_t i = 0; i < segments.size; ++i) {
    scratch.lengths[first_of(scratch.patch, i)] += segments[i].length;
  }
  const auto longest =
      static_cast<std::uint32_t>(std::max_element(scratch.lengths, scratch.lengths + segments.size) - scratch.lengths);
  for (std::uint32_t i = 0; i < segments.size; ++i) {
    const Segment3& s = segments[i];
    const Double3 share = 0.5 * cross(s.from - out.center, s.to - out.center);
    out.area = out.area + share;
    if (first_of(scratch.patch, i) == longest) {
      out.largest_area = out.largest_area + share;
    }
  }
  measure_rest(skins, height, scratch, out);
  return out;
}

}  // namespace spherechain

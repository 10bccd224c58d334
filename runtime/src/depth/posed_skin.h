// SPDX-License-Identifier: MIT
// The skin in a pose, and at rest, triangle by triangle.
#pragma once

#include "runtime/src/base/double3.h"
#include "runtime/src/pose/pose.h"
#include "runtime/src/skin/skin_table.h"

namespace spherechain {

struct Corners {
  Double3 p[3];
};

// Twice its area long.
inline Double3 normal_of(const Corners& t) { return cross(t.p[1] - t.p[0], t.p[2] - t.p[0]); }

// A triangle is known by its place in Surface::triangles.
struct PosedSkin {
  const Surface* surface = nullptr;
  float* positions = nullptr;  // x, y, z of each of the surface's vertices

  float *low[3] = {}, *high[3] = {};              // of a cluster's box
  static constexpr std::size_t kGroup = 8;        // clusters that follow one another
  float *group_low[3] = {}, *group_high[3] = {};  // of the box around a group
  double handedness = 1;                          // -1: the pose mirrors the skin, and its triangles turn the other way

  Span<std::uint32_t> clusters;        // that stand in the pose: vertices and boxes of others are not known
  std::uint32_t* is_listed = nullptr;  // among them, of each cluster

  void take(WordMemory& memory, std::size_t vertex_count, std::size_t cluster_count);
  // Puts all of the skin where the pose's vertices are, or where its bones have it.
  void fill(const Pose& pose, Target resolved);
  // The skin of those parts alone, a bit each; boxes around groups are not known.
  void fill(const Pose& pose, Target resolved, const std::uint64_t (&parts)[4]);

  Corners corners(std::uint32_t triangle) const { return corners_in(positions, triangle); }
  Corners rest_corners(std::uint32_t triangle) const { return corners_in(surface->rest_positions.data, triangle); }
  // Nobody sees it from outside at rest: it lies below another layer.
  bool is_covered(std::uint32_t triangle) const { return spherechain::is_covered(*surface, triangle); }
  std::uint32_t piece(std::uint32_t triangle) const {
    return surface->pieces[surface->triangle_vertices[3 * std::size_t{triangle}]];
  }

 private:
  void fill_clusters(const Pose& pose, Target resolved);
  std::size_t asked_step() const;
  double find_handedness() const;
  Corners corners_in(const float* all, std::uint32_t triangle) const {
    const std::uint32_t* const v = surface->triangle_vertices.data + 3 * std::size_t{triangle};
    Corners out;
    for (std::size_t i = 0; i < 3; ++i) {
      const float* const p = all + 3 * std::size_t{v[i]};
      out.p[i] = {double{p[0]}, double{p[1]}, double{p[2]}};
    }
    return out;
  }
};

// The two skins of a contact: one body's own, or two bodies'. Places and vertices are those of the body's own surface.
struct Skins {
  const PosedSkin &a, &b;

  bool are_one() const { return &a == &b; }
  // Where numbers of both are put into one table.
  std::uint32_t first_vertex_of_b() const { return are_one() ? 0 : static_cast<std::uint32_t>(size(a)); }
  std::uint32_t first_triangle_of_b() const {
    return are_one() ? 0 : static_cast<std::uint32_t>(a.surface->triangles.size);
  }
  std::size_t vertex_count() const { return size(a) + (are_one() ? 0 : size(b)); }
  std::size_t triangle_count() const { return a.surface->triangles.size + (are_one() ? 0 : b.surface->triangles.size); }

 private:
  static std::size_t size(const PosedSkin& skin) { return skin.surface->source_vertices.size; }
};

}  // namespace spherechain

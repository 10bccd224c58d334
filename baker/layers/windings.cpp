// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/layers/windings.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

#include "runtime/src/base/double3.h"
#include "runtime/src/skin/core_point.h"
#include "runtime/src/skin/windings.h"
#include "runtime/src/triangles/crossing.h"

namespace spherechain {
namespace {

// A triangle's corners by their places at rest, ascending.
struct Welds {
  std::uint32_t low, middle, high;

  Welds(const Surface& surface, std::uint32_t triangle) {
    const std::uint32_t* const v = surface.triangle_vertices.data + 3 * std::size_t{triangle};
    const std::uint32_t a = surface.welds[v[0]], b = surface.welds[v[1]], c = surface.welds[v[2]];
    low = std::min(std::min(a, b), c);
    high = std::max(std::max(a, b), c);
    middle = std::max(std::min(a, b), std::min(std::max(a, b), c));
  }
  bool operator==(const Welds& other) const { return low == other.low && middle == other.middle && high == other.high; }
};

void corners_at_rest(const Surface& surface, std::size_t triangle, float (&out)[3][3]) {
  for (std::size_t k = 0; k < 3; ++k) {
    std::memcpy(out[k], surface.rest_positions.data + 3 * std::size_t{surface.triangle_vertices[3 * triangle + k]},
                sizeof out[k]);
  }
}

// Some triangles have the same corners, as front and back of a double-sided skin: the first in the source counts.
void drop_doubles(const Surface& surface) {
  std::vector<std::uint32_t> first_of_corner(surface.rest_positions.size / 3, kNoPlace), next(surface.triangles.size);
  for (std::uint32_t t = 0; t < surface.triangles.size; ++t) {
    const Welds own(surface, t);
    std::uint32_t& first = first_of_corner[own.low];
    for (std::uint32_t other = first; other != kNoPlace; other = next[other]) {
      if (facing(surface, other) != 0 && own == Welds(surface, other)) {
        surface.layers[surface.triangles[t] > surface.triangles[other] ? t : other] |= kIsDouble;
        break;
      }
    }
    next[t] = std::exchange(first, t);
  }
}

struct PieceSum {
  double middle[3], area, volume;
};

// A piece that encloses a negative volume, seen from its middle, is inside out: its triangles count the other way
// round.
void turn_pieces(const Surface& surface) {
  std::vector<PieceSum> pieces(surface.pieces.size);
  const auto for_all = [&](const auto& visit) {
    for (std::size_t t = 0; t < surface.triangles.size; ++t) {
      float at[3][3];
      corners_at_rest(surface, t, at);
      Double3 p[3];
      for (std::size_t k = 0; k < 3; ++k) {
        p[k] = {double{at[k][0]}, double{at[k][1]}, double{at[k][2]}};
      }
      visit(t, pieces[surface.pieces[surface.triangle_vertices[3 * t]]], p, cross(p[1] - p[0], p[2] - p[0]));
    }
  };
  for_all([&](std::size_t, PieceSum& piece, const Double3(&p)[3], const Double3& normal) {
    const double area = length(normal);
    const Double3 middle = p[0] + (p[1] + p[2]);
    piece.middle[0] += area * middle.x / 3;
    piece.middle[1] += area * middle.y / 3;
    piece.middle[2] += area * middle.z / 3;
    piece.area += area;
  });
  for_all([&](std::size_t t, PieceSum& piece, const Double3(&p)[3], const Double3& normal) {
    if (facing(surface, t) != 0 && piece.area > 0) {
      piece.volume +=
          dot(normal, p[0]) -
          (normal.x * piece.middle[0] + normal.y * piece.middle[1] + normal.z * piece.middle[2]) / piece.area;
    }
  });
  for (std::size_t t = 0; t < surface.triangles.size; ++t) {
    if (pieces[surface.pieces[surface.triangle_vertices[3 * t]]].volume < 0) {
      surface.layers[t] |= kIsInsideOut;
    }
  }
}

// Does the line meet a cluster's box at rest?
bool meets(const Surface& surface, std::size_t cluster, const float (&from)[3], std::size_t axis) {
  const BoxLanes& boxes = surface.boxes[cluster / 8];
  const std::size_t k = cluster % 8;
  const float middle[3] = {boxes.x[k], boxes.y[k], boxes.z[k]};
  const float half[3] = {boxes.half_x[k], boxes.half_y[k], boxes.half_z[k]};
  for (const std::size_t other : {(axis + 1) % 3, (axis + 2) % 3}) {
    const double rounding = 1e-6 * (std::abs(double{middle[other]}) + double{half[other]});
    if (std::abs(double{from[other]} - double{middle[other]}) > double{half[other]} + rounding) {
      return false;
    }
  }
  return true;
}

// Does a triangle lie all on one side of the line, along that axis?
bool is_beside(const Surface& surface, std::size_t triangle, float from, std::size_t axis) {
  const std::uint32_t* const v = surface.triangle_vertices.data + 3 * triangle;
  const float* const at = surface.rest_positions.data + axis;
  const float p = at[3 * std::size_t{v[0]}], q = at[3 * std::size_t{v[1]}], r = at[3 * std::size_t{v[2]}];
  return (p > from && q > from && r > from) || (p < from && q < from && r < from);
}

int winding_at_rest(const Surface& surface, const float (&from)[3], std::size_t axis) {
  int out = 0;
  for (std::size_t c = 0; c < surface.clusters.size; ++c) {
    if (!meets(surface, c, from, axis)) {
      continue;
    }
    const Cluster& cluster = surface.clusters[c];
    for (std::size_t t = cluster.first_triangle; t < cluster.first_triangle + std::size_t{cluster.triangle_count};
         ++t) {
      if (is_beside(surface, t, from[(axis + 1) % 3], (axis + 1) % 3) ||
          is_beside(surface, t, from[(axis + 2) % 3], (axis + 2) % 3)) {
        continue;
      }
      float corners[3][3];
      corners_at_rest(surface, t, corners);
      const Crossing crossing = cross_line(corners, from, axis);
      out += crossing.height > 0 ? crossing.side * facing(surface, t) : 0;
    }
  }
  return std::max(-127, std::min(out, 127));
}

// Around a point at rest, along each axis; or along one, where the skin is closed there.
void find_windings_of(const Surface& surface, const Vec3& point, bool one_axis, std::int8_t* out) {
  const float from[3] = {point.x, point.y, point.z};
  for (std::size_t axis = one_axis ? kShortAxis : 0; axis < 3; ++axis) {
    out[axis] = static_cast<std::int8_t>(winding_at_rest(surface, from, axis));
  }
  if (one_axis) {
    out[0] = out[1] = out[kShortAxis];
  }
}

// Spreads core points over a part's skin by its area.
void find_core(const AssetView& asset, const Surface& surface, std::size_t part, baker::Windings& out) {
  const Span<const TriangleRun> runs = runs_of(surface, part);
  const auto for_triangles = [&](const auto& visit) {
    for (const TriangleRun& run : runs) {
      for (std::uint32_t t = run.first; t < run.first + run.count; ++t) {
        float at[3][3];
        corners_at_rest(surface, t, at);
        Double3 p[3];
        for (std::size_t k = 0; k < 3; ++k) p[k] = {double{at[k][0]}, double{at[k][1]}, double{at[k][2]}};
        visit(t, at, length(cross(p[1] - p[0], p[2] - p[0])));
      }
    }
  };
  double all = 0, before = 0;
  for_triangles([&](std::uint32_t, const float(&)[3][3], double area) { all += area; });
  std::size_t k = 0;
  for_triangles([&](std::uint32_t t, const float(&at)[3][3], double area) {
    before += area;
    for (; k < kCorePoints && before * double{kCorePoints} > (static_cast<double>(k) + 0.5) * all; ++k) {
      const std::size_t place = kCorePoints * part + k;
      std::int8_t* const windings = out.of_cores.data() + 3 * place;
      const std::size_t sphere = surface.triangle_spheres[t];
      const bool one_axis = is_closed(out.of_spheres.data() + 3 * sphere);
      find_windings_of(surface, core_point(at, asset.spheres()[sphere].center, k), one_axis, windings);
      if (middle_of(windings) > 0) out.core_triangles[place] = t + 1;
    }
  });
}

}  // namespace

namespace baker {

void find_facings(const Surface& surface) {
  drop_doubles(surface);
  turn_pieces(surface);
}

Windings find_windings(const AssetView& asset, const Surface& surface) {
  const std::size_t cores = kCorePoints * asset.part_count();
  Windings out{std::vector<std::int8_t>(3 * asset.spheres().size, 0), std::vector<std::uint32_t>(cores, 0),
               std::vector<std::int8_t>(3 * cores, 0)};
  for (std::size_t s = 0; s < asset.spheres().size; ++s) {
    find_windings_of(surface, asset.spheres()[s].center, false, out.of_spheres.data() + 3 * s);
  }
  for (std::size_t part = 0; part < asset.part_count(); ++part) find_core(asset, surface, part, out);
  return out;
}

}  // namespace baker
}  // namespace spherechain

// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/layers/covered.h"

#include <algorithm>
#include <cfloat>
#include <cmath>

#include "runtime/src/base/double3.h"

namespace spherechain {
namespace {

constexpr double kClearance = 3e-5;  // of the skin's size: where a look starts above a triangle
constexpr float kWider = 0x1p-20F;   // of a box's middle, for roundings
// Looks along the normal, and 60 degrees off it all around.
constexpr int kTurns = 8;
constexpr double kOff = 0.5, kAside = 0.8660254037844386, kDiagonal = 0.7071067811865476;
constexpr double kTurn[kTurns][2] = {{1, 0},  {kDiagonal, kDiagonal},   {0, 1},  {-kDiagonal, kDiagonal},
                                     {-1, 0}, {-kDiagonal, -kDiagonal}, {0, -1}, {kDiagonal, -kDiagonal}};

constexpr std::size_t kCellsMax = 256;  // runs of groups of clusters, looked at first
constexpr std::size_t kRun = 8;         // triangles of a cluster that follow one another, of which one is looked from
constexpr std::uint32_t kMixed = 0xFFFFFFFF;

class Looker {
 public:
  explicit Looker(const Surface& surface) : surface_(surface) {
    Double3 low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    for (std::size_t c = 0; c < surface.clusters.size; ++c) {
      const ClusterBox box = box_of(c);
      for (double Double3::*axis : {&Double3::x, &Double3::y, &Double3::z}) {
        low.*axis = std::min(low.*axis, box.low.*axis);
        high.*axis = std::max(high.*axis, box.high.*axis);
      }
    }
    clearance_ = kClearance * length(high - low);
    groups_per_cell_ = surface.boxes.size / kCellsMax + 1;
    for (std::size_t first = 0; first < surface.boxes.size; first += groups_per_cell_) {
      cells_[cell_count_++] = cell_of(kClusterLanes * first, kClusterLanes * (first + groups_per_cell_));
    }
  }

  bool is_covered(std::size_t triangle) {
    own_ = piece_of(triangle);
    Double3 p[3];
    corners(triangle, p);
    Double3 normal = cross(p[1] - p[0], p[2] - p[0]), along = p[1] - p[0];
    if (!normalize(normal) || !normalize(along)) {
      return false;
    }
    const Double3 aside = cross(normal, along);
    const Double3 from = (1.0 / 3) * (p[0] + (p[1] + p[2])) + clearance_ * normal;
    if (!ends_at_skin(from, normal)) {
      return false;
    }
    for (const auto& turn : kTurn) {
      const Double3 level = turn[0] * along + turn[1] * aside;
      if (!ends_at_skin(from, kOff * normal + kAside * level)) {
        return false;
      }
    }
    return true;
  }

 private:
  struct ClusterBox {
    Double3 low, high;
  };

  ClusterBox box_of(std::size_t cluster) const {
    const BoxLanes& lanes = surface_.boxes[cluster / kClusterLanes];
    const std::size_t i = cluster % kClusterLanes;
    const Double3 center{double{lanes.x[i]}, double{lanes.y[i]}, double{lanes.z[i]}};
    const Double3 half{double{lanes.half_x[i]}, double{lanes.half_y[i]}, double{lanes.half_z[i]}};
    return {center - half, center + half};
  }

  struct Cell {
    double low[3], high[3];
    std::uint32_t piece;  // of all of its triangles; kMixed where there are several
  };

  Cell cell_of(std::size_t first, std::size_t end) const {
    Cell out{{HUGE_VAL, HUGE_VAL, HUGE_VAL},
             {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL},
             piece_of(surface_.clusters[first].first_triangle)};
    for (std::size_t c = first; c < std::min(end, surface_.clusters.size); ++c) {
      const ClusterBox box = box_of(c);
      const double low[3] = {box.low.x, box.low.y, box.low.z}, high[3] = {box.high.x, box.high.y, box.high.z};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double wider = double{kWider} * (std::abs(low[axis]) + std::abs(high[axis]));
        out.low[axis] = std::min(out.low[axis], low[axis] - wider);
        out.high[axis] = std::max(out.high[axis], high[axis] + wider);
      }
      const Cluster& cluster = surface_.clusters[c];
      for (std::size_t i = 0; i < cluster.triangle_count; ++i) {
        out.piece = piece_of(std::size_t{cluster.first_triangle} + i) == out.piece ? out.piece : kMixed;
      }
    }
    return out;
  }

  // A NaN, of a look along the box's side, keeps the cell.
  static bool may_meet(const Cell& cell, const double (&from)[3], const double (&slope)[3]) {
    double enter = 0, leave = HUGE_VAL;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double a = (cell.low[axis] - from[axis]) * slope[axis], b = (cell.high[axis] - from[axis]) * slope[axis];
      const double first = a < b ? a : b, last = a < b ? b : a;
      enter = first > enter ? first : enter;
      leave = last < leave ? last : leave;
    }
    return !(enter > leave);
  }

  void corners(std::size_t triangle, Double3 (&p)[3]) const {
    for (std::size_t i = 0; i < 3; ++i) {
      const float* const at =
          surface_.rest_positions.data + 3 * std::size_t{surface_.triangle_vertices[3 * triangle + i]};
      p[i] = {double{at[0]}, double{at[1]}, double{at[2]}};
    }
  }

  // Bit k: the look meets the box of the group's cluster k. A box lies as far off the look's start as its middle does,
  // by axis, give or take its half: wide enough for roundings to floats.
  static unsigned boxes_met(const BoxLanes& boxes, const Double3& from, const Double3& direction) {
    const float start[3] = {static_cast<float>(from.x), static_cast<float>(from.y), static_cast<float>(from.z)};
    const float slope[3] = {static_cast<float>(1 / direction.x), static_cast<float>(1 / direction.y),
                            static_cast<float>(1 / direction.z)};
    const float* const middles[3] = {boxes.x, boxes.y, boxes.z};
    const float* const halves[3] = {boxes.half_x, boxes.half_y, boxes.half_z};
    float enter[kClusterLanes] = {}, leave[kClusterLanes];
    std::fill(leave, leave + kClusterLanes, FLT_MAX);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t k = 0; k < kClusterLanes; ++k) {
        const float middle = (middles[axis][k] - start[axis]) * slope[axis];
        const float reach = std::abs((halves[axis][k] + kWider * std::abs(middles[axis][k])) * slope[axis]);
        enter[k] = middle - reach > enter[k] ? middle - reach : enter[k];
        leave[k] = middle + reach < leave[k] ? middle + reach : leave[k];
      }
    }
    unsigned out = 0;
    for (std::size_t k = 0; k < kClusterLanes; ++k) {
      out |= enter[k] > leave[k] ? 0U : 1U << k;
    }
    return out;
  }

  std::uint32_t piece_of(std::size_t triangle) const {
    return surface_.pieces[surface_.triangle_vertices[3 * triangle]];
  }

  // True if the ray meets a triangle of another piece than the look's own (Moeller and Trumbore).
  bool hits(std::size_t triangle, const Double3& from, const Double3& direction) const {
    if (piece_of(triangle) == own_) {
      return false;
    }
    Double3 t[3];
    corners(triangle, t);
    const Double3 e = t[1] - t[0], f = t[2] - t[0], p = cross(direction, f);
    const double determinant = dot(e, p);
    if (!(determinant > 0) && !(determinant < 0)) {
      return false;
    }
    const Double3 r = from - t[0], q = cross(r, e);
    const double s = dot(r, p) / determinant, u = dot(direction, q) / determinant;
    return s >= 0 && u >= 0 && s + u <= 1 && dot(f, q) / determinant > 0;
  }

  bool ends_in(std::size_t c, const Double3& from, const Double3& direction) const {
    const Cluster& cluster = surface_.clusters[c];
    for (std::size_t t = cluster.first_triangle; t < std::size_t{cluster.first_triangle} + cluster.triangle_count;
         ++t) {
      if (hits(t, from, direction)) {
        return true;
      }
    }
    return false;
  }

  bool ends_in_cell(std::size_t cell, const Double3& from, const Double3& direction) {
    const std::size_t first = cell * groups_per_cell_, last = std::min(first + groups_per_cell_, surface_.boxes.size);
    for (std::size_t group = first; group < last; ++group) {
      const unsigned met = boxes_met(surface_.boxes[group], from, direction);
      for (std::size_t k = 0; met >> k != 0; ++k) {
        const std::size_t c = kClusterLanes * group + k;
        if ((met >> k & 1U) != 0 && c < surface_.clusters.size && ends_in(c, from, direction)) {
          last_ = c;
          return true;
        }
      }
    }
    return false;
  }

  // The cluster in which the last look ended is likely to end the next.
  bool ends_at_skin(const Double3& from, const Double3& direction) {
    if (ends_in(last_, from, direction)) {
      return true;
    }
    const double start[3] = {from.x, from.y, from.z}, slope[3] = {1 / direction.x, 1 / direction.y, 1 / direction.z};
    for (std::size_t cell = 0; cell < cell_count_; ++cell) {
      if (cells_[cell].piece != own_ && may_meet(cells_[cell], start, slope) && ends_in_cell(cell, from, direction)) {
        return true;
      }
    }
    return false;
  }

  const Surface& surface_;
  double clearance_ = 0;
  std::size_t last_ = 0;
  std::uint32_t own_ = 0;
  std::size_t cell_count_ = 0, groups_per_cell_ = 1;
  Cell cells_[kCellsMax];
};

}  // namespace

namespace baker {

std::vector<char> find_covered(const Surface& surface) {
  std::vector<char> out(surface.triangles.size, 0);
  const auto piece = [&](std::size_t t) { return surface.pieces[surface.triangle_vertices[3 * t]]; };
  bool is_one_piece = true;
  for (std::size_t t = 0; t < out.size(); ++t) is_one_piece = is_one_piece && piece(t) == piece(0);
  if (is_one_piece) return out;
  Looker looker(surface);
  for (const Cluster& cluster : surface.clusters) {
    for (std::size_t i = 0; i < cluster.triangle_count; ++i) {
      const std::size_t t = std::size_t{cluster.first_triangle} + i;
      out[t] = i % kRun != 0 ? out[t - 1] : looker.is_covered(t) ? 1 : 0;
    }
  }
  return out;
}

}  // namespace baker
}  // namespace spherechain

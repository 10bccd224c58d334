// SPDX-License-Identifier: MIT
#include "depth/sweep.h"

#include <algorithm>
#include <cfloat>

#include "pairs/pair_bits.h"

namespace spherechain {
namespace {

constexpr int kPassesMax = 64;       // of hostile input; of bodies a handful
constexpr std::size_t kVotes = 8;    // contacts that say what is inside
constexpr float kLarge = 4;          // cells

bool is_on(const Span<const std::uint64_t>& bits, std::size_t i) {
  return bits.size > 0 && (bits[i / 64] >> (i % 64) & 1) != 0;
}

bool is_finite(const Corners& t) {
  bool finite = true;
  for (const Double3& p : t.p) {
    finite = finite && std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
  }
  return finite;
}

}  // namespace

bool PairRule::counts(std::uint32_t a, std::uint32_t b) const {
  const std::uint32_t *const v = surface->triangle_vertices.data + 3 * std::size_t{a},
                            *const w = surface->triangle_vertices.data + 3 * std::size_t{b};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      if (surface->welds[v[i]] == surface->welds[w[j]]) {
        return false;
      }
    }
  }
  const std::size_t s = surface->triangle_spheres[a], t = surface->triangle_spheres[b];
  const std::size_t low = std::min(s, t), high = std::max(s, t);
  if (is_on(disabled, low) || is_on(disabled, high)) {
    return false;
  }
  const bool is_neighbour = low == high || is_on(ignored, high * (high - 1) / 2 + low);
  if (!(is_neighbour ? neighbours : apart)) {
    return false;
  }
  const std::uint32_t p = surface->triangles[a], q = surface->triangles[b];
  return !std::binary_search(surface->rest_contacts.begin(), surface->rest_contacts.end(),
                             Pair{std::min(p, q), std::max(p, q)});
}

void Sweep::Boxes::take(WordMemory& memory, std::size_t capacity) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    memory.take(low[axis], capacity);
    memory.take(high[axis], capacity);
  }
  memory.take(triangle, capacity);
}

void Sweep::Boxes::view(const PosedSkin& skin, const View& view) {
  for (std::size_t i = 0; i < count; ++i) {
    const Corners t = view.seen(skin.corners(triangle[i]));
    const double coordinates[3][3] = {
        {t.p[0].x, t.p[1].x, t.p[2].x}, {t.p[0].y, t.p[1].y, t.p[2].y}, {t.p[0].z, t.p[1].z, t.p[2].z}};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double *const c = coordinates[axis];
      low[axis][i] = static_cast<float>(std::min({c[0], c[1], c[2]}));
      high[axis][i] = static_cast<float>(std::max({c[0], c[1], c[2]}));
    }
  }
}

void Sweep::Boxes::bounds(float (&low_out)[3], float (&high_out)[3]) const {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low_out[axis] = FLT_MAX;
    high_out[axis] = -FLT_MAX;
    for (std::size_t i = 0; i < count; ++i) {
      low_out[axis] = std::min(low_out[axis], low[axis][i]);
      high_out[axis] = std::max(high_out[axis], high[axis][i]);
    }
  }
}

void Sweep::Boxes::keep(const Boxes& other, double reach) {
  float lows[3], highs[3];
  other.bounds(lows, highs);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count; ++i) {
    bool is_near = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      is_near = is_near && double{low[axis][i]} <= highs[axis] + reach && double{high[axis][i]} >= lows[axis] - reach;
    }
    if (is_near) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis][kept] = low[axis][i];
        high[axis][kept] = high[axis][i];
      }
      triangle[kept++] = triangle[i];
    }
  }
  count = kept;
}

void Sweep::take(WordMemory& memory, std::size_t triangle_count) {
  a_.take(memory, triangle_count);
  b_.take(memory, triangle_count);
  memory.take(first_in_cell_, std::size_t{kCells} * kCells + 1);
  memory.take(in_cell_, triangle_count);
  memory.take(large_, triangle_count);
}

void Sweep::set_sides(Span<const std::uint32_t> a, Span<const std::uint32_t> b) {
  const auto fill = [&](Boxes& boxes, const Span<const std::uint32_t>& triangles) {
    boxes.count = 0;
    for (const std::uint32_t triangle : triangles) {
      if (is_finite(skin_.corners(triangle))) {
        boxes.triangle[boxes.count++] = triangle;
      }
    }
  };
  side_a_ = a;
  side_b_ = b;
  fill(a_, a);
  fill(b_, b);
}

void Sweep::keep_near(double depth) {
  for (int round = 0; round < 2; ++round) {
    b_.keep(a_, depth + gap_);
    a_.keep(b_, depth + gap_);
  }
}

// Cells as large as a's boxes are on average, and no more than kCells a side.
void Sweep::fill_grid() {
  float lows[3], highs[3];
  a_.bounds(lows, highs);
  top_ = highs[2];
  double width[2] = {0, 0};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    for (std::size_t i = 0; i < a_.count; ++i) {
      width[axis] += double{a_.high[axis][i]} - double{a_.low[axis][i]};
    }
  }
  const double mean = 0.5 * (width[0] + width[1]) / static_cast<double>(std::max<std::size_t>(a_.count, 1));
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double extent = a_.count == 0 ? 0 : double{highs[axis]} - double{lows[axis]};
    corner_[axis] = a_.count == 0 ? 0 : lows[axis];
    const double wanted = mean > 0 ? extent / mean : 0;
    cells_[axis] = wanted < 1 ? 1 : wanted > kCells ? kCells : static_cast<int>(wanted);
    cell_[axis] = extent > 0 ? static_cast<float>(extent / cells_[axis]) : 1.0F;
    reach_[axis] = 0;
  }
  const auto cell_of = [&](std::size_t axis, float at) {
    const float place = (at - corner_[axis]) / cell_[axis];
    return place < 1 ? 0 : place >= static_cast<float>(cells_[axis]) ? cells_[axis] - 1 : static_cast<int>(place);
  };
  const std::size_t cell_count = static_cast<std::size_t>(cells_[0]) * static_cast<std::size_t>(cells_[1]);
  std::fill(first_in_cell_, first_in_cell_ + cell_count + 1, 0U);
  large_count_ = 0;
  const auto is_large = [&](std::size_t i) {
    return a_.high[0][i] - a_.low[0][i] > kLarge * cell_[0] || a_.high[1][i] - a_.low[1][i] > kLarge * cell_[1];
  };
  const auto cell_at = [&](std::size_t i) {
    return static_cast<std::size_t>(cell_of(1, a_.low[1][i]) * cells_[0] + cell_of(0, a_.low[0][i]));
  };
  for (std::size_t i = 0; i < a_.count; ++i) {
    if (is_large(i)) {
      large_[large_count_++] = static_cast<std::uint32_t>(i);
      continue;
    }
    for (std::size_t axis = 0; axis < 2; ++axis) {
      reach_[axis] = std::max(reach_[axis], a_.high[axis][i] - a_.low[axis][i]);
    }
    ++first_in_cell_[cell_at(i) + 1];
  }
  for (std::size_t cell = 1; cell <= cell_count; ++cell) {
    first_in_cell_[cell] += first_in_cell_[cell - 1];
  }
  for (std::size_t i = 0; i < a_.count; ++i) {
    if (!is_large(i)) {
      in_cell_[first_in_cell_[cell_at(i)]++] = static_cast<std::uint32_t>(i);
    }
  }
  for (std::size_t cell = cell_count; cell > 0; --cell) {
    first_in_cell_[cell] = first_in_cell_[cell - 1];
  }
  first_in_cell_[0] = 0;
}

// Those of a's boxes that b's box hides or is hidden by.
template <typename Visit>
void Sweep::for_neighbours(std::size_t b, const Visit& visit) const {
  const float low[2] = {b_.low[0][b], b_.low[1][b]}, high[2] = {b_.high[0][b], b_.high[1][b]};
  const auto meets = [&](std::size_t a) {
    return a_.low[0][a] <= high[0] && a_.high[0][a] >= low[0] && a_.low[1][a] <= high[1] && a_.high[1][a] >= low[1];
  };
  const auto cell_of = [&](std::size_t axis, float at) {
    const float place = (at - corner_[axis]) / cell_[axis];
    return place < 1 ? 0 : place >= static_cast<float>(cells_[axis]) ? cells_[axis] - 1 : static_cast<int>(place);
  };
  const int x_begin = cell_of(0, low[0] - reach_[0]), x_end = cell_of(0, high[0]) + 1;
  const int y_begin = cell_of(1, low[1] - reach_[1]), y_end = cell_of(1, high[1]) + 1;
  for (int y = y_begin; y < y_end; ++y) {
    const std::uint32_t* const row = first_in_cell_ + static_cast<std::size_t>(y) * static_cast<std::size_t>(cells_[0]);
    for (std::uint32_t k = row[x_begin]; k < row[x_end]; ++k) {
      if (meets(in_cell_[k])) {
        visit(in_cell_[k]);
      }
    }
  }
  for (std::size_t k = 0; k < large_count_; ++k) {
    if (meets(large_[k])) {
      visit(large_[k]);
    }
  }
}

// Moves the way's end on to where this pair no longer blocks it.
void Sweep::block(std::uint32_t a, std::uint32_t b, double& depth, WayOut& out) const {
  const Corners seen_a = view_.seen(skin_.corners(a)), seen_b = view_.seen(skin_.corners(b));
  const Shadow shadow(seen_a, seen_b);
  double low = HUGE_VAL, high = -HUGE_VAL;
  int last = 0;
  for (int i = 0; i < shadow.count; ++i) {
    low = std::min(low, shadow.corners[i].rise);
    if (shadow.corners[i].rise > high) {
      high = shadow.corners[i].rise;
      last = i;
    }
  }
  if (!(low <= depth + gap_) || !(high > depth) || !rule_.counts(a, b)) {
    return;
  }
  depth = high;
  out.a = a;
  out.b = b;
  const Shadow::Corner& corner = shadow.corners[last];
  const int edges[2] = {shadow.corners[(last + shadow.count - 1) % shadow.count].edge, corner.edge};
  const bool of_b[2] = {edges[0] < 3, edges[1] < 3};
  const Corners &t = skin_.corners(a), &r = skin_.corners(b);
  if (of_b[0] && of_b[1]) {  // a corner of b leaves a's face
    out.normal = normal_of(t);
  } else if (!of_b[0] && !of_b[1]) {
    out.normal = normal_of(r);
  } else {
    const int i = of_b[0] ? edges[0] : edges[1], j = (of_b[0] ? edges[1] : edges[0]) - 3;
    out.normal = cross(r.p[(i + 1) % 3] - r.p[i], t.p[(j + 1) % 3] - t.p[j]);
  }
  if (!normalize(out.normal)) {
    out.normal = {0, 0, 0};
  }
  if (dot(out.normal, view_.d) < 0) {
    out.normal = -1 * out.normal;
  }
  const double z = height_at(seen_a, corner.x, corner.y);
  out.point_a = view_.back({corner.x, corner.y, z});
  out.point_b = view_.back({corner.x, corner.y, z - high});
}

void Sweep::pass(double& depth, WayOut& out, bool& is_longer) const {
  for (std::size_t b = 0; b < b_.count; ++b) {
    const double low_b = b_.low[2][b], high_b = b_.high[2][b];
    if (double{top_} - low_b <= depth) {
      continue;
    }
    for_neighbours(b, [&](std::uint32_t a) {
      if (double{a_.high[2][a]} - low_b > depth && double{a_.low[2][a]} - high_b <= depth + gap_) {
        const double before = depth;
        block(a_.triangle[a], b_.triangle[b], depth, out);
        is_longer = is_longer || depth > before;
      }
    });
  }
}

bool Sweep::find(const Double3& direction, const Contour& contour, double bound, WayOut& out) {
  view_ = View(direction, contour.center);
  WayOut way;
  double depth = 0;
  for (const Segment3& segment : contour.segments) {
    block(segment.a, segment.b, depth, way);
  }
  out = way;
  if (depth >= bound) {
    return false;
  }
  a_.view(skin_, view_);
  b_.view(skin_, view_);
  fill_grid();
  bool is_longer = true;
  for (int i = 0; is_longer && i < kPassesMax; ++i) {
    is_longer = false;
    pass(depth, way, is_longer);
    out = way;
    if (depth >= bound) {
      return false;
    }
  }
  out.depth = depth;
  return true;
}

// For each point: is the next surface of that side above it, or below it, one that is left, not entered?
void Sweep::vote(const Span<const std::uint32_t>& side, const Double3* points, std::size_t count, bool up,
                 double handedness, int* inside) const {
  double nearest[kVotes];
  std::fill(nearest, nearest + kVotes, HUGE_VAL);
  for (const std::uint32_t triangle : side) {
    const Corners t = view_.seen(skin_.corners(triangle));
    const double turn = turn_of(t), sign = turn > 0 ? 1 : -1;
    for (std::size_t i = 0; i < count && (turn > 0 || turn < 0); ++i) {
      const Double3& from = points[i];
      bool is_over = true;
      for (int k = 0; k < 3 && is_over; ++k) {
        const Double3 &p = t.p[k], &q = t.p[(k + 1) % 3];
        is_over = sign * ((q.x - p.x) * (from.y - p.y) - (q.y - p.y) * (from.x - p.x)) >= 0;
      }
      if (is_over) {
        const double rise = height_at(t, from.x, from.y) - from.z, distance = up ? rise : -rise;
        if (distance > 0 && distance < nearest[i]) {
          nearest[i] = distance;
          inside[i] = (up ? sign : -sign) * handedness > 0 ? 1 : 0;
        }
      }
    }
  }
}

bool Sweep::is_enclosed(const WayOut& way, const Contour& contour, double handedness) const {
  const auto middle = [&](std::uint32_t triangle) {
    const Corners t = view_.seen(skin_.corners(triangle));
    return (1.0 / 3) * (t.p[0] + (t.p[1] + t.p[2]));
  };
  const std::size_t step = (contour.segments.size + kVotes - 1) / kVotes;
  Double3 of_a[kVotes] = {}, of_b[kVotes] = {};
  int a_in_b[kVotes] = {}, b_in_a[kVotes] = {};
  std::size_t count = 0;
  for (std::size_t i = 0; i < contour.segments.size; i += step, ++count) {
    of_a[count] = middle(contour.segments[i].a);
    of_b[count] = middle(contour.segments[i].b);
    of_a[count].z -= way.depth;
    of_b[count].z += way.depth;
  }
  vote(side_a_, of_b, count, true, handedness, b_in_a);
  vote(side_b_, of_a, count, false, handedness, a_in_b);
  const auto most = [&](const int* votes) { return 2 * std::count(votes, votes + count, 1) > static_cast<long>(count); };
  return most(b_in_a) || most(a_in_b);
}

// Along each line in the direction, the part of b inside a is as long as the sum over pairs of crossings, with the
// signs of their surfaces, of how far b's is below a's. Where b is clear of a after the move, only pairs that meet on
// the way are left of that sum.
Volume Sweep::volume(double depth) const {
  Volume out;
  for (std::size_t b = 0; b < b_.count; ++b) {
    for_neighbours(b, [&](std::uint32_t a) {
      if (!(a_.high[2][a] > b_.low[2][b]) || !(double{a_.low[2][a]} - double{b_.high[2][b]} < depth)) {
        return;
      }
      const Corners seen_a = view_.seen(skin_.corners(a_.triangle[a])),
                    seen_b = view_.seen(skin_.corners(b_.triangle[b]));
      Shadow shadow(seen_a, seen_b);
      shadow.keep_above(0);
      shadow.keep_below(depth);
      if (shadow.count > 2) {
        const double sign = (turn_of(seen_a) > 0) == (turn_of(seen_b) > 0) ? -1 : 1;
        out.volume += sign * shadow.volume();
        out.area += sign * shadow.area();
      }
    });
  }
  return out;
}

}  // namespace spherechain

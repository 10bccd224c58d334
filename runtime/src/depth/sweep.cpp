// SPDX-License-Identifier: MIT
#include "depth/sweep.h"

#include <algorithm>
#include <cfloat>

#include "pairs/pair_bits.h"

namespace spherechain {
namespace {

constexpr int kPassesMax = 64;      // of hostile input; of bodies a handful
constexpr float kRounding = 1e-5F;  // of sums of coordinates, to their size: many times more than there is

bool is_on(const Span<const std::uint64_t>& bits, std::size_t i) {
  return bits.size > 0 && (bits[i / 64] >> (i % 64) & 1) != 0;
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
  const std::size_t blocks = (capacity + kBlock - 1) / kBlock;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    memory.take(low[axis], blocks * kBlock);
    memory.take(high[axis], blocks * kBlock);
    memory.take(block_low[axis], blocks + kBlock);
    memory.take(block_high[axis], blocks + kBlock);
    memory.take(middle[axis], blocks);
    memory.take(half[axis], blocks);
  }
  memory.take(block, blocks);
  memory.take(triangle, capacity);
  memory.take(corners, 3 * capacity);
}

// Intervals that are no shorter than those of the triangles' boxes, of all blocks.
void Sweep::Boxes::view_blocks(const View& view) {
  block_count = (count + kBlock - 1) / kBlock;
  const Double3* const axes[3] = {&view.u, &view.v, &view.d};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Vec3 a = to_float(*axes[axis]);
    for (std::size_t i = 0; i < block_count; ++i) {
      const float at = a.x * middle[0][i] + (a.y * middle[1][i] + a.z * middle[2][i]);
      const float reach = std::abs(a.x) * half[0][i] + (std::abs(a.y) * half[1][i] + std::abs(a.z) * half[2][i]);
      block_low[axis][i] = at - reach;
      block_high[axis][i] = at + reach;
    }
  }
  for (std::size_t i = 0; i < block_count; ++i) {
    block[i] = static_cast<std::uint32_t>(i);
  }
}

// Those that reach into a box; what is not finite stays.
void Sweep::Boxes::keep_blocks(const float (&least)[3], const float (&most)[3]) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < block_count; ++i) {
    bool is_outside = false;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      is_outside = is_outside || block_low[axis][i] > most[axis] || block_high[axis][i] < least[axis];
    }
    if (!is_outside) {
      block[kept] = block[i];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        block_low[axis][kept] = block_low[axis][i];
        block_high[axis][kept] = block_high[axis][i];
      }
      ++kept;
    }
  }
  block_count = kept;
}

void Sweep::Boxes::view(const float* const (&seen)[3]) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float* const at = seen[axis];
    for (std::size_t i = 0; i < block_count; ++i) {
      const std::size_t first = kBlock * block[i], end = std::min(first + kBlock, count);
      float least = FLT_MAX, most = -FLT_MAX;
      for (std::size_t t = first; t < end; ++t) {
        const float p = at[corners[3 * t]], q = at[corners[3 * t + 1]], r = at[corners[3 * t + 2]];
        low[axis][t] = std::min(std::min(p, q), r);
        high[axis][t] = std::max(std::max(p, q), r);
        least = std::min(least, low[axis][t]);
        most = std::max(most, high[axis][t]);
      }
      std::fill(low[axis] + end, low[axis] + first + kBlock, FLT_MAX);
      std::fill(high[axis] + end, high[axis] + first + kBlock, -FLT_MAX);
      block_low[axis][i] = least;
      block_high[axis][i] = most;
    }
    std::fill(block_low[axis] + block_count, block_low[axis] + block_count + kBlock, FLT_MAX);
    std::fill(block_high[axis] + block_count, block_high[axis] + block_count + kBlock, -FLT_MAX);
  }
}

void Sweep::take(WordMemory& memory, std::size_t triangle_count, std::size_t vertex_count) {
  a_.take(memory, triangle_count);
  b_.take(memory, triangle_count);
  memory.take(vertices_.vertex, vertex_count);
  memory.take(vertices_.place, vertex_count);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    memory.take(vertices_.at[axis], vertex_count);
    memory.take(vertices_.seen[axis], vertex_count);
  }
}

void Sweep::clear(std::size_t vertex_count) { std::fill(vertices_.place, vertices_.place + vertex_count, kNoPlace); }

// Near each other in memory: boxes are made of them again and again.
void Sweep::list_vertices(Boxes& boxes) {
  for (std::size_t i = 0; i < boxes.count; ++i) {
    const std::uint32_t* const corners = skin_.surface->triangle_vertices.data + 3 * std::size_t{boxes.triangle[i]};
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t& place = vertices_.place[corners[k]];
      if (place == kNoPlace) {
        place = static_cast<std::uint32_t>(vertices_.count);
        vertices_.vertex[vertices_.count] = corners[k];
        const float* const p = skin_.positions + 3 * std::size_t{corners[k]};
        vertices_.at[0][vertices_.count] = static_cast<float>(double{p[0]} - vertices_.origin.x);
        vertices_.at[1][vertices_.count] = static_cast<float>(double{p[1]} - vertices_.origin.y);
        vertices_.at[2][vertices_.count] = static_cast<float>(double{p[2]} - vertices_.origin.z);
        ++vertices_.count;
      }
      boxes.corners[3 * i + k] = place;
    }
  }
}

void Sweep::look_along(const Double3& direction) { view_ = View(direction, vertices_.origin); }

// Boxes need no more than single precision: their triangles are compared in double precision.
void Sweep::see_boxes(double depth) {
  a_.view_blocks(view_);
  b_.view_blocks(view_);
  // A side's blocks stay where they reach into the box around the other's; that one is smaller the second time. To meet
  // a, b rises: so far at least.
  const float rise = static_cast<float>(depth) * (1 - kRounding);
  for (int turn = 0; turn < 2; ++turn) {
    for (Boxes* const side : {&a_, &b_}) {
      const Boxes& other = side == &a_ ? b_ : a_;
      float least[3], most[3];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        least[axis] = FLT_MAX;
        most[axis] = -FLT_MAX;
        for (std::size_t i = 0; i < other.block_count; ++i) {
          least[axis] = std::min(least[axis], other.block_low[axis][i]);
          most[axis] = std::max(most[axis], other.block_high[axis][i]);
        }
      }
      if (side == &a_) {
        least[2] += rise;
        most[2] = FLT_MAX;
      } else {
        least[2] = -FLT_MAX;
        most[2] -= rise;
      }
      side->keep_blocks(least, most);
    }
  }
  const float *const x = vertices_.at[0], *const y = vertices_.at[1], *const z = vertices_.at[2];
  const Double3* const axes[3] = {&view_.u, &view_.v, &view_.d};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Vec3 a = to_float(*axes[axis]);
    float* const out = vertices_.seen[axis];
    for (std::size_t i = 0; i < vertices_.count; ++i) {
      out[i] = a.x * x[i] + (a.y * y[i] + a.z * z[i]);
    }
  }
  a_.view(vertices_.seen);
  b_.view(vertices_.seen);
}

void Sweep::set_sides(Span<const TriangleRun> a, Span<const TriangleRun> b, const Double3& origin) {
  side_a_ = a;
  side_b_ = b;
  vertices_.origin = origin;
  remembered_count_ = 0;
  first_block_ = 0;
}

void Sweep::keep_near(double depth) { keep({{depth, depth, depth}, {depth, depth, depth}}); }

void Sweep::keep_on_way(const Double3& direction, double depth) {
  const auto part = [&](double along) { return along > 0 ? along * depth : 0; };
  keep({{part(direction.x), part(direction.y), part(direction.z)},
        {part(-direction.x), part(-direction.y), part(-direction.z)}});
}

void Sweep::keep(const Room& room) {
  for (std::size_t i = 0; i < vertices_.count; ++i) {
    vertices_.place[vertices_.vertex[i]] = kNoPlace;
  }
  vertices_.count = 0;
  keep_runs(side_a_, side_b_, room, a_);
  keep_runs(side_b_, side_a_, {room.down, room.up}, b_);
  list_vertices(a_);
  list_vertices(b_);
}

// By the box of the run's cluster, of the blocks that the run comes to lie in.
void Sweep::widen_blocks(const TriangleRun& run, Boxes& out) const {
  const double origin[3] = {vertices_.origin.x, vertices_.origin.y, vertices_.origin.z};
  for (std::size_t i = out.count / kBlock; kBlock * i < out.count + run.count; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      auto low = static_cast<float>(double{skin_.low[axis][run.cluster]} - origin[axis]);
      auto high = static_cast<float>(double{skin_.high[axis][run.cluster]} - origin[axis]);
      if (kBlock * i < out.count) {
        low = std::min(low, out.middle[axis][i] - out.half[axis][i]);
        high = std::max(high, out.middle[axis][i] + out.half[axis][i]);
      }
      out.middle[axis][i] = 0.5F * (low + high);
      out.half[axis][i] = 0.5F * (high - low) + kRounding * std::max(std::abs(low), std::abs(high));
    }
  }
}

// Runs of whose cluster the box meets one of the other side's that goes so far up and down along each axis.
void Sweep::keep_runs(const Span<const TriangleRun>& side, const Span<const TriangleRun>& other, const Room& room,
                      Boxes& out) {
  const double up[3] = {room.up.x + gap_, room.up.y + gap_, room.up.z + gap_};
  const double down[3] = {room.down.x + gap_, room.down.y + gap_, room.down.z + gap_};
  double highest[3], lowest[3];  // of them all
  for (std::size_t axis = 0; axis < 3; ++axis) {
    highest[axis] = -HUGE_VAL;
    lowest[axis] = HUGE_VAL;
    for (const TriangleRun& from : other) {
      highest[axis] = std::max(highest[axis], double{skin_.high[axis][from.cluster]});
      lowest[axis] = std::min(lowest[axis], double{skin_.low[axis][from.cluster]});
    }
  }
  out.count = 0;
  for (const TriangleRun& run : side) {
    const auto is_near = [&](const auto& high, const auto& low) {
      bool near = true;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        near = near && double{skin_.low[axis][run.cluster]} <= high(axis) + up[axis] &&
               double{skin_.high[axis][run.cluster]} >= low(axis) - down[axis];
      }
      return near;
    };
    const auto is_near_run = [&](const TriangleRun& from) {
      return is_near([&](std::size_t axis) { return double{skin_.high[axis][from.cluster]}; },
                     [&](std::size_t axis) { return double{skin_.low[axis][from.cluster]}; });
    };
    if (is_near([&](std::size_t axis) { return highest[axis]; }, [&](std::size_t axis) { return lowest[axis]; }) &&
        std::any_of(other.begin(), other.end(), is_near_run)) {
      widen_blocks(run, out);
      for (std::uint32_t i = 0; i < run.count; ++i) {
        out.triangle[out.count++] = run.first + i;
      }
    }
  }
}

// Which of kBlock boxes from `first` on hide, seen along d, box `i` of the others? -1 each; 0 if none does.
std::int32_t Sweep::find_hidden(float* const (&low)[3], float* const (&high)[3], std::size_t first,
                                float* const (&other_low)[3], float* const (&other_high)[3], std::size_t i,
                                std::int32_t (&hides)[kBlock]) {
  const float low_u = other_low[0][i], high_u = other_high[0][i], low_v = other_low[1][i], high_v = other_high[1][i];
  const float *const lows_u = low[0] + first, *const highs_u = high[0] + first;
  const float *const lows_v = low[1] + first, *const highs_v = high[1] + first;
  std::int32_t any = 0;
  for (std::size_t k = 0; k < kBlock; ++k) {
    const std::int32_t p0 = lows_u[k] <= high_u ? -1 : 0, p1 = highs_u[k] >= low_u ? -1 : 0;
    const std::int32_t q0 = lows_v[k] <= high_v ? -1 : 0, q1 = highs_v[k] >= low_v ? -1 : 0;
    hides[k] = p0 & p1 & q0 & q1;
    any |= hides[k];
  }
  return any;
}

template <typename Wants, typename Visit>
void Sweep::for_pairs(std::size_t first, const Wants& wants, const Visit& visit) const {
  const std::size_t a_blocks = a_.block_count, b_blocks = b_.block_count;
  // A lambda: without one the function would be a symbol of the library.
  const auto is_before = [](std::uint32_t block, std::size_t other) { return block < other; };
  const auto start =
      static_cast<std::size_t>(std::lower_bound(b_.block, b_.block + b_blocks, first, is_before) - b_.block);
  std::int32_t near[kBlock], hides[kBlock];
  for (std::size_t turn = 0; turn < b_blocks; ++turn) {
    const std::size_t q = (start + turn) % b_blocks, b_first = kBlock * b_.block[q];
    const std::size_t b_end = std::min(b_first + kBlock, b_.count);
    for (std::size_t p = 0; p < a_blocks; ++p) {
      if (p % kBlock == 0 && find_hidden(a_.block_low, a_.block_high, p, b_.block_low, b_.block_high, q, near) == 0) {
        p += kBlock - 1;
        continue;
      }
      if (near[p % kBlock] == 0 || !wants(double{a_.block_low[2][p]} - double{b_.block_high[2][q]},
                                          double{a_.block_high[2][p]} - double{b_.block_low[2][q]})) {
        continue;
      }
      const std::size_t a_first = kBlock * a_.block[p];
      for (std::size_t b = b_first; b < b_end; ++b) {
        if (a_.block_low[0][p] > b_.high[0][b] || a_.block_high[0][p] < b_.low[0][b] ||
            a_.block_low[1][p] > b_.high[1][b] || a_.block_high[1][p] < b_.low[1][b] ||
            !wants(double{a_.block_low[2][p]} - double{b_.high[2][b]},
                   double{a_.block_high[2][p]} - double{b_.low[2][b]}) ||
            find_hidden(a_.low, a_.high, a_first, b_.low, b_.high, b, hides) == 0) {
          continue;
        }
        // Positions that are not finite meet even the empty boxes past the last.
        for (std::size_t k = 0; k < kBlock && a_first + k < a_.count; ++k) {
          const std::size_t a = a_first + k;
          if (hides[k] != 0 &&
              wants(double{a_.low[2][a]} - double{b_.high[2][b]}, double{a_.high[2][a]} - double{b_.low[2][b]}) &&
              !visit(a_.triangle[a], b_.triangle[b], b_.block[q])) {
            return;
          }
        }
      }
    }
  }
}

// Moves the way's end on to where this pair no longer blocks it.
void Sweep::block(std::uint32_t a, std::uint32_t b, double& depth, WayOut& out) const {
  const Corners seen_a = view_.seen(skin_.corners(a)), seen_b = view_.seen(skin_.corners(b));
  const Shadow shadow(seen_a, seen_b, depth, depth + gap_);
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
  const double z =
      shadow.stands_on_a ? height_at(seen_a, corner.x, corner.y) : height_at(seen_b, corner.x, corner.y) + high;
  out.point_a = view_.back({corner.x, corner.y, z});
  out.point_b = view_.back({corner.x, corner.y, z - high});
}

void Sweep::remember(const WayOut& out) {
  const Pair pair{out.a, out.b};
  const std::size_t known = std::min(remembered_count_, kRemembered);
  if (out.a != kNoPlace && std::find(remembered_, remembered_ + known, pair) == remembered_ + known) {
    remembered_[remembered_count_++ % kRemembered] = pair;
  }
}

double Sweep::find_by_contour(const Double3& direction, const Contour& contour, double bound, WayOut& out) {
  look_along(direction);
  out = {};
  double depth = 0;
  for (std::size_t i = 0; i < contour.segments.size && depth < bound; ++i) {
    block(contour.segments[i].a, contour.segments[i].b, depth, out);
  }
  return depth;
}

bool Sweep::find(const Double3& direction, const Contour& contour, double bound, WayOut& out) {
  double depth = find_by_contour(direction, contour, bound, out);
  for (double before = -1; depth > before && depth < bound;) {
    before = depth;
    for (std::size_t i = 0; i < std::min(remembered_count_, kRemembered) && depth < bound; ++i) {
      block(remembered_[i].a, remembered_[i].b, depth, out);
    }
  }
  if (depth >= bound) {
    return false;
  }
  see_boxes(depth);
  bool is_longer = true;
  for (int i = 0; is_longer && i < kPassesMax && depth < bound; ++i) {
    const double before = depth;
    // What blocked last is likely to block again: it comes first.
    for_pairs(
        first_block_, [&](double low, double high) { return high > depth && low <= depth + gap_; },
        [&](std::uint32_t a, std::uint32_t b, std::size_t at) {
          const double was = depth;
          block(a, b, depth, out);
          if (depth > was) {
            remember(out);
            first_block_ = at;
          }
          return depth < bound;
        });
    is_longer = depth > before;
  }
  remember(out);
  out.depth = depth;
  return depth < bound;
}

// Along each line in the direction, the part of b inside a is as long as the sum over pairs of crossings, with the
// signs of their surfaces, of how far b's is below a's. Where b is clear of a after the move, only pairs that meet on
// the way are left of that sum.
Volume Sweep::volume(const Double3& direction, double depth) {
  look_along(direction);
  see_boxes(0);
  Volume out;
  for_pairs(
      0, [&](double low, double high) { return high > 0 && low <= depth + gap_; },
      [&](std::uint32_t a, std::uint32_t b, std::size_t) {
        const Corners seen_a = view_.seen(skin_.corners(a)), seen_b = view_.seen(skin_.corners(b));
        Shadow shadow(seen_a, seen_b, 0, depth);
        shadow.keep_above(0);
        shadow.keep_below(depth);
        if (shadow.count > 2) {
          const double sign = (turn_of(seen_a) > 0) == (turn_of(seen_b) > 0) ? -1 : 1;
          out.volume += sign * shadow.volume();
          out.area += sign * shadow.area();
          out.total += shadow.area();
        }
        return true;
      });
  return out;
}

}  // namespace spherechain

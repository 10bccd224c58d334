// SPDX-License-Identifier: MIT
#include "runtime/src/depth/sweep.h"

#include <algorithm>

#include "runtime/src/base/pair_bits.h"

namespace spherechain {
namespace {

constexpr int kPassesMax = 64;  // of hostile input; of bodies a handful

bool is_on(const Span<const std::uint64_t>& bits, std::size_t i) {
  return bits.size > 0 && (bits[i / 64] >> (i % 64) & 1) != 0;
}

}  // namespace

bool PairRule::counts(std::uint32_t a, std::uint32_t b) const {
  if (surface == nullptr) {
    return true;
  }
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
  const bool is_neighbour = low == high || is_on(ignored, high * (high - 1) / 2 + low);
  if (!(is_neighbour ? neighbours : apart)) {
    return false;
  }
  if (!layers && are_layers(*surface, cluster_of(*surface, a), cluster_of(*surface, b))) {
    return false;
  }
  const std::uint32_t p = surface->triangles[a], q = surface->triangles[b];
  return !std::binary_search(surface->rest_contacts.begin(), surface->rest_contacts.end(),
                             Pair{std::min(p, q), std::max(p, q)});
}

void Sweep::take(WordMemory& memory, const SkinSizes& a, const SkinSizes& b) {
  const std::size_t vertex_count = a.vertices + (skins_.are_one() ? 0 : b.vertices);
  a_.take(memory, a.triangles);
  b_.take(memory, b.triangles);
  memory.take(vertices_.vertex, vertex_count);
  memory.take(vertices_.place, vertex_count);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    memory.take(vertices_.at[axis], vertex_count);
    memory.take(vertices_.seen[axis], vertex_count);
  }
}

void Sweep::clear() { std::fill(vertices_.place, vertices_.place + skins_.vertex_count(), kNoPlace); }

void Sweep::look_along(const Double3& direction) { view_ = View(direction, vertices_.origin); }

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

// Compares kBlock boxes from `first` on with box `i` of the others, in u and v: -1 for each that overlaps it, else 0.
// Returns 0 if none does.
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
void Sweep::for_pairs(std::size_t first, const Wants& wants, const Visit& visit) {
  const std::size_t a_blocks = a_.block_count, b_blocks = b_.block_count;
  // A lambda: without one the function would be a symbol of the library.
  const auto is_before = [](std::uint32_t block, std::size_t other) { return block < other; };
  const auto start =
      static_cast<std::size_t>(std::lower_bound(b_.block, b_.block + b_blocks, first, is_before) - b_.block);
  std::int32_t near[kBlock], hidden[kBlock], hides[kBlock];
  for (std::size_t turn = 0; turn < b_blocks; ++turn) {
    const std::size_t q = (start + turn) % b_blocks, b_first = kBlock * b_.block[q];
    const std::size_t b_end = std::min(b_first + kBlock, b_.count);
    for (std::size_t p = 0; p < a_blocks; ++p) {
      if (p % kBlock == 0 && find_hidden(a_.block_low, a_.block_high, p, b_.block_low, b_.block_high, q, near) == 0) {
        p += kBlock - 1;
        continue;
      }
      // Asks again where a block's triangles got boxes: its own box became smaller.
      const auto may_meet = [&] {
        return a_.block_low[0][p] <= b_.block_high[0][q] && a_.block_high[0][p] >= b_.block_low[0][q] &&
               a_.block_low[1][p] <= b_.block_high[1][q] && a_.block_high[1][p] >= b_.block_low[1][q] &&
               wants(double{a_.block_low[2][p]} - double{b_.block_high[2][q]},
                     double{a_.block_high[2][p]} - double{b_.block_low[2][q]});
      };
      if (near[p % kBlock] == 0 || !may_meet()) {
        continue;
      }
      if (b_.make_boxes(q, vertices_.seen) && !may_meet()) {
        continue;
      }
      if (a_.make_boxes(p, vertices_.seen) && !may_meet()) {
        continue;
      }
      const std::size_t a_first = kBlock * a_.block[p];
      if (find_hidden(b_.low, b_.high, b_first, a_.block_low, a_.block_high, p, hidden) == 0) {
        continue;
      }
      for (std::size_t b = b_first; b < b_end; ++b) {
        if (hidden[b - b_first] == 0 ||
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

// Tells from the triangles' intervals along the way whether this pair may block it beyond `depth`.
bool Sweep::may_block(std::uint32_t a, std::uint32_t b, double depth) const {
  const Corners t = skins_.a.corners(a), r = skins_.b.corners(b);
  const auto along = [&](const Double3& p) { return dot(view_.d, p); };
  const double a0 = along(t.p[0]), a1 = along(t.p[1]), a2 = along(t.p[2]);
  const double b0 = along(r.p[0]), b1 = along(r.p[1]), b2 = along(r.p[2]);
  return std::max(std::max(a0, a1), a2) - std::min(std::min(b0, b1), b2) > depth &&
         std::min(std::min(a0, a1), a2) - std::max(std::max(b0, b1), b2) <= depth + gap_;
}

// Moves the way's end on to where this pair no longer blocks it.
void Sweep::block(std::uint32_t a, std::uint32_t b, double& depth, WayOut& out) const {
  const Corners seen_a = view_.seen(skins_.a.corners(a)), seen_b = view_.seen(skins_.b.corners(b));
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
  const Corners &t = skins_.a.corners(a), &r = skins_.b.corners(b);
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
    if (may_block(contour.segments[i].a, contour.segments[i].b, depth)) {
      block(contour.segments[i].a, contour.segments[i].b, depth, out);
    }
  }
  return depth;
}

bool Sweep::find(const Double3& direction, const Contour& contour, double bound, WayOut& out) {
  double depth = find_by_contour(direction, contour, bound, out);
  for (double before = -1; depth > before && depth < bound;) {
    before = depth;
    for (std::size_t i = 0; i < std::min(remembered_count_, kRemembered) && depth < bound; ++i) {
      if (may_block(remembered_[i].a, remembered_[i].b, depth)) {
        block(remembered_[i].a, remembered_[i].b, depth, out);
      }
    }
  }
  if (depth >= bound) {
    return false;
  }
  see_boxes(depth);
  bool is_longer = true;
  for (int i = 0; is_longer && i < kPassesMax && depth < bound; ++i) {
    const double before = depth;
    // The pair that blocked last is likely to block again, so it comes first.
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

// Take a line along the direction that crosses surfaces of a and of b. The length of b inside a on that line is a sum
// over pairs of crossings, one of each body: the distance of b's below a's, with the product of the surfaces' signs. If
// b is clear of a after the move, all pairs cancel but those that meet on the way. Integrated over all lines, a pair of
// triangles adds the volume between their shadows.
Volume Sweep::volume(const Double3& direction, double depth, bool of_outer_layers) {
  look_along(direction);
  see_boxes(0);
  Volume out;
  for_pairs(
      0, [&](double low, double high) { return high > 0 && low <= depth + gap_; },
      [&](std::uint32_t a, std::uint32_t b, std::size_t) {
        if (of_outer_layers && (skins_.a.is_covered(a) || skins_.b.is_covered(b))) {
          return true;
        }
        const Corners seen_a = view_.seen(skins_.a.corners(a)), seen_b = view_.seen(skins_.b.corners(b));
        Shadow shadow(seen_a, seen_b, 0, depth);
        shadow.keep_above(0);
        shadow.keep_below(depth);
        if (shadow.count > 2) {
          const double turns = (turn_of(seen_a) > 0) == (turn_of(seen_b) > 0) ? -1 : 1;
          const double sign = turns * skins_.a.handedness * skins_.b.handedness;
          out.volume += sign * shadow.volume();
          out.area += sign * shadow.area();
          out.total += shadow.area();
        }
        return true;
      });
  return out;
}

}  // namespace spherechain

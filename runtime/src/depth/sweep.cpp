// SPDX-License-Identifier: MIT
#include "runtime/src/depth/sweep.h"

#include <algorithm>

#include "runtime/src/base/pair_bits.h"

namespace spherechain {
namespace {

constexpr int kPassesMax = 64;      // of hostile input; of bodies a handful
constexpr double kRounding = 1e-6;  // relative; more than that of a number in single precision
constexpr std::size_t kLanes = 16;
constexpr std::uint32_t kBits[kLanes] = {1,     2,     4,     8,     0x10,   0x20,   0x40,   0x80,
                                         0x100, 0x200, 0x400, 0x800, 0x1000, 0x2000, 0x4000, 0x8000};

// A box in view, open on one side along the direction. Rounding makes it larger, never smaller.
struct OpenBox {
  float low[3], high[3];

  // Any box that box i meets after it has moved up by more than `move`.
  template <typename Arrays>
  static OpenBox above(const Arrays& lows, const Arrays& highs, std::size_t i, double move) {
    const double at = double{lows[2][i]} + move;
    return {{lows[0][i], lows[1][i], static_cast<float>(at - kRounding * std::abs(at))},
            {highs[0][i], highs[1][i], HUGE_VALF}};
  }
  // Any box that meets box i after it has moved up by more than `move`.
  template <typename Arrays>
  static OpenBox below(const Arrays& lows, const Arrays& highs, std::size_t i, double move) {
    const double at = double{highs[2][i]} - move;
    return {{lows[0][i], lows[1][i], -HUGE_VALF},
            {highs[0][i], highs[1][i], static_cast<float>(at + kRounding * std::abs(at))}};
  }
  // Bit k: box `first` + k, which is one of the first `count`, overlaps it.
  template <typename Arrays>
  std::uint32_t overlaps(const Arrays& lows, const Arrays& highs, std::size_t first, std::size_t count) const {
    const float *const low_u = lows[0] + first, *const low_v = lows[1] + first, *const low_d = lows[2] + first;
    const float *const high_u = highs[0] + first, *const high_v = highs[1] + first, *const high_d = highs[2] + first;
    std::uint32_t out = 0;
    for (std::size_t k = 0; k < kLanes; ++k) {
      const std::uint32_t u0 = low_u[k] <= high[0] ? kBits[k] : 0, u1 = high_u[k] >= low[0] ? kBits[k] : 0;
      const std::uint32_t v0 = low_v[k] <= high[1] ? kBits[k] : 0, v1 = high_v[k] >= low[1] ? kBits[k] : 0;
      const std::uint32_t d0 = low_d[k] <= high[2] ? kBits[k] : 0, d1 = high_d[k] >= low[2] ? kBits[k] : 0;
      out |= u0 & u1 & v0 & v1 & d0 & d1;
    }
    // Positions that are not finite meet even the empty boxes past the last.
    return count - first < kLanes ? out & ((1U << (count - first)) - 1) : out;
  }
};

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
  if (!may_count(surface->triangle_spheres[a], surface->triangle_spheres[b])) {
    return false;
  }
  if (!layers && are_layers(*surface, cluster_of(*surface, a), cluster_of(*surface, b))) {
    return false;
  }
  const std::uint32_t p = surface->triangles[a], q = surface->triangles[b];
  return !std::binary_search(surface->rest_contacts.begin(), surface->rest_contacts.end(),
                             Pair{std::min(p, q), std::max(p, q)});
}

bool PairRule::may_count(std::size_t sphere_a, std::size_t sphere_b) const {
  if (surface == nullptr) {
    return true;
  }
  const std::size_t low = std::min(sphere_a, sphere_b), high = std::max(sphere_a, sphere_b);
  return low == high || is_on(ignored, high * (high - 1) / 2 + low) ? neighbours : apart;
}

void Sweep::take(WordMemory& memory, const SkinSizes& a, const SkinSizes& b) {
  const std::size_t vertex_count = a.vertices + (skins_.are_one() ? 0 : b.vertices);
  a_.take(memory, a.triangles);
  b_.take(memory, b.triangles);
  memory.take(seen_a_.entries, SeenTriangles::kCount);
  memory.take(seen_b_.entries, SeenTriangles::kCount);
  memory.take(vertices_.vertex, vertex_count);
  memory.take(vertices_.place, vertex_count);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    memory.take(vertices_.at[axis], vertex_count);
    memory.take(vertices_.seen[axis], vertex_count);
  }
}

void Sweep::clear() {
  std::fill(vertices_.place, vertices_.place + skins_.vertex_count(), kNoPlace);
  for (SeenTriangles* const seen : {&seen_a_, &seen_b_}) {
    for (std::size_t i = 0; i < SeenTriangles::kCount; ++i) {
      seen->entries[i].key = 0;  // no view has that number
    }
  }
}

void Sweep::look_along(const Double3& direction) {
  view_ = View(direction, vertices_.origin);
  ++view_number_;
}

const SeenTriangle& Sweep::see(SeenTriangles& of, const PosedSkin& skin, std::uint32_t triangle) {
  SeenTriangles::Entry& entry = of.entries[triangle % SeenTriangles::kCount];
  const std::uint64_t key = std::uint64_t{view_number_} << 32 | triangle;
  if (entry.key != key) {
    entry = {key, SeenTriangle(view_.seen(skin.corners(triangle)))};
  }
  return entry.seen;
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

template <typename Visit>
void Sweep::for_pairs(std::size_t first, const Moves& moves, const Visit& visit) {
  static_assert(kBlock == kLanes);
  const std::size_t a_blocks = a_.block_count, b_blocks = b_.block_count;
  // Lambdas: without them these functions would be symbols of the library.
  const auto is_before = [](std::uint32_t block, std::size_t other) { return block < other; };
  const auto start =
      static_cast<std::size_t>(std::lower_bound(b_.block, b_.block + b_blocks, first, is_before) - b_.block);
  using Lows = float* const(&)[3];
  const auto may_meet = [&](Lows low_a, Lows high_a, std::size_t a, Lows low_b, Lows high_b, std::size_t b) {
    return low_a[0][a] <= high_b[0][b] && high_a[0][a] >= low_b[0][b] && low_a[1][a] <= high_b[1][b] &&
           high_a[1][a] >= low_b[1][b] && double{high_a[2][a]} - double{low_b[2][b]} > moves.from &&
           double{low_a[2][a]} - double{high_b[2][b]} <= moves.to;
  };
  for (std::size_t turn = 0; turn < b_blocks; ++turn) {
    const std::size_t q = (start + turn) % b_blocks, b_first = kBlock * b_.block[q];
    for (std::size_t group = 0; group < a_blocks; group += kBlock) {
      const OpenBox over_b = OpenBox::above(b_.block_low, b_.block_high, q, moves.from);
      std::uint32_t near = over_b.overlaps(a_.block_low, a_.block_high, group, a_blocks);
      for (; near != 0; near &= near - 1) {
        const std::size_t p = group + lowest_bit(near);
        // Asks again where a block's triangles got boxes: its own box became smaller.
        const auto blocks_may_meet = [&] {
          return may_meet(a_.block_low, a_.block_high, p, b_.block_low, b_.block_high, q);
        };
        if (!blocks_may_meet() || !may_count(a_.sphere[a_.block[p]], b_.sphere[b_.block[q]]) ||
            (b_.make_boxes(q, vertices_.seen) && !blocks_may_meet()) ||
            (a_.make_boxes(p, vertices_.seen) && !blocks_may_meet())) {
          continue;
        }
        const std::size_t a_first = kBlock * a_.block[p];
        const OpenBox under_a = OpenBox::below(a_.block_low, a_.block_high, p, moves.from);
        std::uint32_t met_b = under_a.overlaps(b_.low, b_.high, b_first, b_.count);
        for (; met_b != 0; met_b &= met_b - 1) {
          const std::size_t b = b_first + lowest_bit(met_b);
          const OpenBox over = OpenBox::above(b_.low, b_.high, b, moves.from);
          std::uint32_t met_a = over.overlaps(a_.low, a_.high, a_first, a_.count);
          for (; met_a != 0; met_a &= met_a - 1) {
            const std::size_t a = a_first + lowest_bit(met_a);
            if (may_meet(a_.low, a_.high, a, b_.low, b_.high, b) &&
                !visit(a_.triangle[a], b_.triangle[b], b_.block[q])) {
              return;
            }
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
void Sweep::block(std::uint32_t a, std::uint32_t b, double& depth, WayOut& out) {
  const SeenTriangle &seen_a = see(seen_a_, skins_.a, a), &seen_b = see(seen_b_, skins_.b, b);
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
      shadow.stands_on_a ? seen_a.slope.at(corner.x, corner.y) : seen_b.slope.at(corner.x, corner.y) + high;
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
    Moves moves{depth, depth + gap_};
    for_pairs(first_block_, moves, [&](std::uint32_t a, std::uint32_t b, std::size_t at) {
      block(a, b, depth, out);
      if (depth > moves.from) {
        moves = {depth, depth + gap_};
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
  counts_all_ = true;
  keep_on_way(direction, depth);
  look_along(direction);
  see_boxes(0);
  Volume out;
  for_pairs(0, {0, depth + gap_}, [&](std::uint32_t a, std::uint32_t b, std::size_t) {
    if (of_outer_layers && (skins_.a.is_covered(a) || skins_.b.is_covered(b))) {
      return true;
    }
    const SeenTriangle &seen_a = see(seen_a_, skins_.a, a), &seen_b = see(seen_b_, skins_.b, b);
    Shadow shadow(seen_a, seen_b, 0, depth);
    shadow.keep_above(0);
    shadow.keep_below(depth);
    if (shadow.count > 2) {
      const double turns = (seen_a.turn > 0) == (seen_b.turn > 0) ? -1 : 1;
      const double sign = turns * skins_.a.handedness * skins_.b.handedness;
      out.volume += sign * shadow.volume();
      out.area += sign * shadow.area();
      out.total += shadow.area();
    }
    return true;
  });
  counts_all_ = false;
  return out;
}

}  // namespace spherechain

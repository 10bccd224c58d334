// SPDX-License-Identifier: MIT
// Finds triangles that may touch on the way from one pose to the next: what contacts_kernel.cpp does for one pose.
//
// Vertices go straight, but for `strays`. So for a fixed direction n, the gap between two sets of vertices,
// min n.b - max n.a, is a concave function of time: a minimum of linear functions, less a maximum of such. Where it is
// positive at the start and at the end of the step, it is positive all the time. Every test below uses this: it looks
// at the two poses alone, and widens what it compares by the strays of both sides. The tests go from cheap to dear:
//   spheres    boxes around the whole way, boxes that pass by each other, hulls along the line between their middles
//   clusters   the same boxes, spans along nine fixed directions, a plane across the line between their middles
//   triangles  boxes around the way, edges and normals (moving_blocks.h); the rest goes to the collector
#include <cstring>

#include "runtime/src/base/arithmetic.h"
#include "runtime/src/base/pair_bits.h"
#include "runtime/src/simd/simd.h"
#include "runtime/src/step/moving_skin.h"
#include "runtime/src/step/step_collector.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/src/step/step_kernel.cpp"
#include "runtime/src/clusters/bounds_on_demand.h"
#include "runtime/src/contacts/pair_list.h"
#include "runtime/src/simd/highway.h"
#include "runtime/src/step/moving_blocks.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

constexpr float kRootOfTwo = 1.4142137F;

// Writes a register of boxes, those of [i, end): each encloses the boxes at the start and at the end, `stray` wider.
HWY_INLINE void sweep_boxes(const BoxColumns& from, const BoxColumns& to, Vector stray, std::size_t i, std::size_t end,
                            const BoxColumns& out) {
  constexpr Floats kFloats;
  const auto used = hn::FirstN(kFloats, end - i);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Vector low = hn::Min(hn::LoadU(kFloats, from.low[axis] + i), hn::LoadU(kFloats, to.low[axis] + i));
    const Vector high = hn::Max(hn::LoadU(kFloats, from.high[axis] + i), hn::LoadU(kFloats, to.high[axis] + i));
    hn::BlendedStore(hn::Sub(low, stray), used, kFloats, out.low[axis] + i);
    hn::BlendedStore(hn::Add(high, stray), used, kFloats, out.high[axis] + i);
  }
}

// Bound of the rounding errors of a box' vertices and of a gap along a direction: 2^-20 of the greatest coordinate.
HWY_INLINE Vector rounding_of(const BoxColumns& boxes, std::size_t i) {
  constexpr Floats kFloats;
  Vector most = hn::Zero(kFloats);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    most = hn::Max(hn::Abs(hn::LoadU(kFloats, boxes.low[axis] + i)), most);
    most = hn::Max(hn::Abs(hn::LoadU(kFloats, boxes.high[axis] + i)), most);
  }
  return hn::IfThenElseZero(hn::Lt(most, hn::Set(kFloats, 0x1p60F)), hn::Mul(most, hn::Set(kFloats, 0x1p-20F)));
}

// Bounds all spheres at the start and at the end, and boxes around their whole way. Adds roundings to the strays.
HWY_NOINLINE void bound_ways(const MovingSkin& moving) {
  constexpr Floats kFloats;
  for (const PosedClusters* pose : {&moving.start, &moving.end}) {
    if (!pose->has_sphere_boxes) {
      if (!pose->has_hulls) {
        bound_clusters(*pose, 0, pose->sphere_count);
      }
      bound_spheres(*pose);
    }
  }
  const std::size_t end = moving.start.sphere_count;
  for (std::size_t s = 0; s < end; s += kLanes) {
    const Vector rounding = hn::Max(rounding_of(moving.start.spheres, s), rounding_of(moving.end.spheres, s));
    const Vector stray = hn::Add(hn::LoadU(kFloats, moving.strays + s), rounding);
    hn::BlendedStore(stray, hn::FirstN(kFloats, end - s), kFloats, moving.strays + s);
    sweep_boxes(moving.start.spheres, moving.end.spheres, stray, s, end, moving.spheres);
  }
}

// Makes the boxes of a sphere's clusters around the whole way, if they are not there yet.
HWY_INLINE void sweep_once(const MovingSkin& moving, std::size_t sphere) {
  if (moving.is_swept[sphere] != 0) {
    return;
  }
  moving.is_swept[sphere] = 1;
  bound_once(moving.start, sphere);
  bound_once(moving.end, sphere);
  const Vector stray = hn::Set(Floats(), moving.strays[sphere]);
  const std::size_t end = moving.start.first_cluster[sphere + 1];
  for (std::size_t i = moving.start.first_cluster[sphere]; i < end; i += kLanes) {
    sweep_boxes(moving.start.clusters, moving.end.clusters, stray, i, end, moving.clusters);
  }
}

// True if two boxes that go straight from one place to another never touch. Along each axis they overlap during one
// interval of time, for their sides move linearly; the boxes touch while all three do: from `first` to `last`. `stray`
// is large beside the roundings.
HWY_INLINE bool pass_by(const Box& start_a, const Box& end_a, const Box& start_b, const Box& end_b, float stray) {
  float first = 0, last = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float starts[2] = {start_b.high[axis] - start_a.low[axis] + stray,
                             start_a.high[axis] - start_b.low[axis] + stray};
    const float ends[2] = {end_b.high[axis] - end_a.low[axis] + stray, end_a.high[axis] - end_b.low[axis] + stray};
    for (std::size_t side = 0; side < 2; ++side) {
      if (starts[side] < 0 && ends[side] < 0) {
        return true;
      }
      if (starts[side] < 0) {
        const float at = starts[side] / (starts[side] - ends[side]);
        first = at > first ? at : first;
      } else if (ends[side] < 0) {
        const float at = starts[side] / (starts[side] - ends[side]);
        last = at < last ? at : last;
      }
    }
  }
  return first > last;
}

// Direction from box a's middle to box b's, summed over the start and the end of the step. Its length has no meaning.
HWY_INLINE void middle_direction(const Box& start_a, const Box& end_a, const Box& start_b, const Box& end_b,
                                 float (&direction)[3]) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    direction[axis] = ((start_b.low[axis] + start_b.high[axis]) - (start_a.low[axis] + start_a.high[axis])) +
                      ((end_b.low[axis] + end_b.high[axis]) - (end_a.low[axis] + end_a.high[axis]));
  }
}

HWY_INLINE float length_of(const float (&direction)[3]) {
  constexpr hn::CappedTag<float, 1> kOne;
  const float squared = (direction[0] * direction[0] + direction[1] * direction[1]) + direction[2] * direction[2];
  return hn::GetLane(hn::Sqrt(hn::Set(kOne, squared)));
}

// The gap min n.b - max n.a between two sets of points a and b along the direction n. Points are stored as x, y and z
// columns. Lanes up to a vector past the count may hold anything.
HWY_INLINE float gap_along(const float (&direction)[3], const float* const (&a)[3], std::size_t count_a,
                           const float* const (&b)[3], std::size_t count_b) {
  constexpr Floats kFloats;
  const Vector x = hn::Set(kFloats, direction[0]), y = hn::Set(kFloats, direction[1]),
               z = hn::Set(kFloats, direction[2]);
  const auto along = [&](const float* const(&p)[3], std::size_t i) HWY_ATTR {
    const Vector first = hn::Mul(x, hn::LoadU(kFloats, p[0] + i));
    return hn::MulAdd(z, hn::LoadU(kFloats, p[2] + i), hn::MulAdd(y, hn::LoadU(kFloats, p[1] + i), first));
  };
  Vector most = hn::Set(kFloats, -FLT_MAX), least = hn::Set(kFloats, FLT_MAX);
  for (std::size_t i = 0; i < count_a; i += kLanes) {
    most = hn::IfThenElse(hn::FirstN(kFloats, count_a - i), hn::Max(along(a, i), most), most);
  }
  for (std::size_t i = 0; i < count_b; i += kLanes) {
    least = hn::IfThenElse(hn::FirstN(kFloats, count_b - i), hn::Min(along(b, i), least), least);
  }
  return hn::GetLane(hn::MinOfLanes(kFloats, least)) - hn::GetLane(hn::MaxOfLanes(kFloats, most));
}

// True if one plane of constant direction separates two spheres' hulls at the start and at the end of the step. See
// hulls_apart().
HWY_INLINE bool hulls_stay_apart(const MovingSkin& moving_a, std::size_t a, const MovingSkin& moving_b, std::size_t b,
                                 float stray) {
  float direction[3];
  middle_direction(box_at(moving_a.start.spheres, a), box_at(moving_a.end.spheres, a),
                   box_at(moving_b.start.spheres, b), box_at(moving_b.end.spheres, b), direction);
  const float length = length_of(direction);
  const Hull& hull_a = moving_a.start.surface->hulls.data[a];
  const Hull& hull_b = moving_b.start.surface->hulls.data[b];
  const auto is_gap = [&](const PosedClusters& pose_a, const PosedClusters& pose_b) HWY_ATTR {
    const float* const p = pose_a.hulls + 3 * std::size_t{hull_a.first_point};
    const float* const q = pose_b.hulls + 3 * std::size_t{hull_b.first_point};
    const std::size_t m = hull_a.point_count, n = hull_b.point_count;
    const float gap = gap_along(direction, {p, p + m, p + 2 * m}, m, {q, q + n, q + 2 * n}, n);
    const float margin = pose_a.hull_margins[a] + pose_b.hull_margins[b] + stray;
    return gap > length * margin * (1 + 0x1p-20F) + kMinLength;
  };
  return is_gap(moving_a.start, moving_b.start) && is_gap(moving_a.end, moving_b.end);
}

// Bit k is set if a's sphere first + k is to be paired with b's sphere b. Within one body only spheres before b are.
HWY_INLINE std::uint64_t paired(const MovingBodies& bodies, std::size_t first, std::size_t b) {
  const PosedClusters& posed = bodies.a.start;
  std::uint64_t bits = ~std::uint64_t{0};
  if (bodies.are_one) {
    bits = ~bits_at(posed.ignored.data, posed.ignored.size, ignored_bit(first, b));
  }
  const std::size_t count = (bodies.are_one ? b : posed.sphere_count) - first;
  return bits & (~std::uint64_t{0} >> (64 - (count < 64 ? count : 64)));
}

using SpherePairs = PairList<512>;

// Appends those of the found pairs whose spheres may meet to `pairs`, and empties the list.
HWY_NOINLINE void put_spheres(const MovingBodies& bodies, SpherePairs& found, Span<Pair>& pairs) {
  const MovingSkin &moving_a = bodies.a, &moving_b = bodies.b;
  const bool have_hulls =
      moving_a.start.has_hulls && moving_a.end.has_hulls && moving_b.start.has_hulls && moving_b.end.has_hulls;
  for (std::size_t k = 0; k < found.count; ++k) {
    const auto b = static_cast<std::size_t>(found.a[k]), a = static_cast<std::size_t>(found.b[k]);
    const float stray = moving_a.strays[a] + moving_b.strays[b];
    if (pass_by(box_at(moving_a.start.spheres, a), box_at(moving_a.end.spheres, a), box_at(moving_b.start.spheres, b),
                box_at(moving_b.end.spheres, b), stray) ||
        (have_hulls && hulls_stay_apart(moving_a, a, moving_b, b, stray))) {
      continue;
    }
    pairs.data[pairs.size] = {static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b)};
    ++pairs.size;
  }
  found.count = 0;
}

// Compares each sphere of b with a register of spheres of a, by their boxes around the whole way.
void find_spheres(const MovingBodies& bodies, Span<Pair>& pairs) {
  bound_ways(bodies.a);
  if (!bodies.are_one) {
    bound_ways(bodies.b);
  }
  SpherePairs found;
  std::size_t count = 0;
  const BoxColumns boxes = bodies.a.spheres;
  for (std::size_t b = 0; b < bodies.b.start.sphere_count; ++b) {
    const BoxProbe probe(box_at(bodies.b.spheres, b));
    const std::size_t end = bodies.are_one ? b : bodies.a.start.sphere_count;
    std::uint64_t bits = 0;
    for (std::size_t first = 0; first < end; first += kLanes, bits >>= kLanes) {
      if (first % 64 == 0) {
        bits = paired(bodies, first, b);
      }
      count = found.put(count, b, first, hn::AndNot(probe.misses(boxes, first), mask_of(bits)));
      if (!found.has_room(count)) {
        found.count = count;
        put_spheres(bodies, found, pairs);
        count = 0;
      }
    }
  }
  found.count = count;
  put_spheres(bodies, found, pairs);
}

// True if the two clusters' spans along one direction are disjoint at the start and at the end, in the same order.
HWY_INLINE bool spans_stay_apart(const MovingBodies& bodies, std::size_t a, std::size_t b, float stray) {
  constexpr hn::CappedTag<float, kSpanLanes> d;
  const auto wide = hn::Set(d, stray * kRootOfTwo * (1 + 0x1p-20F));  // the diagonals' length
  const auto span = [&](const PosedClusters& posed, std::size_t cluster)
                        HWY_ATTR { return posed.spans + 2 * kSpanLanes * cluster; };
  const float *const a0 = span(bodies.a.start, a), *const a1 = span(bodies.a.end, a),
                     *const b0 = span(bodies.b.start, b), *const b1 = span(bodies.b.end, b);
  for (std::size_t k = 0; k < kSpanLanes; k += hn::MaxLanes(d)) {
    const auto above = [&](const float* one, const float* other) HWY_ATTR {  // one above the other
      return hn::Gt(hn::LoadU(d, one + k), hn::Add(hn::LoadU(d, other + kSpanLanes + k), wide));
    };
    const auto apart = hn::Or(hn::And(above(a0, b0), above(a1, b1)), hn::And(above(b0, a0), above(b1, a1)));
    if (!hn::AllFalse(d, apart)) {
      return true;
    }
  }
  return false;
}

// True if a plane across the line between two clusters separates them at the start and at the end.
HWY_NOINLINE bool plane_stays_between(const MovingBodies& bodies, std::size_t a, std::size_t b, float stray) {
  float direction[3];
  middle_direction(box_of_span(bodies.a.start, a), box_of_span(bodies.a.end, a), box_of_span(bodies.b.start, b),
                   box_of_span(bodies.b.end, b), direction);
  const float least = length_of(direction) * stray * (1 + 0x1p-20F) + 0x1p-100F;
  const auto is_gap = [&](const PosedClusters& posed_a, const PosedClusters& posed_b) HWY_ATTR {
    const Slots p = slots_of(posed_a, a), q = slots_of(posed_b, b);
    return gap_along(direction, {p.axes[0], p.axes[1], p.axes[2]}, p.count, {q.axes[0], q.axes[1], q.axes[2]},
                     q.count) > least;
  };
  return is_gap(bodies.a.start, bodies.b.start) && is_gap(bodies.a.end, bodies.b.end);
}

using PlacePairs = PairList<kLanes * kLanes>;

// Lists the pairs of triangles from two registers whose boxes touch. A box encloses its triangle during the whole step.
HWY_INLINE void find_places(const MovingBlock& block, const MovingBlock& other, std::size_t i, std::size_t j,
                            PlacePairs& out) {
  constexpr Floats kFloats;
  const std::size_t end = block.count - i < kLanes ? block.count : i + kLanes;
  const auto used = hn::FirstN(kFloats, other.count - j);
  std::size_t count = 0;
  for (std::size_t one = i; one < end; ++one) {
    count = out.put(count, one - i, 0, hn::AndNot(BoxProbe(box_at(block, one)).misses(other, j), used));
  }
  out.count = count;
  out.finish();
}

// Hands all pairs of triangles of two blocks to the collector that no separating direction keeps apart.
HWY_NOINLINE void pair_blocks(const MovingBodies& bodies, const MovingBlock& block, const MovingBlock& other,
                              float stray, StepCollector& collector) {
  PlacePairs places;
  for (std::size_t i = 0; i < block.count; i += kLanes) {
    for (std::size_t j = 0; j < other.count; j += kLanes) {
      find_places(block, other, i, j, places);
      for (std::size_t k = 0; k < places.count; k += kLanes) {
        const std::size_t left = places.count - k;
        std::uint64_t bits = ~std::uint64_t{0} >> (64 - (left < kLanes ? left : kLanes));
        bits &= ~stay_apart(GatheredMovingTriangles(block, i, places.a + k),
                            GatheredMovingTriangles(other, j, places.b + k), stray);
        for (; bits != 0; bits &= bits - 1) {
          const std::size_t lane = lowest_bit(bits);
          const std::size_t one = i + static_cast<std::size_t>(places.a[k + lane]);
          const std::size_t two = j + static_cast<std::size_t>(places.b[k + lane]);
          collector.decide({block.cluster,
                            other.cluster,
                            block.triangles[one],
                            other.triangles[two],
                            stray,
                            {corners_of(bodies.a.start, block, one), corners_of(bodies.a.end, block, one)},
                            {corners_of(bodies.b.start, other, two), corners_of(bodies.b.end, other, two)}});
        }
      }
    }
  }
}

// Returns false if a cluster has no shape at the start or at the end.
HWY_INLINE bool load_both(const MovingSkin& moving, std::size_t cluster) {
  const auto has_shape = [&](const PosedClusters& pose) HWY_ATTR {
    if (pose.is_loaded[cluster] == 0) {
      load(pose, cluster);
    }
    const Box box = box_of_span(pose, cluster);
    return box.low[0] <= box.high[0];
  };
  return has_shape(moving.start) && has_shape(moving.end);
}

// Returns false only if no triangles of two clusters can touch during the step.
HWY_NOINLINE bool may_touch(const MovingBodies& bodies, std::size_t a, std::size_t b, float stray) {
  return !pass_by(box_at(bodies.a.start.clusters, a), box_at(bodies.a.end.clusters, a),
                  box_at(bodies.b.start.clusters, b), box_at(bodies.b.end.clusters, b), stray) &&
         load_both(bodies.a, a) && load_both(bodies.b, b) && !spans_stay_apart(bodies, a, b, stray) &&
         !plane_stays_between(bodies, a, b, stray);
}

// Lists the pairs of clusters of two spheres that may touch. False: the list is full.
bool find_clusters(const MovingBodies& bodies, Span<const Pair> spheres, MovingClusters& found) {
  for (std::size_t k = 0; k < spheres.size; ++k) {
    const std::size_t a = spheres.data[k].a, b = spheres.data[k].b;
    const float stray = bodies.a.strays[a] + bodies.b.strays[b];
    sweep_once(bodies.a, a);
    sweep_once(bodies.b, b);
    const std::size_t end_a = bodies.a.start.first_cluster[a + 1], first_b = bodies.b.start.first_cluster[b],
                      end_b = bodies.b.start.first_cluster[b + 1];
    const BoxProbe probe_b(box_at(bodies.b.spheres, b));
    for (std::size_t i = bodies.a.start.first_cluster[a]; i < end_a; i += kLanes) {
      for (std::uint64_t of_a = probe_b.touching(bodies.a.clusters, i, end_a - i); of_a != 0; of_a &= of_a - 1) {
        const std::size_t one = i + lowest_bit(of_a);
        const BoxProbe probe(box_at(bodies.a.clusters, one));
        for (std::size_t j = first_b; j < end_b; j += kLanes) {
          const std::uint64_t layers = bodies.are_one ? layers_of(*bodies.a.start.surface, one, j) : 0;
          for (std::uint64_t of_b = probe.touching(bodies.b.clusters, j, end_b - j) & ~layers; of_b != 0;
               of_b &= of_b - 1) {
            const std::size_t other = j + lowest_bit(of_b);
            if (may_touch(bodies, one, other, stray) && !found.put(one, other)) {
              return false;
            }
          }
        }
      }
    }
  }
  return true;
}

// Loads the triangles of two clusters that reach into each other's way, and pairs them. Both are seen from a frame that
// drifts with them (Drift), so that a shared motion widens no box.
void find_triangles(const MovingBodies& bodies, Span<const Pair> clusters, StepCollector& collector) {
  for (std::size_t k = 0; k < clusters.size; ++k) {
    const std::size_t a = clusters.data[k].a, b = clusters.data[k].b;
    if (collector.is_settled(a, b)) {
      continue;
    }
    const float stray = bodies.a.strays[bodies.a.start.surface->clusters.data[a].sphere] +
                        bodies.b.strays[bodies.b.start.surface->clusters.data[b].sphere];
    const Drift drift(box_of_span(bodies.a.start, a), box_of_span(bodies.a.end, a), box_of_span(bodies.b.start, b),
                      box_of_span(bodies.b.end, b));
    MovingBlock block, other;
    if (load_moving_block(bodies.a, a, way_of_spans(bodies.b, b, drift, stray), drift, stray, block) &&
        load_moving_block(bodies.b, b, block.box, drift, 0, other)) {
      pair_blocks(bodies, block, other, stray, collector);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace spherechain {
namespace {

SPHERECHAIN_KERNELS(find_spheres);
SPHERECHAIN_KERNELS(find_clusters);
SPHERECHAIN_KERNELS(find_triangles);

}  // namespace

void find_moving_spheres(Target resolved, const MovingBodies& bodies, Span<Pair>& pairs) {
  pairs.size = 0;
  find_spheres_kernels[index_of(resolved)](bodies, pairs);
}

bool find_moving_clusters(Target resolved, const MovingBodies& bodies, Span<const Pair> spheres,
                          MovingClusters& found) {
  return find_clusters_kernels[index_of(resolved)](bodies, spheres, found);
}

void find_moving_candidates(Target resolved, const MovingBodies& bodies, Span<const Pair> clusters,
                            StepCollector& collector) {
  find_triangles_kernels[index_of(resolved)](bodies, clusters, collector);
}

}  // namespace spherechain
#endif

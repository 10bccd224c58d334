// SPDX-License-Identifier: MIT
// The vertices of a cluster, in its slots.
#include "runtime/src/simd/highway.h"

#if defined(SPHERECHAIN_SKIN_SLOTS_H) == defined(HWY_TARGET_TOGGLE)  // once a target
#ifdef SPHERECHAIN_SKIN_SLOTS_H
#undef SPHERECHAIN_SKIN_SLOTS_H
#else
#define SPHERECHAIN_SKIN_SLOTS_H
#endif

#include <cfloat>

#include "runtime/src/clusters/boxes.h"
#include "runtime/src/clusters/posed_clusters.h"
#include "runtime/src/skin/skin_cluster.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

// Where a cluster's skinned vertices are.
struct Slots {
  float* axes[3];
  std::size_t count;
};

// Each axis starts at a multiple of kContactPadding floats. A cluster's slots, a multiple of half of that, are rounded
// up to one: half of it for each cluster before is room enough.
HWY_INLINE Slots slots_of(const PosedClusters& posed, std::size_t cluster_index) {
  static_assert(2 * kSlotLanes == kContactPadding, "half of it");
  constexpr std::size_t kWhole = kContactPadding;
  const Cluster& cluster = posed.surface->clusters.data[cluster_index];
  const std::size_t room = (cluster.vertex_count + kWhole - 1) / kWhole * kWhole;
  const std::size_t place = (cluster.first_slot + kSlotLanes * cluster_index + kWhole - 1) / kWhole * kWhole;
  float* first = posed.slots + 3 * place;
  return {{first, first + room, first + 2 * room}, (cluster.vertex_count + kSlotLanes - 1) / kSlotLanes * kSlotLanes};
}

#if HWY_TARGET == HWY_SCALAR

HWY_INLINE void copy_vertices(const PosedClusters& posed, const Cluster& cluster, const Slots& slots) {
  const std::uint32_t* vertices = posed.surface->cluster_vertices.data + cluster.first_vertex;
  const std::uint32_t* source = posed.surface->source_vertices.data;
  for (std::size_t i = 0; i < cluster.vertex_count; ++i) {
    const float* p = posed.positions + source[vertices[i]] * posed.stride;
    slots.axes[0][i] = p[0];
    slots.axes[1][i] = p[1];
    slots.axes[2][i] = p[2];
  }
  for (std::size_t i = cluster.vertex_count; i < slots.count; ++i) {
    for (float* axis : slots.axes) {
      axis[i] = axis[i - 1];
    }
  }
}

#else

// Four at a time, turned; the slots beyond the vertices repeat the last one.
HWY_INLINE void copy_vertices(const PosedClusters& posed, const Cluster& cluster, const Slots& slots) {
  constexpr hn::CappedTag<float, 4> kFour;
  const std::uint32_t* vertices = posed.surface->cluster_vertices.data + cluster.first_vertex;
  const std::uint32_t* source = posed.surface->source_vertices.data;
  const std::size_t last = cluster.vertex_count - std::size_t{1};
  const auto vertex = [&](std::size_t i) HWY_ATTR {
    return load_position(posed.positions + source[vertices[i < last ? i : last]] * posed.stride);
  };
  for (std::size_t i = 0; i < slots.count; i += 4) {
    const auto a = vertex(i), b = vertex(i + 1), c = vertex(i + 2), d = vertex(i + 3);
    const auto xy_ac = hn::InterleaveLower(kFour, a, c), xy_bd = hn::InterleaveLower(kFour, b, d);
    const auto z_ac = hn::InterleaveUpper(kFour, a, c), z_bd = hn::InterleaveUpper(kFour, b, d);
    hn::Store(hn::InterleaveLower(kFour, xy_ac, xy_bd), kFour, slots.axes[0] + i);
    hn::Store(hn::InterleaveUpper(kFour, xy_ac, xy_bd), kFour, slots.axes[1] + i);
    hn::Store(hn::InterleaveLower(kFour, z_ac, z_bd), kFour, slots.axes[2] + i);
  }
}

#endif

struct Lesser {
  template <class V>
  HWY_INLINE V operator()(V a, V b) const {
    return hn::Min(a, b);
  }
};
struct Greater {
  template <class V>
  HWY_INLINE V operator()(V a, V b) const {
    return hn::Max(a, b);
  }
};

// Reduces the lanes of each of four vectors to one value.
template <class Reduce>
HWY_INLINE void reduce_four(const Vector* in, const Reduce& reduce, float* out) {
#if HWY_TARGET == HWY_SCALAR
  (void)reduce;
  for (std::size_t k = 0; k < 4; ++k) {
    out[k] = hn::GetLane(in[k]);
  }
#else
  constexpr Floats kFloats;
  constexpr hn::RepartitionToWide<hn::Rebind<std::uint32_t, Floats> > kPairs;
  const auto two = [&](Vector a, Vector b) HWY_ATTR {
    return hn::BitCast(kPairs, reduce(hn::InterleaveLower(kFloats, a, b), hn::InterleaveUpper(kFloats, a, b)));
  };
  const auto ab = two(in[0], in[1]), cd = two(in[2], in[3]);
  const Vector blocks = reduce(hn::BitCast(kFloats, hn::InterleaveLower(kPairs, ab, cd)),
                               hn::BitCast(kFloats, hn::InterleaveUpper(kPairs, ab, cd)));
#if HWY_TARGET == HWY_AVX3
  constexpr hn::CappedTag<float, 8> kHalf;
  constexpr hn::CappedTag<float, 4> kFour;
  const auto half = reduce(hn::LowerHalf(kHalf, blocks), hn::UpperHalf(kHalf, blocks));
  hn::StoreU(reduce(hn::LowerHalf(kFour, half), hn::UpperHalf(kFour, half)), kFour, out);
#elif HWY_TARGET == HWY_AVX2
  constexpr hn::CappedTag<float, 4> kFour;
  hn::StoreU(reduce(hn::LowerHalf(kFour, blocks), hn::UpperHalf(kFour, blocks)), kFour, out);
#else
  hn::StoreU(blocks, kFloats, out);
#endif
#endif
}

HWY_INLINE void put_span(const PosedClusters& posed, std::size_t cluster_index) {
  constexpr Floats kFloats;
  constexpr std::size_t kWhole = (kDirections + 3) / 4 * 4;
  static_assert(kWhole + 4 == kSpanLanes, "the last four come twice");
  const Slots slots = slots_of(posed, cluster_index);
  Vector low[kWhole], high[kWhole];
  for (std::size_t k = 0; k < kWhole; ++k) {
    low[k] = hn::Set(kFloats, FLT_MAX);
    high[k] = hn::Set(kFloats, -FLT_MAX);
  }
  for (std::size_t i = 0; i < slots.count; i += kLanes) {
    // Lanes beyond the slots are given slot 0.
    const auto used = hn::FirstN(kFloats, slots.count - i);
    const auto column = [&](std::size_t axis) HWY_ATTR {
      return hn::IfThenElse(used, hn::LoadU(kFloats, slots.axes[axis] + i), hn::Set(kFloats, slots.axes[axis][0]));
    };
    const Vector x = column(0), y = column(1), z = column(2);
    const Vector along[kDirections] = {
        x, y, z, hn::Add(x, y), hn::Add(y, z), hn::Add(z, x), hn::Sub(x, y), hn::Sub(y, z), hn::Sub(z, x)};
    for (std::size_t k = 0; k < kDirections; ++k) {
      low[k] = hn::Min(along[k], low[k]);
      high[k] = hn::Max(along[k], high[k]);
    }
  }
  for (std::size_t k = kDirections; k < kWhole; ++k) {
    low[k] = low[0];
    high[k] = high[0];
  }
  float* const out = posed.spans + 2 * kSpanLanes * cluster_index;
  for (std::size_t k = 0; k < kSpanLanes; k += 4) {
    const std::size_t from = k < kWhole ? k : kWhole - 4;
    reduce_four(low + from, Lesser(), out + k);
    reduce_four(high + from, Greater(), out + kSpanLanes + k);
  }
}

// A cluster shrunk to a point, or to a line along an axis, has only degenerate triangles, which intersect nothing: it
// reaches nowhere. In a pose that takes all to one point each cluster would be paired with each. Half of kPointSize: a
// triangle's greatest coordinate may be a little less than the cluster's.
HWY_INLINE void drop_point(const PosedClusters& posed, std::size_t cluster_index) {
  float* const low = posed.spans + 2 * kSpanLanes * cluster_index;
  float* const high = low + kSpanLanes;
  const int flat_axes = (low[0] >= high[0] ? 1 : 0) + (low[1] >= high[1] ? 1 : 0) + (low[2] >= high[2] ? 1 : 0);
  if (flat_axes >= 2 || is_within({{low[0], low[1], low[2]}, {high[0], high[1], high[2]}}, kPointSize / 2)) {
    for (std::size_t k = 0; k < kSpanLanes; ++k) {
      low[k] = FLT_MAX;
      high[k] = -FLT_MAX;
    }
  }
}

// Where they are not yet: a cluster's vertices, from the source's or from the bones, and how far they reach.
inline HWY_NOINLINE void load(const PosedClusters& posed, std::size_t cluster_index) {
  posed.is_loaded[cluster_index] = 1;
  const Cluster& cluster = posed.surface->clusters.data[cluster_index];
  const Slots slots = slots_of(posed, cluster_index);
  if (posed.positions != nullptr) {
    copy_vertices(posed, cluster, slots);
  } else {
    skin_cluster(posed.skin, cluster, slots.axes[0], slots.axes[1], slots.axes[2]);
  }
  put_span(posed, cluster_index);
  drop_point(posed, cluster_index);
}

HWY_INLINE Box box_of_span(const PosedClusters& posed, std::size_t cluster_index) {
  const float* const low = posed.spans + 2 * kSpanLanes * cluster_index;
  const float* const high = low + kSpanLanes;
  return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
}

// Do two clusters that are loaded reach as far as each other in all directions? A sum rounded once keeps the order of
// the sums themselves, so nothing that touches is kept apart.
HWY_INLINE bool spans_touch(const PosedClusters& posed_a, std::size_t a, const PosedClusters& posed_b, std::size_t b) {
  constexpr hn::CappedTag<float, kSpanLanes> d;
  const float* const one = posed_a.spans + 2 * kSpanLanes * a;
  const float* const other = posed_b.spans + 2 * kSpanLanes * b;
  auto apart = hn::Gt(hn::LoadU(d, one), hn::LoadU(d, other + kSpanLanes));
  apart = hn::Or(apart, hn::Gt(hn::LoadU(d, other), hn::LoadU(d, one + kSpanLanes)));
  for (std::size_t k = hn::MaxLanes(d); k < kSpanLanes; k += hn::MaxLanes(d)) {
    apart = hn::Or(apart, hn::Gt(hn::LoadU(d, one + k), hn::LoadU(d, other + kSpanLanes + k)));
    apart = hn::Or(apart, hn::Gt(hn::LoadU(d, other + k), hn::LoadU(d, one + kSpanLanes + k)));
  }
  return hn::AllFalse(d, apart);
}

// Does a plane across the line of the middles of two clusters that are loaded part their vertices? Of the two sums of
// three products each rounding is a unit in the last place of at most the sums of magnitudes, and eight are counted.
inline HWY_NOINLINE bool plane_parts(const PosedClusters& posed_a, std::size_t a, const PosedClusters& posed_b,
                                     std::size_t b) {
  constexpr Floats kFloats;
  const Box box_a = box_of_span(posed_a, a), box_b = box_of_span(posed_b, b);
  float direction[3], size = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float low = box_a.low[axis] < box_b.low[axis] ? box_a.low[axis] : box_b.low[axis];
    const float high = box_a.high[axis] > box_b.high[axis] ? box_a.high[axis] : box_b.high[axis];
    const float extent = -low > high ? -low : high;
    const float along = (box_b.low[axis] + box_b.high[axis]) - (box_a.low[axis] + box_a.high[axis]);
    direction[axis] = along;
    size += (along < 0 ? -along : along) * extent;
  }
  const auto farthest = [&](const PosedClusters& posed, std::size_t cluster, float sign) HWY_ATTR {
    const Slots slots = slots_of(posed, cluster);
    const Vector x = hn::Set(kFloats, sign * direction[0]), y = hn::Set(kFloats, sign * direction[1]),
                 z = hn::Set(kFloats, sign * direction[2]);
    Vector most = hn::Set(kFloats, -FLT_MAX);
    for (std::size_t i = 0; i < slots.count; i += kLanes) {
      const Vector first = hn::Mul(x, hn::LoadU(kFloats, slots.axes[0] + i));
      const Vector along = hn::MulAdd(z, hn::LoadU(kFloats, slots.axes[2] + i),
                                      hn::MulAdd(y, hn::LoadU(kFloats, slots.axes[1] + i), first));
      most = hn::IfThenElse(hn::FirstN(kFloats, slots.count - i), hn::Max(along, most), most);
    }
    return hn::GetLane(hn::MaxOfLanes(kFloats, most));
  };
  return farthest(posed_a, a, 1) + farthest(posed_b, b, -1) < -(size * 0x1p-20F + 0x1p-100F);
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#endif

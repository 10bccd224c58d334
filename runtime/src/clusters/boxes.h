// SPDX-License-Identifier: MIT
// Boxes and balls around spheres and clusters, and what they keep apart.
#include "runtime/src/simd/highway.h"

#if defined(SPHERECHAIN_SKIN_BOXES_H) == defined(HWY_TARGET_TOGGLE)  // once a target
#ifdef SPHERECHAIN_SKIN_BOXES_H
#undef SPHERECHAIN_SKIN_BOXES_H
#else
#define SPHERECHAIN_SKIN_BOXES_H
#endif

#include <cfloat>

#include "runtime/src/base/pair_bits.h"
#include "runtime/src/clusters/posed_clusters.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

using Floats = hn::ScalableTag<float>;
using Vector = hn::Vec<Floats>;
constexpr std::size_t kLanes = hn::MaxLanes(Floats());
static_assert(kLanes <= kContactPadding, "the padding is a vector");

struct Box {
  float low[3], high[3];

  bool touches(const Box& other) const {
    bool apart = false;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      apart |= low[axis] > other.high[axis] || other.low[axis] > high[axis];
    }
    return !apart;
  }
};

constexpr Box kEmptyBox{{FLT_MAX, FLT_MAX, FLT_MAX}, {-FLT_MAX, -FLT_MAX, -FLT_MAX}};

// Is a box that is finite and not empty no larger than that share of its greatest coordinate?
HWY_INLINE bool is_within(const Box& box, float share) {
  float most = 0, extent = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float reach = -box.low[axis] > box.high[axis] ? -box.low[axis] : box.high[axis];
    const float size = box.high[axis] - box.low[axis];
    most = reach > most ? reach : most;
    extent = size > extent ? size : extent;
  }
  return most <= FLT_MAX && extent <= share * most && box.low[0] <= box.high[0];
}

// Takes BoxColumns, or any type with `low` and `high` by axis.
template <class Columns>
HWY_INLINE Box box_at(const Columns& columns, std::size_t i) {
  Box box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.low[axis] = columns.low[axis][i];
    box.high[axis] = columns.high[axis][i];
  }
  return box;
}

HWY_INLINE void put_box(const BoxColumns& columns, std::size_t i, const Box& box) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    columns.low[axis][i] = box.low[axis];
    columns.high[axis][i] = box.high[axis];
  }
}

// A box against those of a vector: a NaN keeps no box apart.
struct BoxProbe {
  Vector low[3], high[3];

  HWY_INLINE explicit BoxProbe(const Box& box) {
    constexpr Floats kFloats;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = hn::Set(kFloats, box.low[axis]);
      high[axis] = hn::Set(kFloats, box.high[axis]);
    }
  }
  template <class Columns>
  HWY_INLINE hn::Mask<Floats> misses(const Columns& columns, std::size_t i) const {
    constexpr Floats kFloats;
    auto out = hn::Gt(low[0], hn::LoadU(kFloats, columns.high[0] + i));
    out = hn::Or(out, hn::Lt(high[0], hn::LoadU(kFloats, columns.low[0] + i)));
    for (std::size_t axis = 1; axis < 3; ++axis) {
      out = hn::Or(out, hn::Gt(low[axis], hn::LoadU(kFloats, columns.high[axis] + i)));
      out = hn::Or(out, hn::Lt(high[axis], hn::LoadU(kFloats, columns.low[axis] + i)));
    }
    return out;
  }
  // Bit k: box i + k touches; `count` boxes are left.
  HWY_INLINE std::uint64_t touching(const BoxColumns& columns, std::size_t i, std::size_t count) const {
    if (count == 0) {
      return 0;
    }
    const std::uint64_t lanes = ~std::uint64_t{0} >> (64 - (count < kLanes ? count : kLanes));
    return ~bits_of(misses(columns, i)) & lanes;
  }
};

#if HWY_TARGET == HWY_SCALAR

HWY_INLINE Box box_of_cluster(const PosedClusters& posed, const Cluster& cluster) {
  const std::uint32_t* source = posed.surface->source_vertices.data;
  Box box{{FLT_MAX, FLT_MAX, FLT_MAX}, {-FLT_MAX, -FLT_MAX, -FLT_MAX}};
  const std::uint32_t* vertices = posed.surface->cluster_vertices.data + cluster.first_vertex;
  for (std::size_t i = 0; i < cluster.vertex_count; ++i) {
    const float* p = posed.positions + source[vertices[i]] * posed.stride;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box.low[axis] = p[axis] < box.low[axis] ? p[axis] : box.low[axis];
      box.high[axis] = p[axis] > box.high[axis] ? p[axis] : box.high[axis];
    }
  }
  return box;
}

#else

// The fourth lane is 0. Where there are no masked loads of its own, Highway's reads the fourth float, and wants p
// aligned.
HWY_INLINE hn::Vec<hn::CappedTag<float, 4> > load_position(const float* p) {
  constexpr hn::CappedTag<float, 4> kFour;
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3
  return hn::MaskedLoad(hn::FirstN(kFour, 3), kFour, p);
#else
  HWY_ALIGN const float lanes[4] = {p[0], p[1], p[2], 0};
  return hn::Load(kFour, lanes);
#endif
}

// Four at a time, for the minima of one wait for each other. A position is loaded as three lanes: after the last one of
// the buffer may be no more memory.
HWY_INLINE Box box_of_cluster(const PosedClusters& posed, const Cluster& cluster) {
  constexpr hn::CappedTag<float, 4> kFour;
  constexpr std::size_t kAtATime = 4;
  hn::Vec<hn::CappedTag<float, 4> > low[kAtATime], high[kAtATime];
  for (std::size_t k = 0; k < kAtATime; ++k) {
    low[k] = hn::Set(kFour, FLT_MAX);
    high[k] = hn::Set(kFour, -FLT_MAX);
  }
  const std::uint32_t* vertices = posed.surface->cluster_vertices.data + cluster.first_vertex;
  const std::uint32_t* source = posed.surface->source_vertices.data;
  const float* positions = posed.positions;
  const std::size_t stride = posed.stride, count = cluster.vertex_count;
  std::size_t i = 0;
  for (; i + kAtATime <= count; i += kAtATime) {
    for (std::size_t k = 0; k < kAtATime; ++k) {
      const auto p = load_position(positions + source[vertices[i + k]] * stride);
      low[k] = hn::Min(p, low[k]);
      high[k] = hn::Max(p, high[k]);
    }
  }
  for (; i < count; ++i) {
    const auto p = load_position(positions + source[vertices[i]] * stride);
    low[0] = hn::Min(p, low[0]);
    high[0] = hn::Max(p, high[0]);
  }
  HWY_ALIGN float lows[4], highs[4];
  hn::Store(hn::Min(hn::Min(low[0], low[1]), hn::Min(low[2], low[3])), kFour, lows);
  hn::Store(hn::Max(hn::Max(high[0], high[1]), hn::Max(high[2], high[3])), kFour, highs);
  return {{lows[0], lows[1], lows[2]}, {highs[0], highs[1], highs[2]}};
}

#endif

// A sphere's box around those of its clusters.
HWY_INLINE void unite_clusters(const PosedClusters& posed, std::size_t sphere) {
  constexpr Floats kFloats;
  const std::size_t end = posed.first_cluster[sphere + 1];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vector low = hn::Set(kFloats, FLT_MAX), high = hn::Set(kFloats, -FLT_MAX);
    for (std::size_t i = posed.first_cluster[sphere]; i < end; i += kLanes) {
      const auto used = hn::FirstN(kFloats, end - i);
      low = hn::IfThenElse(used, hn::Min(hn::LoadU(kFloats, posed.clusters.low[axis] + i), low), low);
      high = hn::IfThenElse(used, hn::Max(hn::LoadU(kFloats, posed.clusters.high[axis] + i), high), high);
    }
    posed.spheres.low[axis][sphere] = hn::GetLane(hn::MinOfLanes(kFloats, low));
    posed.spheres.high[axis][sphere] = hn::GetLane(hn::MaxOfLanes(kFloats, high));
  }
}

// A ball against those of a vector: those that it surely does not touch. A share of 2^-20 of a sum of squares of
// rounded differences is more than all roundings.
struct BallProbe {
  Vector center[3], radius;

  HWY_INLINE BallProbe(const PosedClusters& posed, std::size_t cluster) {
    constexpr Floats kFloats;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      center[axis] = hn::Set(kFloats, posed.ball_columns[axis][cluster]);
    }
    radius = hn::Set(kFloats, posed.ball_columns[3][cluster]);
  }
  HWY_INLINE hn::Mask<Floats> misses(const PosedClusters& posed, std::size_t i) const {
    constexpr Floats kFloats;
    const Vector x = hn::Sub(hn::LoadU(kFloats, posed.ball_columns[0] + i), center[0]);
    const Vector y = hn::Sub(hn::LoadU(kFloats, posed.ball_columns[1] + i), center[1]);
    const Vector z = hn::Sub(hn::LoadU(kFloats, posed.ball_columns[2] + i), center[2]);
    const Vector reach = hn::Add(hn::LoadU(kFloats, posed.ball_columns[3] + i), radius);
    const Vector squared = hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
    const Vector most = hn::Mul(hn::Mul(reach, reach), hn::Set(kFloats, 1 + 0x1p-20F));
    return hn::Gt(squared, most);
  }
};

// Bit k: cluster first + k and `cluster` are layers of one place, or one of them is buried.
HWY_INLINE std::uint64_t layers_of(const Surface& surface, std::size_t cluster, std::size_t first) {
  if ((surface.buried.data[cluster / 64] >> cluster % 64 & 1) != 0) {
    return ~std::uint64_t{0};
  }
  std::uint64_t bits = bits_at(surface.buried.data, surface.buried.size, first);
  const auto word = static_cast<std::uint32_t>(first / 64);
  const std::uint32_t end = surface.first_of_layers.data[cluster + 1];
  for (std::uint32_t i = surface.first_of_layers.data[cluster]; i < end; ++i) {
    const std::uint32_t at = surface.layer_words.data[i];
    bits |= at == word                          ? surface.layer_bits.data[i] >> first % 64
            : at == word + 1 && first % 64 != 0 ? surface.layer_bits.data[i] << (64 - first % 64)
                                                : 0;
  }
  return bits;
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#endif

// SPDX-License-Identifier: MIT
// The triangles of a cluster that could touch a box.
#include "runtime/src/simd/highway.h"

#if defined(SPHERECHAIN_SKIN_BLOCKS_H) == defined(HWY_TARGET_TOGGLE)  // once a target
#ifdef SPHERECHAIN_SKIN_BLOCKS_H
#undef SPHERECHAIN_SKIN_BLOCKS_H
#else
#define SPHERECHAIN_SKIN_BLOCKS_H
#endif

#include <cfloat>
#include <cstring>

#include "runtime/src/base/pair_bits.h"
#include "runtime/src/clusters/posed_clusters.h"
#include "runtime/src/clusters/slots.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

constexpr std::size_t kBlock = kMaxClusterTriangles;  // a bit each
static_assert(kBlock == 64);

// One code for each vertex of the cluster: a bit for each side of the box that the vertex lies beyond. At least 16
// codes, and a vector more than there are vertices, can be written and read.
using Codes = std::uint8_t[256 + 64];

HWY_INLINE void find_sides(const PosedClusters& posed, std::size_t cluster_index, const BoxProbe& box, Codes& codes) {
  constexpr Floats kFloats;
  const hn::Rebind<std::int32_t, Floats> integers;
  const hn::Rebind<std::uint8_t, Floats> bytes;
  const Slots slots = slots_of(posed, cluster_index);
  for (std::size_t i = 0; i < slots.count; i += kLanes) {
    auto code = hn::Zero(integers);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Vector p = hn::LoadU(kFloats, slots.axes[axis] + i);
      const auto below = hn::Set(integers, 1 << (2 * axis)), above = hn::Set(integers, 2 << (2 * axis));
      code = hn::Or(code, hn::IfThenElseZero(hn::RebindMask(integers, hn::Lt(p, box.low[axis])), below));
      code = hn::Or(code, hn::IfThenElseZero(hn::RebindMask(integers, hn::Gt(p, box.high[axis])), above));
    }
    hn::StoreU(hn::DemoteTo(bytes, code), bytes, codes + i);
  }
}

#if HWY_TARGET == HWY_SCALAR

// A bit for each of the triangles with these corners, at most kBlock, that does not lie entirely beyond one side.
HWY_INLINE std::uint64_t within(const std::uint8_t* corners, std::size_t count, std::size_t, const Codes& codes) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const int beyond = codes[corners[3 * i]] & codes[corners[3 * i + 1]] & codes[corners[3 * i + 2]];
    bits |= std::uint64_t{beyond == 0} << i;
  }
  return bits;
}

#else

// The same, a byte a triangle: codes are looked up in tables of sixteen. Reads 3 * kBlock bytes whatever the count.
HWY_INLINE std::uint64_t within(const std::uint8_t* corners, std::size_t count, std::size_t vertex_count,
                                const Codes& codes) {
  constexpr hn::CappedTag<std::uint8_t, kBlock> kBytes;
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < count; i += hn::MaxLanes(kBytes)) {
    hn::Vec<hn::CappedTag<std::uint8_t, kBlock> > corner[3];
    hn::LoadInterleaved3(kBytes, corners + 3 * i, corner[0], corner[1], corner[2]);
    auto beyond = hn::Set(kBytes, std::uint8_t{0xFF});
    for (std::size_t k = 0; k < 3; ++k) {
      auto code = hn::Zero(kBytes);
      const auto table = hn::And(corner[k], hn::Set(kBytes, std::uint8_t{0xF0}));
      const auto place = hn::And(corner[k], hn::Set(kBytes, std::uint8_t{0x0F}));
      for (std::size_t first = 0; first < vertex_count; first += 16) {
        const auto found = hn::TableLookupBytes(hn::LoadDup128(kBytes, codes + first), place);
        const auto is_here = hn::Eq(table, hn::Set(kBytes, static_cast<std::uint8_t>(first)));
        code = hn::Or(code, hn::IfThenElseZero(is_here, found));
      }
      beyond = hn::And(beyond, code);
    }
    std::uint64_t some = 0;
    hn::StoreMaskBits(kBytes, hn::Eq(beyond, hn::Zero(kBytes)), reinterpret_cast<std::uint8_t*>(&some));
    bits |= some << i;
  }
  return bits & (~std::uint64_t{0} >> (64 - count));
}

#endif

// Triangles of a cluster, coordinate by coordinate. Spare lanes up to a vector are dirt.
struct Block {
  std::size_t cluster, count;
  std::uint32_t triangles[kBlock + kContactPadding];  // in AssetView::triangles()
  float corners[3][3][kBlock + kContactPadding];      // by corner, by axis
  float low[3][kBlock + kContactPadding], high[3][kBlock + kContactPadding];
  Box box;                                           // of all
  std::uint32_t welds[3][kBlock + kContactPadding];  // the corners'; only where neighbours are paired

  TriangleCorners corners_of(std::size_t i) const {
    TriangleCorners out;
    for (std::size_t k = 0; k < 3; ++k) {
      out.p[k] = {corners[k][0][i], corners[k][1][i], corners[k][2][i]};
    }
    return out;
  }
};

// Lane k: triangle i + k has two corners in one place, is a point but for rounding (is_point()), or is not finite: else
// exact arithmetic would have to tell, pair by pair. `low`, `high`: its box.
HWY_INLINE hn::Mask<Floats> without_shape(const float (&corners)[3][3][kBlock + kContactPadding], std::size_t i,
                                          const Vector (&low)[3], const Vector (&high)[3]) {
  constexpr Floats kFloats;
  Vector most = hn::Zero(kFloats), extent = hn::Zero(kFloats), not_finite = hn::Zero(kFloats);
  auto ab = hn::FirstN(kFloats, kLanes), bc = ab, ca = ab;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Vector a = hn::LoadU(kFloats, corners[0][axis] + i);
    const Vector b = hn::LoadU(kFloats, corners[1][axis] + i);
    const Vector c = hn::LoadU(kFloats, corners[2][axis] + i);
    ab = hn::And(ab, hn::Eq(a, b));
    bc = hn::And(bc, hn::Eq(b, c));
    ca = hn::And(ca, hn::Eq(c, a));
    most = hn::Max(most, hn::Max(hn::Neg(low[axis]), high[axis]));
    extent = hn::Max(extent, hn::Sub(high[axis], low[axis]));
    not_finite = hn::Add(not_finite, hn::Add(hn::Add(hn::Sub(a, a), hn::Sub(b, b)), hn::Sub(c, c)));
  }
  const auto is_point = hn::Le(extent, hn::Mul(hn::Set(kFloats, kPointSize), most));
  return hn::Or(hn::Or(ab, hn::Or(bc, ca)), hn::Or(is_point, hn::Not(hn::Eq(not_finite, hn::Zero(kFloats)))));
}

// The cluster's triangles that touch the box but for what single corners tell. False where there are none. The box of a
// triangle without a shape is empty, and nothing touches it.
inline HWY_NOINLINE bool load_block(const PosedClusters& posed, std::size_t cluster_index, const BoxProbe& box,
                                    Block& out) {
  constexpr Floats kFloats;
  const Surface& surface = *posed.surface;
  const Cluster& cluster = surface.clusters.data[cluster_index];
  const std::uint8_t* corners = surface.corners.data + 3 * std::size_t{cluster.first_triangle};
  HWY_ALIGN Codes codes;
  find_sides(posed, cluster_index, box, codes);
  const Slots slots = slots_of(posed, cluster_index);
  const std::uint32_t* vertices = surface.cluster_vertices.data + cluster.first_vertex;
  std::uint8_t last[3 * kBlock];
  if (3 * (cluster.first_triangle + kBlock) > surface.corners.size) {  // the asset's last few
    std::memset(last, 0, sizeof last);
    std::memcpy(last, corners, 3 * std::size_t{cluster.triangle_count});
    corners = last;
  }
  std::size_t count = 0;
  for (std::uint64_t bits = within(corners, cluster.triangle_count, cluster.vertex_count, codes); bits != 0;
       bits &= bits - 1, ++count) {
    const std::size_t i = lowest_bit(bits);
    out.triangles[count] = static_cast<std::uint32_t>(cluster.first_triangle + i);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t slot = corners[3 * i + k];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        out.corners[k][axis][count] = slots.axes[axis][slot];
      }
      if (posed.neighbours) {
        out.welds[k][count] = surface.welds.data[vertices[slot]];
      }
    }
  }
  if (count == 0) {
    return false;
  }
  out.cluster = cluster_index;
  out.count = count;
  const Vector empty_low = hn::Set(kFloats, FLT_MAX), empty_high = hn::Set(kFloats, -FLT_MAX);
  Vector least[3] = {empty_low, empty_low, empty_low}, most[3] = {empty_high, empty_high, empty_high};
  for (std::size_t i = 0; i < count; i += kLanes) {
    const auto used = hn::FirstN(kFloats, count - i);
    Vector low[3], high[3];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Vector a = hn::LoadU(kFloats, out.corners[0][axis] + i);
      const Vector b = hn::LoadU(kFloats, out.corners[1][axis] + i);
      const Vector c = hn::LoadU(kFloats, out.corners[2][axis] + i);
      low[axis] = hn::Min(hn::Min(a, b), c);
      high[axis] = hn::Max(hn::Max(a, b), c);
    }
    const auto is_empty = hn::Or(without_shape(out.corners, i, low, high), hn::Not(used));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Vector first = hn::IfThenElse(is_empty, empty_low, low[axis]);
      const Vector end = hn::IfThenElse(is_empty, empty_high, high[axis]);
      hn::StoreU(first, kFloats, out.low[axis] + i);
      hn::StoreU(end, kFloats, out.high[axis] + i);
      least[axis] = hn::Min(first, least[axis]);
      most[axis] = hn::Max(end, most[axis]);
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    out.box.low[axis] = hn::GetLane(hn::MinOfLanes(kFloats, least[axis]));
    out.box.high[axis] = hn::GetLane(hn::MaxOfLanes(kFloats, most[axis]));
  }
  return out.box.low[0] <= out.box.high[0];
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#endif

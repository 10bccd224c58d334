// SPDX-License-Identifier: MIT
// The triangles of a cluster that could touch a box.
#include "simd/highway.h"

#if defined(SPHERECHAIN_SKIN_BLOCKS_H) == defined(HWY_TARGET_TOGGLE)  // once a target
#ifdef SPHERECHAIN_SKIN_BLOCKS_H
#undef SPHERECHAIN_SKIN_BLOCKS_H
#else
#define SPHERECHAIN_SKIN_BLOCKS_H
#endif

#include <cfloat>

#include "pairs/pair_bits.h"
#include "skin/scene.h"
#include "skin/slots.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

constexpr std::size_t kBlock = 64;  // triangles: a bit each

// Of each vertex of the cluster, the sides of the box that it is beyond of: a bit a side. At least 16 codes, and a
// vector more than there are vertices, can be written and read.
using Codes = std::uint8_t[256 + 64];

HWY_INLINE void find_sides(const ContactScene& scene, std::size_t cluster_index, const BoxProbe& box, Codes& codes) {
  constexpr Floats kFloats;
  const hn::Rebind<std::int32_t, Floats> integers;
  const hn::Rebind<std::uint8_t, Floats> bytes;
  const Slots slots = slots_of(scene, cluster_index);
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

// Of the triangles of these corners, at most kBlock, those not all beyond one side.
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

// Some triangles of a cluster, coordinate by coordinate. Spare lanes up to a vector are dirt.
struct Block {
  std::size_t cluster, count;
  std::uint32_t triangles[kBlock + kContactPadding];  // in AssetView::triangles()
  float corners[3][3][kBlock + kContactPadding];      // by corner, by axis
  float low[3][kBlock + kContactPadding], high[3][kBlock + kContactPadding];
  Box box;                                           // of all
  std::uint32_t welds[3][kBlock + kContactPadding];  // the corners'; only of a scene with neighbours

  TriangleCorners corners_of(std::size_t i) const {
    TriangleCorners out;
    for (std::size_t k = 0; k < 3; ++k) {
      out.p[k] = {corners[k][0][i], corners[k][1][i], corners[k][2][i]};
    }
    return out;
  }
};

// The triangles that have two corners in one place.
HWY_INLINE std::uint64_t collapsed(const Block& block) {
  constexpr Floats kFloats;
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < block.count; i += kLanes) {
    auto ab = hn::FirstN(kFloats, block.count - i), bc = ab, ca = ab;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Vector a = hn::LoadU(kFloats, block.corners[0][axis] + i),
                   b = hn::LoadU(kFloats, block.corners[1][axis] + i),
                   c = hn::LoadU(kFloats, block.corners[2][axis] + i);
      ab = hn::And(ab, hn::Eq(a, b));
      bc = hn::And(bc, hn::Eq(b, c));
      ca = hn::And(ca, hn::Eq(c, a));
    }
    bits |= bits_of(hn::Or(hn::Or(ab, bc), ca)) << i;
  }
  return bits;
}

// Takes these triangles out; the others stay in order.
HWY_NOINLINE void remove(std::uint64_t triangles, bool neighbours, Block& block) {
  std::size_t left = 0;
  for (std::size_t i = 0; i < block.count; ++i) {
    if (((triangles >> i) & 1U) != 0) {
      continue;
    }
    block.triangles[left] = block.triangles[i];
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        block.corners[k][axis][left] = block.corners[k][axis][i];
      }
      if (neighbours) {
        block.welds[k][left] = block.welds[k][i];
      }
    }
    ++left;
  }
  block.count = left;
}

// Of the cluster's triangles from `first` on, at most kBlock, those that touch the box but for what single corners
// tell. Degenerate ones intersect nothing: where two corners meet, as they do all over a pose too far off for its
// floats, they are left out here, for to tell would take exact arithmetic, pair by pair. False where there are none.
HWY_NOINLINE bool load_block(const ContactScene& scene, std::size_t cluster_index, std::size_t first,
                             const BoxProbe& box, Block& out) {
  constexpr Floats kFloats;
  const Cluster& cluster = scene.surface->clusters.data[cluster_index];
  const std::size_t first_triangle = cluster.first_triangle + first;
  const std::size_t left = cluster.triangle_count - first;
  const std::uint8_t* corners = scene.surface->corners.data + 3 * first_triangle;
  HWY_ALIGN Codes codes;
  find_sides(scene, cluster_index, box, codes);
  std::size_t count = 0;
  const Slots slots = slots_of(scene, cluster_index);
  const std::uint32_t* vertices = scene.surface->cluster_vertices.data + cluster.first_vertex;
  const std::uint8_t* known = corners;
  std::uint8_t last[3 * kBlock];
  if (3 * (first_triangle + kBlock) > scene.surface->corners.size) {  // the asset's last few
    for (std::size_t i = 0; i < 3 * kBlock; ++i) {
      last[i] = i < 3 * left ? corners[i] : std::uint8_t{0};
    }
    known = last;
  }
  std::uint64_t bits = within(known, left < kBlock ? left : kBlock, cluster.vertex_count, codes);
  if (bits == 0) {
    return false;
  }
  for (; bits != 0; bits &= bits - 1, ++count) {
    const std::size_t i = lowest_bit(bits);
    out.triangles[count] = static_cast<std::uint32_t>(first_triangle + i);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t slot = corners[3 * i + k];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        out.corners[k][axis][count] = slots.axes[axis][slot];
      }
      if (scene.neighbours) {
        out.welds[k][count] = scene.surface->welds.data[vertices[slot]];
      }
    }
  }
  out.cluster = cluster_index;
  out.count = count;
  const std::uint64_t gone = collapsed(out);
  if (gone != 0) {
    remove(gone, scene.neighbours, out);
    count = out.count;
    if (count == 0) {
      return false;
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vector least = hn::Set(kFloats, FLT_MAX), most = hn::Set(kFloats, -FLT_MAX);
    for (std::size_t i = 0; i < count; i += kLanes) {
      const Vector a = hn::LoadU(kFloats, out.corners[0][axis] + i);
      const Vector b = hn::LoadU(kFloats, out.corners[1][axis] + i);
      const Vector c = hn::LoadU(kFloats, out.corners[2][axis] + i);
      const Vector low = hn::Min(hn::Min(a, b), c), high = hn::Max(hn::Max(a, b), c);
      hn::StoreU(low, kFloats, out.low[axis] + i);
      hn::StoreU(high, kFloats, out.high[axis] + i);
      const auto used = hn::FirstN(kFloats, count - i);
      least = hn::IfThenElse(used, hn::Min(low, least), least);
      most = hn::IfThenElse(used, hn::Max(high, most), most);
    }
    out.box.low[axis] = hn::GetLane(hn::MinOfLanes(kFloats, least));
    out.box.high[axis] = hn::GetLane(hn::MaxOfLanes(kFloats, most));
  }
  return true;
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#endif

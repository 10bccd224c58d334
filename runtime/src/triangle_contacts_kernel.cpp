// SPDX-License-Identifier: MIT
// From boxes of spheres to boxes of leaves to triangles. From bones, leaves' boxes are around their balls until they
// are skinned; all other boxes are exact. Which candidates come out may differ between targets, but none that
// intersects is ever missing.
#include <cfloat>
#include <cstring>

#include "arithmetic.h"
#include "contact_scene.h"
#include "simd.h"
#include "triangle_bits.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "triangle_contacts_kernel.cpp"
#include "highway.h"
#include "skin_leaf.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
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

HWY_INLINE Box box_at(const BoxColumns& columns, std::size_t i) {
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
  HWY_INLINE hn::Mask<Floats> misses(const float* const (&lows)[3], const float* const (&highs)[3],
                                     std::size_t i) const {
    constexpr Floats kFloats;
    auto out = hn::Gt(low[0], hn::LoadU(kFloats, highs[0] + i));
    out = hn::Or(out, hn::Lt(high[0], hn::LoadU(kFloats, lows[0] + i)));
    for (std::size_t axis = 1; axis < 3; ++axis) {
      out = hn::Or(out, hn::Gt(low[axis], hn::LoadU(kFloats, highs[axis] + i)));
      out = hn::Or(out, hn::Lt(high[axis], hn::LoadU(kFloats, lows[axis] + i)));
    }
    return out;
  }
  // Bit k: box i + k touches; `count` boxes are left.
  HWY_INLINE std::uint64_t touching(const BoxColumns& columns, std::size_t i, std::size_t count) const {
    const float* const lows[3] = {columns.low[0], columns.low[1], columns.low[2]};
    const float* const highs[3] = {columns.high[0], columns.high[1], columns.high[2]};
    const std::uint64_t lanes = ~std::uint64_t{0} >> (64 - (count < kLanes ? count : kLanes));
    return ~bits_of(misses(lows, highs, i)) & lanes;
  }
};

#if HWY_TARGET == HWY_SCALAR

HWY_INLINE Box box_of_leaf(const ContactScene& scene, const Leaf& leaf) {
  const std::uint32_t* source = scene.surface->source_vertices.data;
  Box box{{FLT_MAX, FLT_MAX, FLT_MAX}, {-FLT_MAX, -FLT_MAX, -FLT_MAX}};
  const std::uint32_t* vertices = scene.surface->leaf_vertices.data + leaf.first_vertex;
  for (std::size_t i = 0; i < leaf.vertex_count; ++i) {
    const float* p = scene.positions + source[vertices[i]] * scene.stride;
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
HWY_INLINE Box box_of_leaf(const ContactScene& scene, const Leaf& leaf) {
  constexpr hn::CappedTag<float, 4> kFour;
  constexpr std::size_t kAtATime = 4;
  hn::Vec<hn::CappedTag<float, 4> > low[kAtATime], high[kAtATime];
  for (std::size_t k = 0; k < kAtATime; ++k) {
    low[k] = hn::Set(kFour, FLT_MAX);
    high[k] = hn::Set(kFour, -FLT_MAX);
  }
  const std::uint32_t* vertices = scene.surface->leaf_vertices.data + leaf.first_vertex;
  const std::uint32_t* source = scene.surface->source_vertices.data;
  const float* positions = scene.positions;
  const std::size_t stride = scene.stride, count = leaf.vertex_count;
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

// A sphere's box around those of its leaves.
HWY_INLINE void unite_leaves(const ContactScene& scene, std::size_t sphere) {
  Box box{{FLT_MAX, FLT_MAX, FLT_MAX}, {-FLT_MAX, -FLT_MAX, -FLT_MAX}};
  for (std::size_t i = scene.first_leaf[sphere]; i < scene.first_leaf[sphere + 1]; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float low = scene.leaves.low[axis][i], high = scene.leaves.high[axis][i];
      box.low[axis] = low < box.low[axis] ? low : box.low[axis];
      box.high[axis] = high > box.high[axis] ? high : box.high[axis];
    }
  }
  put_box(scene.spheres, sphere, box);
}

// Boxes around the leaves' balls. A coordinate less the radius is rounded once, to at most 2^-24 of both: 2^-22 is
// added.
HWY_NOINLINE void bound_balls(const ContactScene& scene) {
  constexpr Floats kFloats;
  const std::size_t count = scene.surface->leaves.size;
  for (std::size_t i = 0; i < count; ++i) {
    const Sphere& ball = scene.balls[i];
    scene.ball_columns[0][i] = ball.x;
    scene.ball_columns[1][i] = ball.y;
    scene.ball_columns[2][i] = ball.z;
    scene.ball_columns[3][i] = ball.radius;
  }
  for (std::size_t i = 0; i < count; i += kLanes) {
    const Vector radius = hn::LoadU(kFloats, scene.ball_columns[3] + i);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Vector center = hn::LoadU(kFloats, scene.ball_columns[axis] + i);
      const Vector margin = hn::Mul(hn::Add(hn::Abs(center), radius), hn::Set(kFloats, 0x1p-22F));
      hn::StoreU(hn::Sub(hn::Sub(center, radius), margin), kFloats, scene.leaves.low[axis] + i);
      hn::StoreU(hn::Add(hn::Add(center, radius), margin), kFloats, scene.leaves.high[axis] + i);
    }
  }
}

// Where a leaf's skinned vertices are.
struct Slots {
  float* axes[3];
  std::size_t count;
};

// Each axis starts at a multiple of kContactPadding floats. A leaf's slots, a multiple of half of that, are rounded up
// to one: half of it for each leaf before is room enough.
HWY_INLINE Slots slots_of(const ContactScene& scene, std::size_t leaf_index) {
  static_assert(2 * kSlotLanes == kContactPadding, "half of it");
  constexpr std::size_t kWhole = kContactPadding;
  const Leaf& leaf = scene.surface->leaves.data[leaf_index];
  const std::size_t room = (leaf.vertex_count + kWhole - 1) / kWhole * kWhole;
  const std::size_t place = (leaf.first_slot + kSlotLanes * leaf_index + kWhole - 1) / kWhole * kWhole;
  float* first = scene.slots + 3 * place;
  return {{first, first + room, first + 2 * room}, (leaf.vertex_count + kSlotLanes - 1) / kSlotLanes * kSlotLanes};
}

// Where it is not yet: a leaf's vertices from the source's.
HWY_NOINLINE void gather(const ContactScene& scene, std::size_t leaf_index) {
  if (scene.is_loaded[leaf_index] != 0) {
    return;
  }
  scene.is_loaded[leaf_index] = 1;
  const Leaf& leaf = scene.surface->leaves.data[leaf_index];
  const Slots slots = slots_of(scene, leaf_index);
  const std::uint32_t* vertices = scene.surface->leaf_vertices.data + leaf.first_vertex;
  const std::uint32_t* source = scene.surface->source_vertices.data;
  for (std::size_t i = 0; i < leaf.vertex_count; ++i) {
    const float* p = scene.positions + source[vertices[i]] * scene.stride;
    slots.axes[0][i] = p[0];
    slots.axes[1][i] = p[1];
    slots.axes[2][i] = p[2];
  }
}

// Where it is not yet: a leaf's vertices from the bones, and its own box in place of its ball's.
HWY_NOINLINE void skin(const ContactScene& scene, std::size_t leaf_index) {
  if (scene.is_loaded[leaf_index] != 0) {
    return;
  }
  scene.is_loaded[leaf_index] = 1;
  const Leaf& leaf = scene.surface->leaves.data[leaf_index];
  const Slots slots = slots_of(scene, leaf_index);
  skin_leaf(scene.skin, leaf, slots.axes[0], slots.axes[1], slots.axes[2]);
  constexpr hn::CappedTag<float, kSlotLanes> kSlots;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    auto low = hn::Set(kSlots, FLT_MAX), high = hn::Set(kSlots, -FLT_MAX);
    for (std::size_t i = 0; i < slots.count; i += hn::MaxLanes(kSlots)) {
      const auto p = hn::LoadU(kSlots, slots.axes[axis] + i);
      low = hn::Min(p, low);
      high = hn::Max(p, high);
    }
    scene.leaves.low[axis][leaf_index] = hn::GetLane(hn::MinOfLanes(kSlots, low));
    scene.leaves.high[axis][leaf_index] = hn::GetLane(hn::MaxOfLanes(kSlots, high));
  }
}

// A ball against those of a vector: bit k where ball i + k may touch it. Of a sum of squares of rounded differences
// 2^-20 is more than all roundings.
struct BallProbe {
  Vector center[3], radius;

  HWY_INLINE BallProbe(const ContactScene& scene, std::size_t leaf) {
    constexpr Floats kFloats;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      center[axis] = hn::Set(kFloats, scene.ball_columns[axis][leaf]);
    }
    radius = hn::Set(kFloats, scene.ball_columns[3][leaf]);
  }
  HWY_INLINE std::uint64_t touching(const ContactScene& scene, std::size_t i) const {
    constexpr Floats kFloats;
    const Vector x = hn::Sub(hn::LoadU(kFloats, scene.ball_columns[0] + i), center[0]);
    const Vector y = hn::Sub(hn::LoadU(kFloats, scene.ball_columns[1] + i), center[1]);
    const Vector z = hn::Sub(hn::LoadU(kFloats, scene.ball_columns[2] + i), center[2]);
    const Vector reach = hn::Add(hn::LoadU(kFloats, scene.ball_columns[3] + i), radius);
    const Vector squared = hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
    const Vector most = hn::Mul(hn::Mul(reach, reach), hn::Set(kFloats, 1 + 0x1p-20F));
    return ~bits_of(hn::Gt(squared, most));
  }
};

constexpr std::size_t kBlock = 64;  // triangles: a bit each

// Of each vertex of the leaf, the sides of the box that it is beyond of: a bit a side. At least 16 codes, and a vector
// more than there are vertices, can be written and read.
using Codes = std::uint8_t[256 + 64];

HWY_INLINE void find_sides(const ContactScene& scene, std::size_t leaf_index, const BoxProbe& box, Codes& codes) {
  constexpr Floats kFloats;
  const hn::Rebind<std::int32_t, Floats> integers;
  const hn::Rebind<std::uint8_t, Floats> bytes;
  const Slots slots = slots_of(scene, leaf_index);
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

// Some triangles of a leaf, coordinate by coordinate. Spare lanes up to a vector are dirt.
struct Block {
  std::size_t leaf, count;
  std::uint32_t triangles[kBlock];                // in Asset::triangles()
  float corners[3][3][kBlock + kContactPadding];  // by corner, by axis
  float low[3][kBlock + kContactPadding], high[3][kBlock + kContactPadding];
  Box box;  // of all

  TriangleCorners corners_of(std::size_t i) const {
    TriangleCorners out;
    for (std::size_t k = 0; k < 3; ++k) {
      out.p[k] = {corners[k][0][i], corners[k][1][i], corners[k][2][i]};
    }
    return out;
  }
};

// Of the leaf's triangles from `first` on, at most kBlock, those that touch the box but for what single corners tell.
// False where there are none.
HWY_NOINLINE bool load_block(const ContactScene& scene, std::size_t leaf_index, std::size_t first, const BoxProbe& box,
                             Block& out) {
  constexpr Floats kFloats;
  const Leaf& leaf = scene.surface->leaves.data[leaf_index];
  const std::size_t first_triangle = leaf.first_triangle + first;
  const std::size_t left = leaf.triangle_count - first;
  const std::uint8_t* corners = scene.surface->corners.data + 3 * first_triangle;
  HWY_ALIGN Codes codes;
  find_sides(scene, leaf_index, box, codes);
  std::size_t count = 0;
  const Slots slots = slots_of(scene, leaf_index);
  const std::uint8_t* known = corners;
  std::uint8_t last[3 * kBlock];
  if (3 * (first_triangle + kBlock) > scene.surface->corners.size) {  // the asset's last few
    for (std::size_t i = 0; i < 3 * kBlock; ++i) {
      last[i] = i < 3 * left ? corners[i] : std::uint8_t{0};
    }
    known = last;
  }
  std::uint64_t bits = within(known, left < kBlock ? left : kBlock, leaf.vertex_count, codes);
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
    }
  }
  out.leaf = leaf_index;
  out.count = count;
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

struct Vector3 {
  Vector x, y, z;
};

HWY_INLINE Vector3 subtract(const Vector3& a, const Vector3& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE Vector3 cross_product(const Vector3& a, const Vector3& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}
HWY_INLINE Vector dot_product(const Vector3& a, const Vector3& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

// The bound of exact_orientation.h for single precision, where u = 2^-24; and what underflow may add, of subnormal
// figures taken as zero: six products, each off by 2^-126 times an extent. Infinite where something could overflow, and
// then nothing is certain.
HWY_INLINE Vector plane_error(const Vector3& extent) {
  constexpr Floats kFloats;
  const Vector sum = hn::Add(hn::Add(extent.x, extent.y), extent.z);
  const Vector rounding = hn::Mul(hn::Mul(hn::Mul(extent.x, extent.y), extent.z), hn::Set(kFloats, 0x1p-18F));
  const Vector underflow = hn::Mul(hn::Add(sum, hn::Set(kFloats, 1)), hn::Set(kFloats, 0x1p-120F));
  const auto fits = hn::Lt(sum, hn::Set(kFloats, 0x1p30F));
  return hn::IfThenElse(fits, hn::Add(rounding, underflow), hn::Inf(kFloats));
}

HWY_INLINE Vector3 corner_at(const Block& many, std::size_t corner, std::size_t i) {
  constexpr Floats kFloats;
  return {hn::LoadU(kFloats, many.corners[corner][0] + i), hn::LoadU(kFloats, many.corners[corner][1] + i),
          hn::LoadU(kFloats, many.corners[corner][2] + i)};
}

using LaneMask = hn::Mask<Floats>;

HWY_INLINE Vector3 choose(LaneMask mask, const Vector3& yes, const Vector3& no) {
  return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y), hn::IfThenElse(mask, yes.z, no.z)};
}

// Three corners against a plane: distances times the length of its normal.
struct Sides {
  Vector distances[3];

  HWY_INLINE Sides(const Vector3& at, const Vector3& normal, const Vector3 (&corners)[3]) {
    for (std::size_t k = 0; k < 3; ++k) {
      distances[k] = dot_product(normal, subtract(corners[k], at));
    }
  }
  // All on one side, for certain.
  HWY_INLINE LaneMask miss(Vector error) const {
    const Vector least = hn::Min(hn::Min(distances[0], distances[1]), distances[2]);
    const Vector most = hn::Max(hn::Max(distances[0], distances[1]), distances[2]);
    return hn::Or(hn::Gt(least, error), hn::Lt(most, hn::Neg(error)));
  }
  // None is on a side that is not certain.
  HWY_INLINE LaneMask known(Vector error) const {
    return hn::And(hn::And(hn::Gt(hn::Abs(distances[0]), error), hn::Gt(hn::Abs(distances[1]), error)),
                   hn::Gt(hn::Abs(distances[2]), error));
  }
  // Of known sides: turns the corners until the one that is alone on its side is the first. Returns where that is
  // below.
  HWY_INLINE LaneMask put_alone_first(Vector3 (&corners)[3]) const {
    constexpr Floats kFloats;
    const Vector zero = hn::Zero(kFloats);
    const LaneMask below[3] = {hn::Lt(distances[0], zero), hn::Lt(distances[1], zero), hn::Lt(distances[2], zero)};
    const LaneMask third = hn::Not(hn::Xor(below[0], below[1]));  // the first two are together
    const LaneMask second = hn::Not(hn::Xor(below[0], below[2]));
    const Vector3 c0 = corners[0], c1 = corners[1], c2 = corners[2];
    corners[0] = choose(third, c2, choose(second, c1, c0));
    corners[1] = choose(third, c0, choose(second, c2, c1));
    corners[2] = choose(third, c1, choose(second, c0, c2));
    const Vector alone = hn::IfThenElse(third, distances[2], hn::IfThenElse(second, distances[1], distances[0]));
    return hn::Lt(alone, zero);
  }
};

// What single precision can tell of pairs of triangles.
struct Verdicts {
  std::uint64_t apart, meeting;
};

// One triangle against a vector of them, as exact_crossing.h does it. Lanes that are not wanted may be left open.
HWY_INLINE Verdicts judge(const Block& few, std::size_t one, const Block& many, std::size_t i, std::uint64_t wanted) {
  constexpr Floats kFloats;
  Vector3 a[3], b[3];
  for (std::size_t k = 0; k < 3; ++k) {
    a[k] = {hn::Set(kFloats, few.corners[k][0][one]), hn::Set(kFloats, few.corners[k][1][one]),
            hn::Set(kFloats, few.corners[k][2][one])};
    b[k] = corner_at(many, k, i);
  }
  Vector extents[3];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Vector low = hn::Min(hn::Set(kFloats, few.low[axis][one]), hn::LoadU(kFloats, many.low[axis] + i));
    const Vector high = hn::Max(hn::Set(kFloats, few.high[axis][one]), hn::LoadU(kFloats, many.high[axis] + i));
    extents[axis] = hn::Sub(high, low);
  }
  const Vector error = plane_error({extents[0], extents[1], extents[2]});
  const Sides of_b(a[0], cross_product(subtract(a[1], a[0]), subtract(a[2], a[0])), b);
  const Sides of_a(b[0], cross_product(subtract(b[1], b[0]), subtract(b[2], b[0])), a);
  const LaneMask missed = hn::Or(of_b.miss(error), of_a.miss(error));
  const std::uint64_t missed_bits = bits_of(missed);
  if ((wanted & ~missed_bits) == 0) {
    return {missed_bits, 0};
  }
  const LaneMask known = hn::AndNot(missed, hn::And(of_b.known(error), of_a.known(error)));
  const LaneMask a_turns_b = of_a.put_alone_first(a), b_turns_a = of_b.put_alone_first(b);
  const Vector3 q = choose(b_turns_a, a[2], a[1]), r = choose(b_turns_a, a[1], a[2]);
  const Vector3 v = choose(a_turns_b, b[2], b[1]), w = choose(a_turns_b, b[1], b[2]);
  const Vector3 u = subtract(b[0], a[0]);
  const Vector begins = dot_product(cross_product(subtract(q, a[0]), u), subtract(v, a[0]));
  const Vector ends = dot_product(cross_product(subtract(r, a[0]), u), subtract(w, a[0]));
  const Vector negative = hn::Neg(error);
  const LaneMask before = hn::Or(hn::Gt(begins, error), hn::Lt(ends, negative));
  const LaneMask meet = hn::And(hn::Lt(begins, negative), hn::Gt(ends, error));
  return {missed_bits | bits_of(hn::And(known, before)), bits_of(hn::And(known, meet))};
}

// Each of `few` against all of `many`. Like all that pairs, true where that is enough: at the first contact, where
// that is all that is asked for.
template <bool kFirst>
HWY_NOINLINE bool pair_triangles(const Block& few, const Block& many, ContactCollector& collector) {
  const float* const lows[3] = {many.low[0], many.low[1], many.low[2]};
  const float* const highs[3] = {many.high[0], many.high[1], many.high[2]};
  for (std::size_t one = 0; one < few.count; ++one) {
    Box box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box.low[axis] = few.low[axis][one];
      box.high[axis] = few.high[axis][one];
    }
    const BoxProbe probe(box);
    for (std::size_t i = 0; i < many.count; i += kLanes) {
      const std::size_t left = many.count - i;
      const std::uint64_t lanes = ~std::uint64_t{0} >> (64 - (left < kLanes ? left : kLanes));
      std::uint64_t bits = ~bits_of(probe.misses(lows, highs, i)) & lanes;
      if (bits == 0) {
        continue;
      }
      const Verdicts verdicts = judge(few, one, many, i, bits);
      for (bits &= ~verdicts.apart; bits != 0; bits &= bits - 1) {
        const std::size_t lane = lowest_bit(bits);
        const Candidate candidate{few.leaf,
                                  many.leaf,
                                  few.triangles[one],
                                  many.triangles[i + lane],
                                  few.corners_of(one),
                                  many.corners_of(i + lane),
                                  ((verdicts.meeting >> lane) & 1U) != 0};
        if (decide(collector, candidate) && kFirst) {
          return true;
        }
      }
    }
  }
  return false;
}

// Two leaves whose boxes touch.
template <bool kFirst>
HWY_NOINLINE bool pair_leaves(const ContactScene& scene, std::size_t a, std::size_t b, ContactCollector& collector) {
  if (scene.positions != nullptr) {
    gather(scene, a);
    gather(scene, b);
  }
  const BoxProbe probe(box_at(scene.leaves, b));
  const std::size_t count_a = scene.surface->leaves.data[a].triangle_count;
  const std::size_t count_b = scene.surface->leaves.data[b].triangle_count;
  Block block, other;
  for (std::size_t first = 0; first < count_a; first += kBlock) {
    if (!load_block(scene, a, first, probe, block)) {
      continue;
    }
    const BoxProbe block_probe(block.box);
    for (std::size_t first_b = 0; first_b < count_b; first_b += kBlock) {
      if (!load_block(scene, b, first_b, block_probe, other)) {
        continue;
      }
      const bool is_less = block.count < other.count;
      if (pair_triangles<kFirst>(is_less ? block : other, is_less ? other : block, collector)) {
        return true;
      }
    }
  }
  return false;
}

// One leaf against those of a sphere: leaves [first, end).
template <bool kFirst>
HWY_INLINE bool pair_leaf(const ContactScene& scene, std::size_t leaf, std::size_t first, std::size_t end,
                          ContactCollector& collector) {
  const BoxProbe probe(box_at(scene.leaves, leaf));
  for (std::size_t j = first; j < end; j += kLanes) {
    for (std::uint64_t bits = probe.touching(scene.leaves, j, end - j); bits != 0; bits &= bits - 1) {
      if (pair_leaves<kFirst>(scene, leaf, j + lowest_bit(bits), collector)) {
        return true;
      }
    }
  }
  return false;
}

// The same from bones: what their balls do not part is skinned.
HWY_INLINE void pair_ball(const ContactScene& scene, std::size_t leaf, std::size_t first, std::size_t end,
                          ContactCollector& collector) {
  const BallProbe balls(scene, leaf);
  BoxProbe probe(box_at(scene.leaves, leaf));
  for (std::size_t j = first; j < end; j += kLanes) {
    std::uint64_t bits = probe.touching(scene.leaves, j, end - j);
    bits &= bits == 0 ? 0 : balls.touching(scene, j);
    if (bits != 0 && scene.is_loaded[leaf] == 0) {
      skin(scene, leaf);
      probe = BoxProbe(box_at(scene.leaves, leaf));
      bits &= probe.touching(scene.leaves, j, end - j);
    }
    for (; bits != 0; bits &= bits - 1) {
      const std::size_t other = j + lowest_bit(bits);
      skin(scene, other);
      if (box_at(scene.leaves, leaf).touches(box_at(scene.leaves, other))) {
        pair_leaves<false>(scene, leaf, other, collector);
      }
    }
  }
}

HWY_INLINE void pair_spheres(const ContactScene& scene, std::size_t a, std::size_t b, ContactCollector& collector) {
  const BoxProbe probe_b(box_at(scene.spheres, b));
  const std::size_t end_a = scene.first_leaf[a + 1], first_b = scene.first_leaf[b], end_b = scene.first_leaf[b + 1];
  for (std::size_t i = scene.first_leaf[a]; i < end_a; i += kLanes) {
    for (std::uint64_t bits = probe_b.touching(scene.leaves, i, end_a - i); bits != 0; bits &= bits - 1) {
      const std::size_t leaf = i + lowest_bit(bits);
      if (scene.positions != nullptr) {
        pair_leaf<false>(scene, leaf, first_b, end_b, collector);
      } else {
        pair_ball(scene, leaf, first_b, end_b, collector);
      }
    }
  }
}

// Exact boxes of a sphere's leaves and of all of them, where it has none yet.
HWY_NOINLINE void bound_sphere(const ContactScene& scene, std::size_t sphere) {
  if (scene.is_bounded[sphere] != 0) {
    return;
  }
  scene.is_bounded[sphere] = 1;
  for (std::size_t i = scene.first_leaf[sphere]; i < scene.first_leaf[sphere + 1]; ++i) {
    if (scene.positions != nullptr) {
      put_box(scene.leaves, i, box_of_leaf(scene, scene.surface->leaves.data[i]));
    } else {
      skin(scene, i);
    }
  }
  unite_leaves(scene, sphere);
}

bool touch(const ContactScene& scene, std::size_t a, std::size_t b, ContactCollector& collector) {
  bound_sphere(scene, a);
  bound_sphere(scene, b);
  const Box box_b = box_at(scene.spheres, b);
  if (!box_at(scene.spheres, a).touches(box_b)) {
    return false;
  }
  const BoxProbe probe(box_b);
  const std::size_t end_a = scene.first_leaf[a + 1], first_b = scene.first_leaf[b], end_b = scene.first_leaf[b + 1];
  for (std::size_t i = scene.first_leaf[a]; i < end_a; i += kLanes) {
    for (std::uint64_t bits = probe.touching(scene.leaves, i, end_a - i); bits != 0; bits &= bits - 1) {
      if (pair_leaf<true>(scene, i + lowest_bit(bits), first_b, end_b, collector)) {
        return true;
      }
    }
  }
  return false;
}

HWY_INLINE bool is_enabled(const ContactScene& scene, std::size_t sphere) {
  return scene.disabled.size == 0 || !test_bit(scene.disabled, sphere);
}

HWY_NOINLINE void bound_leaves(const ContactScene& scene) {
  const Surface& surface = *scene.surface;
  for (std::size_t i = 0; i < surface.leaves.size; ++i) {
    put_box(scene.leaves, i, box_of_leaf(scene, surface.leaves.data[i]));
  }
}

void find(const ContactScene& scene, ContactCollector& collector) {
  if (scene.positions != nullptr) {
    bound_leaves(scene);
  } else {
    bound_balls(scene);
  }
  for (std::size_t s = 0; s < scene.sphere_count; ++s) {
    unite_leaves(scene, s);
  }
  for (std::size_t a = 0; a < scene.sphere_count; ++a) {
    if (!is_enabled(scene, a)) {
      continue;
    }
    const BoxProbe probe(box_at(scene.spheres, a));
    for (std::size_t first = a + 1; first < scene.sphere_count; first += kLanes) {
      std::uint64_t bits = probe.touching(scene.spheres, first, scene.sphere_count - first);
      for (; bits != 0; bits &= bits - 1) {
        const std::size_t b = first + lowest_bit(bits);
        if (is_enabled(scene, b) && !test_bit(scene.ignored, ignored_bit(a, b))) {
          begin_spheres(collector, {static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b)});
          pair_spheres(scene, a, b, collector);
        }
      }
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace spherechain {
namespace {

SPHERECHAIN_KERNELS(find);
SPHERECHAIN_KERNELS(touch);

}  // namespace

void find_candidates(Target resolved, const ContactScene& scene, ContactCollector& collector) {
  find_kernels[index_of(resolved)](scene, collector);
}

bool skins_touch(Target resolved, const ContactScene& scene, Pair spheres, ContactCollector& collector) {
  return touch_kernels[index_of(resolved)](scene, spheres.a, spheres.b, collector);
}

}  // namespace spherechain
#endif

// SPDX-License-Identifier: MIT
// From boxes of spheres to boxes of leaves to triangles. Boxes are exact: no bound here is off by a rounding, so that
// which candidates come out may differ between targets, but none that intersects is ever missing.
#include <cfloat>
#include <cstring>

#include "arithmetic.h"
#include "contact_scene.h"
#include "simd.h"
#include "stride.h"
#include "triangle_bits.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "triangle_contacts_kernel.cpp"
#include "highway.h"

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

// The leaf's box from the source's positions, whose corners are not copied.
HWY_INLINE Box box_of_leaf(const ContactScene& scene, const Leaf& leaf) {
  const Surface& surface = *scene.surface;
  Box box{{FLT_MAX, FLT_MAX, FLT_MAX}, {-FLT_MAX, -FLT_MAX, -FLT_MAX}};
  const std::uint32_t* vertices = surface.leaf_vertices.data + leaf.first_vertex;
  for (std::size_t i = 0; i < leaf.vertex_count; ++i) {
    const float* p = vertex_at(scene.positions.data, surface.source_vertices[vertices[i]], scene.positions.stride);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box.low[axis] = p[axis] < box.low[axis] ? p[axis] : box.low[axis];
      box.high[axis] = p[axis] > box.high[axis] ? p[axis] : box.high[axis];
    }
  }
  return box;
}

// Sphere boxes around those of their leaves.
HWY_INLINE void unite_leaves(const ContactScene& scene) {
  for (std::size_t s = 0; s < scene.sphere_count; ++s) {
    Box box{{FLT_MAX, FLT_MAX, FLT_MAX}, {-FLT_MAX, -FLT_MAX, -FLT_MAX}};
    for (std::size_t i = scene.first_leaf[s]; i < scene.first_leaf[s + 1]; ++i) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const float low = scene.leaves.low[axis][i], high = scene.leaves.high[axis][i];
        box.low[axis] = low < box.low[axis] ? low : box.low[axis];
        box.high[axis] = high > box.high[axis] ? high : box.high[axis];
      }
    }
    put_box(scene.spheres, s, box);
  }
}

HWY_INLINE void load_leaf(const ContactScene& scene, std::size_t i) {
  if (scene.is_loaded[i] != 0) {
    return;
  }
  scene.is_loaded[i] = 1;
  const Surface& surface = *scene.surface;
  const Leaf& leaf = surface.leaves[i];
  const std::size_t place = scene.vertex_place(i);
  const std::uint32_t* vertices = surface.leaf_vertices.data + leaf.first_vertex;
  float *x = scene.vertices[0] + place, *y = scene.vertices[1] + place, *z = scene.vertices[2] + place;
  for (std::size_t v = 0; v < leaf.vertex_count; ++v) {
    const float* p = vertex_at(scene.positions.data, surface.source_vertices[vertices[v]], scene.positions.stride);
    x[v] = p[0];
    y[v] = p[1];
    z[v] = p[2];
  }
}

constexpr std::size_t kBatch = 128;  // triangles of a leaf that are looked at together

// Triangles of a leaf that touch some box, coordinate by coordinate. Spare lanes up to a vector are dirt.
struct Trimmed {
  std::size_t leaf, count;
  std::uint32_t triangles[kBatch + kContactPadding];  // in Asset::triangles()
  float corners[3][3][kBatch + kContactPadding];      // by corner, by axis
  float low[3][kBatch + kContactPadding], high[3][kBatch + kContactPadding];
  Box box;  // of all

  TriangleCorners corners_of(std::size_t i) const {
    TriangleCorners out;
    for (std::size_t k = 0; k < 3; ++k) {
      out.p[k] = {corners[k][0][i], corners[k][1][i], corners[k][2][i]};
    }
    return out;
  }
};

using Codes = std::int32_t[256 + kContactPadding];

// Of each vertex of the leaf, the sides of the box that it is beyond of: a bit a side.
HWY_INLINE void find_sides(const ContactScene& scene, std::size_t leaf, const Box& box, Codes& codes) {
  constexpr Floats kFloats;
  const hn::Rebind<std::int32_t, Floats> integers;
  const std::size_t place = scene.vertex_place(leaf), count = scene.surface->leaves[leaf].vertex_count;
  const BoxProbe probe(box);
  for (std::size_t i = 0; i < count; i += kLanes) {
    auto code = hn::Zero(integers);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Vector p = hn::LoadU(kFloats, scene.vertices[axis] + place + i);
      const int below = 1 << (2 * axis), above = 2 << (2 * axis);
      code = hn::Or(code,
                    hn::IfThenElseZero(hn::RebindMask(integers, hn::Lt(p, probe.low[axis])), hn::Set(integers, below)));
      code = hn::Or(
          code, hn::IfThenElseZero(hn::RebindMask(integers, hn::Gt(p, probe.high[axis])), hn::Set(integers, above)));
    }
    hn::StoreU(code, integers, codes + i);
  }
}

// The boxes of the triangles, and of all of them.
HWY_INLINE void bound(Trimmed& out) {
  constexpr Floats kFloats;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    float least = FLT_MAX, most = -FLT_MAX;
    for (std::size_t i = 0; i < out.count; i += kLanes) {
      const Vector a = hn::LoadU(kFloats, out.corners[0][axis] + i);
      const Vector b = hn::LoadU(kFloats, out.corners[1][axis] + i);
      const Vector c = hn::LoadU(kFloats, out.corners[2][axis] + i);
      hn::StoreU(hn::Min(hn::Min(a, b), c), kFloats, out.low[axis] + i);
      hn::StoreU(hn::Max(hn::Max(a, b), c), kFloats, out.high[axis] + i);
    }
    for (std::size_t i = 0; i < out.count; ++i) {
      least = out.low[axis][i] < least ? out.low[axis][i] : least;
      most = out.high[axis][i] > most ? out.high[axis][i] : most;
    }
    out.box.low[axis] = least;
    out.box.high[axis] = most;
  }
}

// Of the leaf's triangles [first, end), end at most kBatch more, those not all beyond one side of a box.
HWY_INLINE void trim(const ContactScene& scene, std::size_t leaf_index, std::size_t first, std::size_t end,
                     const Codes& codes, Trimmed& out) {
  const Leaf& leaf = scene.surface->leaves[leaf_index];
  const std::uint8_t* slots = scene.surface->corners.data + 3 * std::size_t{leaf.first_triangle};
  out.leaf = leaf_index;
  std::size_t count = 0;
  for (std::size_t t = first; t < end; ++t) {
    const std::int32_t beyond = codes[slots[3 * t]] & codes[slots[3 * t + 1]] & codes[slots[3 * t + 2]];
    out.triangles[count] = static_cast<std::uint32_t>(t);
    count += beyond == 0 ? 1 : 0;
  }
  out.count = count;
  const std::size_t place = scene.vertex_place(leaf_index);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t* own = slots + 3 * std::size_t{out.triangles[i]};
    out.triangles[i] += leaf.first_triangle;
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        out.corners[k][axis][i] = scene.vertices[axis][place + own[k]];
      }
    }
  }
  if (count > 0) {
    bound(out);
  }
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

// Are three points beyond the plane through `at`, on one side of it, for certain?
HWY_INLINE hn::Mask<Floats> all_beyond(const Vector3& at, const Vector3& normal, const Vector3 (&points)[3],
                                       Vector error) {
  const Vector d0 = dot_product(normal, subtract(points[0], at));
  const Vector d1 = dot_product(normal, subtract(points[1], at));
  const Vector d2 = dot_product(normal, subtract(points[2], at));
  const Vector least = hn::Min(hn::Min(d0, d1), d2), most = hn::Max(hn::Max(d0, d1), d2);
  return hn::Or(hn::Gt(least, error), hn::Lt(most, hn::Neg(error)));
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

HWY_INLINE Vector3 corner_at(const Trimmed& many, std::size_t corner, std::size_t i) {
  constexpr Floats kFloats;
  return {hn::LoadU(kFloats, many.corners[corner][0] + i), hn::LoadU(kFloats, many.corners[corner][1] + i),
          hn::LoadU(kFloats, many.corners[corner][2] + i)};
}

// One triangle against a vector of them: those whose planes part them for certain.
HWY_INLINE hn::Mask<Floats> parted_by_planes(const Trimmed& few, std::size_t one, const Trimmed& many, std::size_t i) {
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
  const Vector3 normal_a = cross_product(subtract(a[1], a[0]), subtract(a[2], a[0]));
  const Vector3 normal_b = cross_product(subtract(b[1], b[0]), subtract(b[2], b[0]));
  return hn::Or(all_beyond(a[0], normal_a, b, error), all_beyond(b[0], normal_b, a, error));
}

// Each of `few` against all of `many`.
HWY_INLINE void pair_triangles(const Trimmed& few, const Trimmed& many, ContactCollector& collector) {
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
      bits &= ~bits_of(parted_by_planes(few, one, many, i));
      for (; bits != 0; bits &= bits - 1) {
        const std::size_t other = i + lowest_bit(bits);
        decide(collector, {few.leaf, many.leaf, few.triangles[one], many.triangles[other], few.corners_of(one),
                           many.corners_of(other)});
      }
    }
  }
}

HWY_NOINLINE void pair_leaves(const ContactScene& scene, std::size_t a, std::size_t b, ContactCollector& collector) {
  load_leaf(scene, a);
  load_leaf(scene, b);
  const std::size_t count_a = scene.surface->leaves[a].triangle_count;
  const std::size_t count_b = scene.surface->leaves[b].triangle_count;
  Codes codes_a, codes_b;
  Trimmed of_a, of_b;
  find_sides(scene, a, box_at(scene.leaves, b), codes_a);
  for (std::size_t first = 0; first < count_a; first += kBatch) {
    trim(scene, a, first, first + kBatch < count_a ? first + kBatch : count_a, codes_a, of_a);
    if (of_a.count == 0) {
      continue;
    }
    find_sides(scene, b, of_a.box, codes_b);
    for (std::size_t first_b = 0; first_b < count_b; first_b += kBatch) {
      trim(scene, b, first_b, first_b + kBatch < count_b ? first_b + kBatch : count_b, codes_b, of_b);
      if (of_b.count == 0) {
        continue;
      }
      const bool is_less = of_a.count < of_b.count;
      pair_triangles(is_less ? of_a : of_b, is_less ? of_b : of_a, collector);
    }
  }
}

HWY_INLINE void pair_spheres(const ContactScene& scene, std::size_t a, std::size_t b, ContactCollector& collector) {
  const BoxProbe probe_a(box_at(scene.spheres, a)), probe_b(box_at(scene.spheres, b));
  const std::size_t end_a = scene.first_leaf[a + 1], end_b = scene.first_leaf[b + 1];
  for (std::size_t i = scene.first_leaf[a]; i < end_a; i += kLanes) {
    for (std::uint64_t bits = probe_b.touching(scene.leaves, i, end_a - i); bits != 0; bits &= bits - 1) {
      const std::size_t leaf = i + lowest_bit(bits);
      const BoxProbe probe(box_at(scene.leaves, leaf));
      for (std::size_t j = scene.first_leaf[b]; j < end_b; j += kLanes) {
        for (std::uint64_t others = probe.touching(scene.leaves, j, end_b - j); others != 0; others &= others - 1) {
          pair_leaves(scene, leaf, j + lowest_bit(others), collector);
        }
      }
    }
  }
  (void)probe_a;
}

HWY_INLINE bool is_enabled(const ContactScene& scene, std::size_t sphere) {
  return scene.disabled.size == 0 || !test_bit(scene.disabled, sphere);
}

void find(const ContactScene& scene, ContactCollector& collector) {
  const Surface& surface = *scene.surface;
  for (std::size_t i = 0; i < surface.leaves.size; ++i) {
    put_box(scene.leaves, i, box_of_leaf(scene, surface.leaves[i]));
  }
  unite_leaves(scene);
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

}  // namespace

void find_candidates(Target resolved, const ContactScene& scene, ContactCollector& collector) {
  find_kernels[index_of(resolved)](scene, collector);
}

}  // namespace spherechain
#endif

// SPDX-License-Identifier: MIT
#include <cfloat>
#include <cstddef>

#include "pairs/cone.h"
#include "simd/arithmetic.h"
#include "simd/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pairs/cone_kernel.cpp"
#include "pairs/sphere_registers.h"
#include "simd/highway.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

using ConeFloats = hn::ScalableTag<float>;
using V = hn::Vec<ConeFloats>;
constexpr ConeFloats kOf;
constexpr std::size_t kConeLanes = hn::MaxLanes(kOf);

// A ball around each cone, column by column, and the cones themselves: as spheres, for these are loaded four figures at
// a time.
struct alignas(64) PosedCones {
  float x[kMaxCones], y[kMaxCones], z[kMaxCones];  // the middle of the axis
  float half[kMaxCones], radius[kMaxCones];        // half the axis, the larger radius; both a little more
  Sphere base[kMaxCones], axis[kMaxCones];         // a ball, and what it gains on the way
};

HWY_INLINE V dot(V ax, V ay, V az, V bx, V by, V bz) {
  return hn::Add(hn::Add(hn::Mul(ax, bx), hn::Mul(ay, by)), hn::Mul(az, bz));
}

HWY_INLINE hn::Mask<ConeFloats> is_end(V x, V y, V z, V radius) {
  const V extent = hn::Set(kOf, kConeExtent);
  const auto is_near = hn::And(hn::And(hn::Le(hn::Abs(x), extent), hn::Le(hn::Abs(y), extent)),
                               hn::And(hn::Le(hn::Abs(z), extent), hn::Le(radius, extent)));
  return hn::And(is_near, hn::Ge(radius, hn::Zero(kOf)));
}

HWY_INLINE void store_spheres(V x, V y, V z, V radius, Sphere* spheres) {
  hn::StoreInterleaved4(x, y, z, radius, kOf, &spheres->x);
}

// That of cone_of(). The ball around a cone reaches farther by 2^-18 of itself and 2^-20 of how far it is from the
// origin: the rule rounds each figure less than 32 times.
HWY_NOINLINE void pose_cones(const ConeTable& table, const Sphere* spheres, PosedCones& out) {
  std::size_t i = 0;
  do {
    const Pair* const links = table.links + i;
    V ax, ay, az, ar, bx, by, bz, br;
    load_spheres(
        kOf, [&](std::size_t k) -> const Sphere& { return spheres[links[k].a]; }, ax, ay, az, ar);
    load_spheres(
        kOf, [&](std::size_t k) -> const Sphere& { return spheres[links[k].b]; }, bx, by, bz, br);
    const V zero = hn::Zero(kOf);
    V ux = hn::Sub(bx, ax), uy = hn::Sub(by, ay), uz = hn::Sub(bz, az), growth = hn::Sub(br, ar);
    const V length = dot(ux, uy, uz, ux, uy, uz);
    const auto has_axis = hn::And(hn::Lt(hn::Mul(growth, growth), length), hn::Ge(length, hn::Set(kOf, kShortestAxis)));
    const auto ends = hn::And(is_end(ax, ay, az, ar), is_end(bx, by, bz, br));
    const auto is_second = hn::AndNot(has_axis, hn::Gt(growth, zero));
    const auto sum = [](V x, V y, V z) HWY_ATTR { return hn::Add(hn::Add(hn::Abs(x), hn::Abs(y)), hn::Abs(z)); };
    const V largest = hn::IfThenElse(hn::Gt(growth, zero), br, ar);
    const V reach = hn::Add(hn::Add(sum(ax, ay, az), sum(bx, by, bz)), largest);
    ax = hn::IfThenElse(is_second, bx, ax);
    ay = hn::IfThenElse(is_second, by, ay);
    az = hn::IfThenElse(is_second, bz, az);
    ar = hn::IfThenElse(is_second, br, ar);
    ux = hn::IfThenElseZero(has_axis, ux);
    uy = hn::IfThenElseZero(has_axis, uy);
    uz = hn::IfThenElseZero(has_axis, uz);
    growth = hn::IfThenElseZero(has_axis, growth);
    const V middle = hn::Set(kOf, 0.5F), more = hn::Set(kOf, 1 + 0x1p-18F);
    const V half = hn::IfThenElseZero(has_axis, hn::Mul(middle, hn::Sqrt(length)));
    const V margin = hn::Add(hn::Mul(hn::Set(kOf, 0x1p-20F), reach), hn::Set(kOf, 0x1p-60F));
    const V around = hn::Add(hn::Mul(half, more), margin);
    hn::StoreU(hn::Add(ax, hn::Mul(middle, ux)), kOf, out.x + i);
    hn::StoreU(hn::Add(ay, hn::Mul(middle, uy)), kOf, out.y + i);
    hn::StoreU(hn::Add(az, hn::Mul(middle, uz)), kOf, out.z + i);
    hn::StoreU(hn::IfThenElse(ends, around, hn::NaN(kOf)), kOf, out.half + i);
    hn::StoreU(hn::Mul(largest, more), kOf, out.radius + i);
    store_spheres(ax, ay, az, ar, out.base + i);
    store_spheres(ux, uy, uz, growth, out.axis + i);
    i += kConeLanes;
  } while (i < table.count);
}

HWY_INLINE V unit_clamp_of(V value) {
  const V zero = hn::Zero(kOf), one = hn::Set(kOf, 1.0F);
  const V positive = hn::IfThenElse(hn::Gt(value, zero), value, zero);
  return hn::IfThenElse(hn::Lt(positive, one), positive, one);
}

HWY_INLINE V one_where(hn::Mask<ConeFloats> mask) { return hn::IfThenElseZero(mask, hn::Set(kOf, 1.0F)); }

HWY_INLINE V nearest_share_of(V along, V d2, V length, V growth) {
  const V zero = hn::Zero(kOf);
  const V spread = hn::Sub(length, hn::Mul(growth, growth));
  const V apart = hn::Sub(hn::Mul(d2, length), hn::Mul(along, along));
  const V positive = hn::IfThenElse(hn::Gt(apart, zero), apart, zero);
  const V share = hn::Div(hn::Add(along, hn::Mul(growth, hn::Sqrt(hn::Div(positive, spread)))), length);
  return unit_clamp_of(hn::IfThenElse(hn::Gt(spread, zero), share, one_where(hn::Gt(growth, zero))));
}

// Pairs of links whose cones may touch: by the bytes from the first of PosedCones' spheres, which spares a shift a
// load.
constexpr std::size_t kConeRoom = 256;
struct ConeCandidates {
  std::uint32_t a[kConeRoom + 32], b[kConeRoom + 32];
  float scales[kConeRoom + 32];
};

// cones_touch() of the candidates from `first` on.
HWY_INLINE hn::Mask<ConeFloats> touch(const PosedCones& cones, const ConeCandidates& candidates, std::size_t first) {
  const auto at = [](const Sphere* spheres, std::size_t bytes) -> const Sphere& {
    return *reinterpret_cast<const Sphere*>(reinterpret_cast<const char*>(spheres) + bytes);
  };
  const std::uint32_t *const as = candidates.a + first, *const bs = candidates.b + first;
  const V scale = hn::LoadU(kOf, candidates.scales + first), zero = hn::Zero(kOf);
  V ax, ay, az, ar, ux, uy, uz, ag, bx, by, bz, br, vx, vy, vz, bg;
  load_spheres(
      kOf, [&](std::size_t k) -> const Sphere& { return at(cones.base, as[k]); }, ax, ay, az, ar);
  load_spheres(
      kOf, [&](std::size_t k) -> const Sphere& { return at(cones.axis, as[k]); }, ux, uy, uz, ag);
  load_spheres(
      kOf, [&](std::size_t k) -> const Sphere& { return at(cones.base, bs[k]); }, bx, by, bz, br);
  load_spheres(
      kOf, [&](std::size_t k) -> const Sphere& { return at(cones.axis, bs[k]); }, vx, vy, vz, bg);
  const V wx = hn::Sub(ax, bx), wy = hn::Sub(ay, by), wz = hn::Sub(az, bz);
  const V p = hn::Mul(scale, ag), q = hn::Mul(scale, bg);
  const V uu = dot(ux, uy, uz, ux, uy, uz), vv = dot(vx, vy, vz, vx, vy, vz), uv = dot(ux, uy, uz, vx, vy, vz);
  const V wu = dot(wx, wy, wz, ux, uy, uz), wv = dot(wx, wy, wz, vx, vy, vz);
  const V cx = hn::Sub(hn::Mul(uy, vz), hn::Mul(uz, vy)), cy = hn::Sub(hn::Mul(uz, vx), hn::Mul(ux, vz)),
          cz = hn::Sub(hn::Mul(ux, vy), hn::Mul(uy, vx));
  const V det = dot(cx, cy, cz, cx, cy, cz);
  const V to_s = hn::Add(hn::Mul(vv, p), hn::Mul(uv, q)), to_t = hn::Add(hn::Mul(uu, q), hn::Mul(uv, p));
  const V left = hn::Sub(det, hn::Add(hn::Mul(to_s, p), hn::Mul(to_t, q)));
  const V d = hn::Div(hn::Abs(dot(wx, wy, wz, cx, cy, cz)), hn::Sqrt(left));
  const V by_det = hn::Div(hn::Set(kOf, 1.0F), det);
  const V s_inside =
      unit_clamp_of(hn::Mul(hn::Sub(hn::Mul(d, to_s), hn::Sub(hn::Mul(vv, wu), hn::Mul(uv, wv))), by_det));
  const V t_inside =
      unit_clamp_of(hn::Mul(hn::Add(hn::Mul(d, to_t), hn::Sub(hn::Mul(uu, wv), hn::Mul(uv, wu))), by_det));
  const auto falls = hn::Gt(left, zero), crosses = hn::Gt(det, hn::Mul(hn::Set(kOf, kNearlyParallel), hn::Mul(uu, vv)));
  const auto up = hn::Gt(to_s, zero);
  const V s_end = one_where(up), t_end = one_where(hn::Gt(to_t, zero));
  const V t_parallel = one_where(hn::Not(hn::Xor(up, hn::Gt(uv, zero))));
  const V s = hn::IfThenElse(hn::And(falls, crosses), s_inside, s_end);
  const V t = hn::IfThenElse(crosses, hn::IfThenElse(falls, t_inside, t_end), t_parallel);
  const auto balls_touch_of = [&](V x, V y, V z, V radii) HWY_ATTR {
    const V reach = hn::Mul(scale, radii);
    return hn::Lt(dot(x, y, z, x, y, z), hn::Mul(reach, reach));
  };
  const auto radius_at = [](V radius, V share, V growth) HWY_ATTR { return hn::Add(radius, hn::Mul(share, growth)); };

  const V x = hn::Add(wx, hn::Mul(s, ux)), y = hn::Add(wy, hn::Mul(s, uy)), z = hn::Add(wz, hn::Mul(s, uz));
  const V on_b = nearest_share_of(dot(x, y, z, vx, vy, vz), dot(x, y, z, x, y, z), vv, q);
  const auto ball_of_a =
      balls_touch_of(hn::Sub(x, hn::Mul(on_b, vx)), hn::Sub(y, hn::Mul(on_b, vy)), hn::Sub(z, hn::Mul(on_b, vz)),
                     hn::Add(radius_at(ar, s, ag), radius_at(br, on_b, bg)));
  const V fx = hn::Sub(hn::Mul(t, vx), wx), fy = hn::Sub(hn::Mul(t, vy), wy), fz = hn::Sub(hn::Mul(t, vz), wz);
  const V on_a = nearest_share_of(dot(fx, fy, fz, ux, uy, uz), dot(fx, fy, fz, fx, fy, fz), uu, p);
  const auto ball_of_b =
      balls_touch_of(hn::Sub(fx, hn::Mul(on_a, ux)), hn::Sub(fy, hn::Mul(on_a, uy)), hn::Sub(fz, hn::Mul(on_a, uz)),
                     hn::Add(radius_at(ar, on_a, ag), radius_at(br, t, bg)));
  return hn::Or(ball_of_a, ball_of_b);
}

// Those of the candidates that touch, in order. No part of what calls it: there the registers are for the search.
HWY_NOINLINE void keep_touching(const PosedCones& cones, ConeCandidates& candidates, std::size_t count,
                                FoundCones& found) {
  for (std::size_t k = 0; k < kConeLanes; ++k) {
    candidates.a[count + k] = candidates.b[count + k] = 0;
    candidates.scales[count + k] = 0;
  }
  for (std::size_t i = 0; i < count; i += kConeLanes) {
    const auto is_own = hn::FirstN(kOf, count - i);
    std::uint64_t bits = bits_of(hn::And(touch(cones, candidates, i), is_own));
    for (; bits != 0; bits &= bits - 1, ++found.count) {
      if (found.count < found.capacity) {
        const std::size_t at = i + hwy::Num0BitsBelowLS1Bit_Nonzero64(bits);
        found.pairs[found.count] = {static_cast<std::uint32_t>(candidates.a[at] / sizeof(Sphere)),
                                    static_cast<std::uint32_t>(candidates.b[at] / sizeof(Sphere))};
      }
    }
  }
}

// A bit for each pair whose balls around the cones overlap: b of a row a. Row words past its columns are any.
struct NearCones {
  std::uint16_t bits[kMaxCones][kMaxCones / 16];
};

HWY_NOINLINE void find_near(const ConeTable& table, const PosedCones& cones, NearCones& near) {
  constexpr std::size_t kParts = 16 / kConeLanes;
  for (std::size_t first = 0; first < table.count; first += 16) {
    V x[kParts], y[kParts], z[kParts], half[kParts], radius[kParts];
    for (std::size_t part = 0; part < kParts; ++part) {
      const std::size_t at = first + part * kConeLanes;
      x[part] = hn::Load(kOf, cones.x + at);
      y[part] = hn::Load(kOf, cones.y + at);
      z[part] = hn::Load(kOf, cones.z + at);
      half[part] = hn::Load(kOf, cones.half + at);
      radius[part] = hn::Load(kOf, cones.radius + at);
    }
    const std::size_t end = first + 15 < table.count ? first + 15 : table.count - 1;
    const float* scales = table.scales + first;
    for (std::size_t a = 0; a < end; ++a, scales += table.stride) {
      std::uint64_t bits = 0;
      for (std::size_t part = 0; part < kParts; ++part) {
        const V dx = hn::Sub(x[part], hn::Set(kOf, cones.x[a])), dy = hn::Sub(y[part], hn::Set(kOf, cones.y[a])),
                dz = hn::Sub(z[part], hn::Set(kOf, cones.z[a]));
        const V radii = hn::Add(radius[part], hn::Set(kOf, cones.radius[a]));
        const V axes = hn::Add(half[part], hn::Set(kOf, cones.half[a]));
        const V reach = hn::MulAdd(hn::LoadU(kOf, scales + part * kConeLanes), radii, axes);
        const V d2 = hn::MulAdd(dz, dz, hn::MulAdd(dy, dy, hn::Mul(dx, dx)));
        bits |= bits_of(hn::Lt(d2, hn::Mul(reach, reach))) << (part * kConeLanes);
      }
      near.bits[a][first / 16] = static_cast<std::uint16_t>(bits);
    }
  }
}

void find(const ConeTable& table, const Sphere* spheres, FoundCones& found) {
  if (table.count == 0) {
    return;
  }
  PosedCones cones;
  pose_cones(table, spheres, cones);
  NearCones near;
  find_near(table, cones, near);
  ConeCandidates candidates;
  std::size_t count = 0;
  for (std::size_t a = 0; a + 1 < table.count; ++a) {
    const float* const scales = table.scales + a * table.stride;
    for (std::size_t block = (a + 1) / 16; block < table.stride / 16; ++block) {
      const std::size_t first = block * 16;
      for (std::uint64_t bits = near.bits[a][block]; bits != 0; bits &= bits - 1) {
        const std::size_t b = first + hwy::Num0BitsBelowLS1Bit_Nonzero64(bits);
        candidates.a[count] = static_cast<std::uint32_t>(a * sizeof(Sphere));
        candidates.b[count] = static_cast<std::uint32_t>(b * sizeof(Sphere));
        candidates.scales[count++] = scales[b];
      }
      if (HWY_UNLIKELY(count > kConeRoom)) {
        keep_touching(cones, candidates, count, found);
        count = 0;
      }
    }
  }
  keep_touching(cones, candidates, count, found);
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace spherechain {
namespace {

SPHERECHAIN_KERNELS(find);

}  // namespace

void find_cones(Target resolved, const ConeTable& table, const Sphere* spheres, FoundCones& found) {
  find_kernels[index_of(resolved)](table, spheres, found);
}

}  // namespace spherechain
#endif

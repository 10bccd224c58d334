// SPDX-License-Identifier: MIT
// The kernel for spheres: which pairs are surely apart, sixteen spheres against sixteen at once, by a warp.
#pragma once

#include "crowd_pairs.h"

namespace spherechain::cuda {

// A sphere as matrix units take it, which multiply figures of eleven bits: relative to the sphere in the middle of the
// others, and with its power. A figure cut to eleven bits is off by 2^-10 of itself, so a product by hardly more than
// 2^-9 and p.q by 2^-10 (|p|^2 + |q|^2). A power above 0 is off by 2^-10 rp^2; one below 0 only rises. All other
// roundings are below 2^-18 of |p|^2 + rp^2 of both.
SPHERECHAIN_HD Float4 see_sphere(const Float4& s, const Float4& origin) {
  constexpr float kMargin = 0x1p-10F + 0x1p-16F;
  const Vec3 seen{s.x - origin.x, s.y - origin.y, s.z - origin.z};
  return {eleven_bits(seen.x), eleven_bits(seen.y), eleven_bits(seen.z), eleven_bits(power_of(seen, s.w, kMargin))};
}

// The place of a sphere among its unit's sixteen. Neighbours, which often touch the same others, go to different lanes.
SPHERECHAIN_HD std::uint32_t place_of(std::uint32_t sphere) {
  return sphere / kUnit * kUnit + sphere % 8 * 2 + sphere / 8 % 2;
}

// As matrix units leave sums, lane 4 g + t has rows g, g + 8 of a unit and columns 2 t, 2 t + 1, 2 t + 8, 2 t + 9.
SPHERECHAIN_HD std::uint32_t row_of(std::uint32_t lane, std::uint32_t pair) { return lane / 4 + pair / 2 % 2 * 8; }
SPHERECHAIN_HD std::uint32_t column_of(std::uint32_t lane, std::uint32_t pair) {
  return lane % 4 * 2 + pair % 2 + pair / 4 % 2 * 8;
}

// A lane's part of the units. A row has x, y, z and its power, a column x, y, z and 1; the columns' powers are added.
#if SPHERECHAIN_AMPERE
class Units {
 public:
  struct Rows {
    float first, second;
  };
  struct Columns {
    float first, second;
    Float4 powers, second_powers;
  };

  __device__ __forceinline__ Units(const GroupView& v, const WarpInstance& w)
      : figures_(w.seen + w.lane % 4 * seen_pitch(v) + w.lane / 4 * 2),
        powers_(w.powers + w.lane % 4 * 4),
        is_power_(w.lane % 4 == 3) {}

  __device__ __forceinline__ Rows rows(std::uint32_t unit) const {
    const float2 two = *reinterpret_cast<const float2*>(figures_ + unit * kUnit);
    return {two.x, two.y};
  }
  __device__ __forceinline__ Columns columns(std::uint32_t unit, const Rows& same) const {
    return {is_power_ ? 1.0F : same.first, is_power_ ? 1.0F : same.second,
            *reinterpret_cast<const Float4*>(powers_ + unit * (2 * kUnit)),
            *reinterpret_cast<const Float4*>(powers_ + unit * (2 * kUnit) + kUnit)};
  }
  __device__ __forceinline__ static void sum(const Rows& rows, const Columns& columns, float (&sums)[kLanePairs]) {
    multiply(rows, columns.first, columns.powers, sums);
    multiply(rows, columns.second, columns.second_powers, sums + 4);
  }

 private:
  __device__ __forceinline__ static void multiply(const Rows& rows, float column, const Float4& powers, float* sums) {
    asm("mma.sync.aligned.m16n8k4.row.col.f32.tf32.tf32.f32 {%0, %1, %2, %3}, {%4, %5}, {%6}, {%7, %8, %9, %10};"
        : "=f"(sums[0]), "=f"(sums[1]), "=f"(sums[2]), "=f"(sums[3])
        : "r"(__float_as_uint(rows.first)), "r"(__float_as_uint(rows.second)), "r"(__float_as_uint(column)),
          "f"(powers.x), "f"(powers.y), "f"(powers.z), "f"(powers.w));
  }

  const float *figures_, *powers_;
  bool is_power_;
};
#else
class Units {
 public:
  struct Rows {
    Float4 at[2];
  };
  struct Columns {
    Float4 at[4];  // by pair % 2 and pair / 4
  };

  SPHERECHAIN_HD Units(const GroupView& v, const WarpInstance& w)
      : seen_(w.seen), pitch_(seen_pitch(v)), lane_(w.lane) {}

  SPHERECHAIN_HD Rows rows(std::uint32_t unit) const {
    return {{seen(unit, row_of(lane_, 0)), seen(unit, row_of(lane_, 2))}};
  }
  SPHERECHAIN_HD Columns columns(std::uint32_t unit, const Rows&) const {
    return {{seen(unit, column_of(lane_, 0)), seen(unit, column_of(lane_, 1)), seen(unit, column_of(lane_, 4)),
             seen(unit, column_of(lane_, 5))}};
  }
  SPHERECHAIN_HD static void sum(const Rows& rows, const Columns& columns, float (&sums)[kLanePairs]) {
    SPHERECHAIN_UNROLL
    for (std::uint32_t pair = 0; pair < kLanePairs; ++pair) {
      const Float4 &p = rows.at[pair / 2 % 2], &q = columns.at[pair % 2 + pair / 4 * 2];
      sums[pair] = fused(p.x, q.x, fused(p.y, q.y, fused(p.z, q.z, p.w + q.w)));
    }
  }

 private:
  SPHERECHAIN_HD Float4 seen(std::uint32_t unit, std::uint32_t sphere) const {
    const float* x = seen_ + place_of(unit * kUnit + sphere);
    return {x[0], x[pitch_], x[2 * pitch_], x[3 * pitch_]};
  }

  const float* seen_;
  std::uint32_t pitch_, lane_;
};
#endif

}  // namespace spherechain::cuda

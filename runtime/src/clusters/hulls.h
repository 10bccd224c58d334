// SPDX-License-Identifier: MIT
// The points that spheres' skins are near to in a pose, from bones alone: their hulls' points.
//
// With the weights w_b of a vertex v, o_kb of a point p_k and l_k the vertex' shares of the points, let
//   r_b = w_b (v - c; 1) - sum_k l_k o_kb (p_k - c; 1),    four coordinates for each bone b,
// and N_b = (R_b; R_b c + t_b) the bone's matrix, taken from the hull's centre c. Then the moved vertex is off the
// mean, by its shares, of the moved points, which is in their hull, by
//   sum_b N_b r_b = sum_b (N_b - N_0) r_b + N_0 sum_b r_b,
// where 0 is the hull's first bone. The asset has the greatest |r_b| of a sphere's vertices, coordinate by
// coordinate, and e, the greatest length of the first three of sum_b r_b, the fourth being rounding. So along axis i it
// is off by
//   s_i + |R_0| e at most,    s_i = sum_b (|R_b - R_0| |r_b| + |R_b c + t_b - R_0 c - t_0| |r_b|_4)_i,
// and the vertex within |s| + |R_0| e of the hull.
//
// The margin for roundings, to first order, in units of u Q, u = 2^-24 and Q = max_b |R_b| X + |t_b|, of
// X = |c|_1 + the hull's radius. N counts the hull's bones. |r_b| is at most 2 X, and its fourth at most 1.
//   a vertex and a point, however skinned (cluster_bounds.h)   4 N + 16
//   sum_b r_b's fourth: weights add up to 1 within 2 u      4
//   (R_b - R_0) |r_b|: of at most 7 Q, rounded five times   35 N
//   the moved centres' distance: 2 Q, rounded six times     12 N
//   both put together, and added up: of 9 Q each            18 N + 9 N^2
//   |s|, at most 3^0.5 times these; its root                (113 + 64) N + 16 N^2, in place of them
//   |R_0| e: Gram matrix, row sums, root                    12
//   a box's sides; a point's part of a direction            48
// Together less than 128 + 192 N + 16 N^2. And no bound is less than kMinLength, for what underflows.
#include "runtime/src/simd/highway.h"

#if defined(SPHERECHAIN_SKIN_HULLS_H) == defined(HWY_TARGET_TOGGLE)  // once a target
#ifdef SPHERECHAIN_SKIN_HULLS_H
#undef SPHERECHAIN_SKIN_HULLS_H
#else
#define SPHERECHAIN_SKIN_HULLS_H
#endif

#include <cfloat>

#include "runtime/src/clusters/cluster_bounds.h"
#include "runtime/src/clusters/posed_clusters.h"
#include "runtime/src/clusters/slots.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

// How far from the points' hull the vertices of a sphere are at most; infinite where something could overflow.
HWY_INLINE float hull_margin(const PosedClusters& posed, const Hull& hull) {
  constexpr hn::CappedTag<float, 4> kFour;
  constexpr std::size_t kWidth = hn::MaxLanes(kFour);
  const HullBone* const bones = posed.surface->hull_bones.data + hull.first_bone;
  const BoneSize* const sizes = posed.bone_sizes;
  const float center[3] = {hull.center.x, hull.center.y, hull.center.z};
  const float extent = (center[0] < 0 ? -center[0] : center[0]) + (center[1] < 0 ? -center[1] : center[1]) +
                       (center[2] < 0 ? -center[2] : center[2]) + hull.radius;
  float most = 0;
  HWY_ALIGN float strays[4] = {};
  for (std::size_t k = 0; k < hull.bone_count; ++k) {
    const BoneSize& size = sizes[bones[k].bone];
    const float reach = size.norm * extent + size.translation;
    most = reach <= most ? most : reach;
  }
  const float* const first = posed.columns + kColumnFloats * bones[0].bone;
  for (std::size_t lane = 0; lane < 3; lane += kWidth) {
    auto sum = hn::Zero(kFour);
    for (std::size_t k = 1; k < hull.bone_count; ++k) {
      const HullBone& bone = bones[k];
      const float* const columns = posed.columns + kColumnFloats * bone.bone;
      const float off[3] = {bone.x, bone.y, bone.z};
      auto moved = hn::Sub(hn::LoadU(kFour, columns + 12 + lane), hn::LoadU(kFour, first + 12 + lane));
      auto stray = hn::Zero(kFour);
      for (std::size_t j = 0; j < 3; ++j) {
        const auto column = hn::Sub(hn::LoadU(kFour, columns + 4 * j + lane), hn::LoadU(kFour, first + 4 * j + lane));
        moved = hn::MulAdd(column, hn::Set(kFour, center[j]), moved);
        stray = hn::MulAdd(hn::Abs(column), hn::Set(kFour, off[j]), stray);
      }
      sum = hn::Add(hn::MulAdd(hn::Abs(moved), hn::Set(kFour, bone.w), stray), sum);
    }
    hn::StoreU(sum, kFour, strays + lane);
  }
  constexpr float kUnit = 1.0F / 16777216.0F;
  const auto count = static_cast<float>(hull.bone_count);
  const float squared = strays[0] * strays[0] + strays[1] * strays[1] + strays[2] * strays[2];
  const float norm = sizes[bones[0].bone].norm > kMinLength ? sizes[bones[0].bone].norm : kMinLength;
  const float margin = hn::GetLane(hn::Sqrt(hn::Set(kFour, squared))) + norm * hull.slack +
                       (kUnit * most * (128.0F + (192.0F + 16.0F * count) * count) + kMinLength);
  return most < 0x1p60F ? margin : hn::GetLane(hn::Inf(kFour));
}

// kParts registers of an hull's points from `i` on, in the pose; and what they reach.
template <std::size_t kParts>
HWY_INLINE void move_points(const PosedClusters& posed, const Hull& hull, std::size_t i, Vector (&low)[4],
                            Vector (&high)[4]) {
  constexpr Floats kFloats;
  const std::size_t count = hull.point_count;
  const HullBone* const bones = posed.surface->hull_bones.data + hull.first_bone;
  const float* weights = posed.surface->hull_weights.data + hull.first_weight + i;
  const float* const rest = posed.surface->hull_points.data + 3 * std::size_t{hull.first_point} + i;
  float* const out = posed.hulls + 3 * std::size_t{hull.first_point} + i;
  Vector p[3][kParts], moved[3][kParts];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t part = 0; part < kParts; ++part) {
      p[axis][part] = hn::LoadU(kFloats, rest + axis * count + part * kLanes);
      moved[axis][part] = hn::Zero(kFloats);
    }
  }
  for (std::size_t bone = 0; bone < hull.bone_count; ++bone, weights += count) {
    const float* const columns = posed.columns + kColumnFloats * bones[bone].bone;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Vector m0 = hn::Set(kFloats, columns[axis]), m1 = hn::Set(kFloats, columns[4 + axis]),
                   m2 = hn::Set(kFloats, columns[8 + axis]), m3 = hn::Set(kFloats, columns[12 + axis]);
      for (std::size_t part = 0; part < kParts; ++part) {
        const Vector one = hn::MulAdd(m2, p[2][part], hn::MulAdd(m1, p[1][part], hn::MulAdd(m0, p[0][part], m3)));
        moved[axis][part] = hn::MulAdd(hn::LoadU(kFloats, weights + part * kLanes), one, moved[axis][part]);
      }
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t part = 0; part < kParts; ++part) {
      hn::StoreU(moved[axis][part], kFloats, out + axis * count + part * kLanes);
      low[axis] = hn::Min(moved[axis][part], low[axis]);
      high[axis] = hn::Max(moved[axis][part], high[axis]);
    }
  }
}

// An hull's points in the pose, and the sphere's box about them.
HWY_INLINE void bound_hull(const PosedClusters& posed, std::size_t sphere) {
  constexpr Floats kFloats;
  const Hull& hull = posed.surface->hulls.data[sphere];
  if (hull.bone_count == 0) {
    put_box(posed.spheres, sphere, {{FLT_MAX, FLT_MAX, FLT_MAX}, {-FLT_MAX, -FLT_MAX, -FLT_MAX}});
    return;
  }
  Vector low[4], high[4];
  for (std::size_t axis = 0; axis < 4; ++axis) {
    low[axis] = hn::Set(kFloats, FLT_MAX);
    high[axis] = hn::Set(kFloats, -FLT_MAX);
  }
  std::size_t i = 0;
  for (; i + 2 * kLanes <= hull.point_count; i += 2 * kLanes) {
    move_points<2>(posed, hull, i, low, high);
  }
  for (; i < hull.point_count; i += kLanes) {
    move_points<1>(posed, hull, i, low, high);
  }
  const float margin = hull_margin(posed, hull);
  posed.hull_margins[sphere] = margin;
  float lows[4], highs[4];
  reduce_four(low, Lesser(), lows);
  reduce_four(high, Greater(), highs);
  const bool is_bounded = margin <= FLT_MAX;
  Box box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.low[axis] = is_bounded ? lows[axis] - margin : -margin;
    box.high[axis] = is_bounded ? highs[axis] + margin : margin;
  }
  put_box(posed.spheres, sphere, box);
}

// Does a plane across the line of their boxes' middles part two spheres' hulls? Any direction would be as sure; this
// one parts most that can be. Where a margin is infinite the direction is not a number, and nothing is parted.
HWY_INLINE bool hulls_apart(const PosedClusters& posed_a, std::size_t a, const PosedClusters& posed_b, std::size_t b) {
  constexpr Floats kFloats;
  constexpr hn::CappedTag<float, 1> kOne;
  float direction[3], squared = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    direction[axis] = (posed_b.spheres.low[axis][b] + posed_b.spheres.high[axis][b]) -
                      (posed_a.spheres.low[axis][a] + posed_a.spheres.high[axis][a]);
    squared += direction[axis] * direction[axis];
  }
  const Vector x = hn::Set(kFloats, direction[0]), y = hn::Set(kFloats, direction[1]),
               z = hn::Set(kFloats, direction[2]);
  const auto along = [&](const float* points, std::size_t count) HWY_ATTR {
    const Vector first = hn::Mul(x, hn::LoadU(kFloats, points));
    return hn::MulAdd(z, hn::LoadU(kFloats, points + 2 * count),
                      hn::MulAdd(y, hn::LoadU(kFloats, points + count), first));
  };
  const Hull& hull_a = posed_a.surface->hulls.data[a];
  const Hull& hull_b = posed_b.surface->hulls.data[b];
  const float* const points_a = posed_a.hulls + 3 * std::size_t{hull_a.first_point};
  const float* const points_b = posed_b.hulls + 3 * std::size_t{hull_b.first_point};
  Vector most = along(points_a, hull_a.point_count), least = along(points_b, hull_b.point_count);
  for (std::size_t i = kLanes; i < hull_a.point_count; i += kLanes) {
    most = hn::Max(most, along(points_a + i, hull_a.point_count));
  }
  for (std::size_t i = kLanes; i < hull_b.point_count; i += kLanes) {
    least = hn::Min(least, along(points_b + i, hull_b.point_count));
  }
  const float gap = hn::GetLane(hn::MinOfLanes(kFloats, least)) - hn::GetLane(hn::MaxOfLanes(kFloats, most));
  const float length = hn::GetLane(hn::Sqrt(hn::Set(kOne, squared)));
  const float margin = posed_a.hull_margins[a] + posed_b.hull_margins[b];
  return gap > length * margin * (1 + 0x1p-20F) + kMinLength;
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#endif

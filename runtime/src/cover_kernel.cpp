// SPDX-License-Identifier: MIT
// A lane is a leaf, so targets of any width work alike.
//
// The margin for roundings, in units of u Q (see cover.h), to first order. v is a vertex, c the rounded centre; N
// counts bones and morph targets, for each of the latter moves points by at most u X once more.
//   a vertex as SkinJob rounds it: three fma a row, one a bone, in three rows          1.8 N + 7
//   the centre, likewise                                                               1.8 N + 7
//   weights and mid weights that add up to 1 within 2 u: |sum e_b| (|c| + |R| rho)     11
//   the moved points M_b x, and their distances from c                                 (5.2 + 14) D
//   the entries of R, in |R| rho and in |R_b - R| rho                                  1.8 N + 1.8 N D
//   the norms themselves: row sums of the products of columns, roots                   10 + 21 D
//   sums over the bones, and the margin's own sum                                      N + 7 N D + 8 + 7 D
//   morphs: x, rho and the vertices, |R_b| times as much                               5 N + 10 N D, in place of the
//   above
// Together less than 64 + 8 N + (64 + 16 N) D. The first of the two bounds needs less.
//
// Below 2^-63 squares run out of exponents, and below 2^-126 there is 0 where the processor is told so. A root's sum of
// up to 11 operations loses less than 11 * 2^-126 by that, so the root less than 2^-61: |R| and |R_b|, which rho and X
// are multiplied by, |M_b x - m| and |R_b - R| rho, which are weighted by d_b. That is what kLost is for.
#include "cover_kernel.h"

#include "arithmetic.h"
#include "simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cover_kernel.cpp"
#include "highway.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Lanes8 = hn::CappedTag<float, kLeafLanes>;
using V = hn::Vec<Lanes8>;

constexpr float kLost = 0x1p-60F;

// Where in the tables a group's entries start.
struct GroupPlace {
  std::size_t term, morph;
};

// As hn::Max and hn::Min, but what comes of a NaN is the same on every target.
HWY_INLINE V larger(V a, V b) { return hn::IfThenElse(hn::Gt(b, a), b, a); }
HWY_INLINE V smaller(V a, V b) { return hn::IfThenElse(hn::Lt(b, a), b, a); }

HWY_INLINE V dot(V ax, V ay, V az, V bx, V by, V bz) {
  constexpr Lanes8 d;
  return fused(d, az, bz, fused(d, ay, by, hn::Mul(ax, bx)));
}

// `rest` is x, y, z, rho and the X of the margin.
HWY_INLINE void add_morphs(const CoverInputs& in, std::size_t first, std::size_t count, std::size_t lane, V* rest) {
  constexpr Lanes8 d;
  for (std::size_t i = first; i < first + count; ++i) {
    const float scalar = in.morph_weights[in.morph_targets[i]];
    if (scalar == 0) {
      continue;
    }
    const BallLanes& ball = in.morphs[i];
    const V weight = hn::Set(d, scalar), size = hn::Abs(weight);
    const V x = hn::LoadU(d, ball.x + lane), y = hn::LoadU(d, ball.y + lane), z = hn::LoadU(d, ball.z + lane),
            radius = hn::LoadU(d, ball.radius + lane);
    rest[0] = fused(d, weight, x, rest[0]);
    rest[1] = fused(d, weight, y, rest[1]);
    rest[2] = fused(d, weight, z, rest[2]);
    rest[3] = fused(d, size, radius, rest[3]);
    const V extent = hn::Add(hn::Add(hn::Abs(x), hn::Abs(y)), hn::Add(hn::Abs(z), radius));
    rest[4] = fused(d, size, extent, rest[4]);
  }
}

// Row `r` of a matrix times (x, y, z, 1).
HWY_INLINE V move_row(const CoverInputs& in, const float* r, V x, V y, V z) {
  constexpr Lanes8 d;
  return fused(d, hn::Set(d, r[2 * in.column]), z,
               fused(d, hn::Set(d, r[in.column]), y, fused(d, hn::Set(d, r[0]), x, hn::Set(d, r[3 * in.column]))));
}

// At least the spectral norm of the matrix whose rows are these, but for rounding.
HWY_INLINE V norm_of(const V (&r)[3][3]) {
  V gram[3][3];
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = i; j < 3; ++j) {
      gram[i][j] = gram[j][i] = hn::Abs(dot(r[0][i], r[1][i], r[2][i], r[0][j], r[1][j], r[2][j]));
    }
  }
  const V first = hn::Add(hn::Add(gram[0][0], gram[0][1]), gram[0][2]);
  const V second = hn::Add(hn::Add(gram[1][0], gram[1][1]), gram[1][2]);
  const V third = hn::Add(hn::Add(gram[2][0], gram[2][1]), gram[2][2]);
  return hn::Sqrt(larger(larger(first, second), third));
}

// One register's lanes of a group of leaves.
HWY_INLINE void cover_lanes(const CoverInputs& in, std::size_t group, const GroupPlace& at, std::size_t lane,
                            float (&out)[4][kLeafLanes]) {
  constexpr Lanes8 d;
  const BallLanes& ball = in.balls[group];
  V rest[5] = {hn::LoadU(d, ball.x + lane), hn::LoadU(d, ball.y + lane), hn::LoadU(d, ball.z + lane),
               hn::LoadU(d, ball.radius + lane), hn::Zero(d)};
  rest[4] = hn::Add(hn::Add(hn::Abs(rest[0]), hn::Abs(rest[1])), hn::Add(hn::Abs(rest[2]), rest[3]));
  const std::size_t terms = in.term_counts[group];
  const std::size_t morphs = in.morph_counts == nullptr ? 0 : in.morph_counts[group];
  add_morphs(in, at.morph, morphs, lane, rest);
  const V x = rest[0], y = rest[1], z = rest[2], rho = rest[3], extent = rest[4];

  V r[3][3], m[3];
  for (std::size_t i = 0; i < 3; ++i) {
    m[i] = r[i][0] = r[i][1] = r[i][2] = hn::Zero(d);
  }
  for (std::size_t t = at.term; t < at.term + terms; ++t) {
    const float* matrix = in.matrices + in.term_bones[t] * in.stride;
    const V weight = hn::LoadU(d, in.terms[t].weights + lane);
    for (std::size_t i = 0; i < 3; ++i) {
      const float* row = matrix + i * in.row;
      m[i] = fused(d, weight, move_row(in, row, x, y, z), m[i]);
      for (std::size_t j = 0; j < 3; ++j) {
        r[i][j] = fused(d, weight, hn::Set(d, row[j * in.column]), r[i][j]);
      }
    }
  }

  V blend = hn::Mul(rho, norm_of(r)), most = hn::Zero(d), largest = hn::Zero(d), deviations = hn::Zero(d);
  for (std::size_t t = at.term; t < at.term + terms; ++t) {
    const std::size_t bone = in.term_bones[t];
    const float* matrix = in.matrices + bone * in.stride;
    const V deviation = hn::LoadU(d, in.terms[t].deviations + lane);
    const auto moves = hn::Gt(hn::Add(deviation, hn::LoadU(d, in.terms[t].weights + lane)), hn::Zero(d));
    V square = hn::Zero(d), turn = hn::Zero(d);
    for (std::size_t i = 0; i < 3; ++i) {
      const float* row = matrix + i * in.row;
      const V away = hn::Sub(move_row(in, row, x, y, z), m[i]);
      square = fused(d, away, away, square);
      for (std::size_t j = 0; j < 3; ++j) {
        const V difference = hn::Sub(hn::Set(d, row[j * in.column]), r[i][j]);
        turn = fused(d, difference, difference, turn);
      }
    }
    const V distance = hn::Sqrt(square);
    BoneSize size;
    if (bone < in.size_count) {
      size.norm = in.sizes[bone].norm;
      size.translation = in.sizes[bone].translation;
    } else {
      size = bone_size(in, bone);
    }
    const V norm = hn::Set(d, size.norm);
    most = larger(most, hn::IfThenElseZero(moves, fused(d, rho, norm, distance)));
    largest = larger(largest, hn::IfThenElseZero(moves, fused(d, norm, extent, hn::Set(d, size.translation))));
    blend = fused(d, deviation, fused(d, hn::Sqrt(turn), rho, distance), blend);
    deviations = hn::Add(deviations, deviation);
  }
  constexpr float kUnit = 1.0F / 16777216.0F;
  const auto count = static_cast<float>(terms + morphs);
  const V factor =
      fused(d, hn::Set(d, kUnit * (64.0F + 16.0F * count)), deviations, hn::Set(d, kUnit * (64.0F + 8.0F * count)));
  hn::Store(m[0], d, out[0] + lane);
  hn::Store(m[1], d, out[1] + lane);
  hn::Store(m[2], d, out[2] + lane);
  const V lost = fused(d, hn::Set(d, kLost), extent, hn::Set(d, kLost));
  hn::Store(hn::Add(fused(d, factor, largest, smaller(most, blend)), fused(d, deviations, lost, lost)), d,
            out[3] + lane);
}

void cover_leaves(const CoverInputs& in, Sphere* leaves) {
  constexpr Lanes8 d;
  GroupPlace at{0, 0};
  for (std::size_t group = 0; group * kLeafLanes < in.leaf_count; ++group) {
    HWY_ALIGN float out[4][kLeafLanes];
    for (std::size_t lane = 0; lane < kLeafLanes; lane += hn::MaxLanes(d)) {
      cover_lanes(in, group, at, lane, out);
    }
    at.term += in.term_counts[group];
    at.morph += in.morph_counts == nullptr ? 0 : in.morph_counts[group];
    const std::size_t first = group * kLeafLanes;
    for (std::size_t lane = 0; lane < kLeafLanes && first + lane < in.leaf_count; ++lane) {
      Sphere& leaf = leaves[first + lane];
      leaf.x = out[0][lane];
      leaf.y = out[1][lane];
      leaf.z = out[2][lane];
      leaf.radius = out[3][lane];
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace spherechain {
namespace {

SPHERECHAIN_KERNELS(cover_leaves);

}  // namespace

void cover_leaves_from_bones(const CoverInputs& inputs, Target resolved, Sphere* leaves) {
  cover_leaves_kernels[index_of(resolved)](inputs, leaves);
}

}  // namespace spherechain
#endif

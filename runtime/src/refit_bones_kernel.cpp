// SPDX-License-Identifier: MIT
// The inner loop of refit from bones. A lane is a pivot, so targets of any width work alike; sums over the lanes go by
// a fixed tree. Four spheres at a time, so that trees and radii fill vectors too. What passes from one step to the next
// goes over the stack: its lines are in the first cache, and the steps of four spheres overlap with those of the next
// four.
#include <cstring>

#include "arithmetic.h"
#include "bone_refit.h"
#include "simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "refit_bones_kernel.cpp"
#include "highway.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Lanes8 = hn::CappedTag<float, kPivotLanes>;
using Lanes4 = hn::CappedTag<float, 4>;
constexpr std::size_t kChunk = 4;  // spheres

// Where in the tables a group's terms start.
struct TermPlace {
  std::size_t term, morph_term;
};

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#if HWY_TARGET == HWY_AVX3
#include "refit_bones_wide.h"
#endif

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

// out[i] = tree(v[i]), as the header of the job says.
HWY_INLINE void sum_lanes(const float (&v)[kChunk][kPivotLanes], float (&out)[kChunk]) {
#if HWY_TARGET == HWY_SCALAR
  for (std::size_t i = 0; i < kChunk; ++i) {
    out[i] = ((v[i][0] + v[i][4]) + (v[i][2] + v[i][6])) + ((v[i][1] + v[i][5]) + (v[i][3] + v[i][7]));
  }
#else
  const Lanes4 d;
  const auto half = [&](std::size_t i) HWY_ATTR { return hn::Add(hn::Load(d, v[i]), hn::Load(d, v[i] + 4)); };
  const auto quarter = [&](auto a, auto b)
                           HWY_ATTR { return hn::Add(hn::ConcatLowerLower(d, b, a), hn::ConcatUpperUpper(d, b, a)); };
  const auto low = quarter(half(0), half(1)), high = quarter(half(2), half(3));
  hn::Store(hn::Add(hn::ConcatEven(d, high, low), hn::ConcatOdd(d, high, low)), d, out);
#endif
}

// Eight lanes one at a time are much code, twice as slow where it is inlined.
#undef SPHERECHAIN_MOVE_GROUP
#if HWY_TARGET == HWY_SCALAR
#define SPHERECHAIN_MOVE_GROUP HWY_NOINLINE
#else
#define SPHERECHAIN_MOVE_GROUP HWY_INLINE
#endif

// One group's centroids, by coordinates. Row r, column c of a matrix lies kRow * r + kColumn * c floats from its start.
template <std::size_t kRow, std::size_t kColumn, bool kMorphs>
SPHERECHAIN_MOVE_GROUP void move_group(const BoneRefitInputs& in, std::size_t group, TermPlace& at,
                                       float (&out)[3][kPivotLanes]) {
  const Lanes8 d;
  using V = hn::Vec<Lanes8>;
  constexpr std::size_t kParts = kPivotLanes / hn::MaxLanes(Lanes8());
  V left[3][kParts], right[3][kParts];
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t part = 0; part < kParts; ++part) {
      left[row][part] = right[row][part] = hn::Zero(d);
    }
  }
  for (const std::size_t end = at.term + in.term_counts[group]; at.term < end; ++at.term) {
    const BoneTerm& term = in.terms[at.term];
    V x[kParts], y[kParts], z[kParts], w[kParts];
    for (std::size_t part = 0; part < kParts; ++part) {
      const std::size_t lane = part * hn::MaxLanes(d);
      x[part] = hn::LoadU(d, term.x + lane);
      y[part] = hn::LoadU(d, term.y + lane);
      z[part] = hn::LoadU(d, term.z + lane);
      w[part] = hn::LoadU(d, term.w + lane);
    }
    if (kMorphs) {
      for (const std::size_t last = at.morph_term + in.morph_term_counts[at.term]; at.morph_term < last;
           ++at.morph_term) {
        const MorphTerm& morph = in.morph_terms[at.morph_term];
        const V weight = hn::Set(d, in.morph_weights[in.morph_targets[at.morph_term]]);
        for (std::size_t part = 0; part < kParts; ++part) {
          const std::size_t lane = part * hn::MaxLanes(d);
          x[part] = fused(d, weight, hn::LoadU(d, morph.x + lane), x[part]);
          y[part] = fused(d, weight, hn::LoadU(d, morph.y + lane), y[part]);
          z[part] = fused(d, weight, hn::LoadU(d, morph.z + lane), z[part]);
        }
      }
    }
    const float* matrix = in.matrices + in.term_bones[at.term] * in.stride;
    for (std::size_t row = 0; row < 3; ++row) {
      const float* m = matrix + kRow * row;
      const V m0 = hn::Set(d, m[0]), m1 = hn::Set(d, m[kColumn]), m2 = hn::Set(d, m[2 * kColumn]),
              m3 = hn::Set(d, m[3 * kColumn]);
      for (std::size_t part = 0; part < kParts; ++part) {
        left[row][part] = fused(d, m2, z[part], fused(d, m0, x[part], left[row][part]));
        right[row][part] = fused(d, m3, w[part], fused(d, m1, y[part], right[row][part]));
      }
    }
  }
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t part = 0; part < kParts; ++part) {
      hn::Store(hn::Add(left[row][part], right[row][part]), d, out[row] + part * hn::MaxLanes(d));
    }
  }
}

// The shares of a group in the centre, added to those of the sphere's groups before it.
HWY_INLINE void share(const float (&p)[3][kPivotLanes], const float* weights, bool is_first, std::size_t i,
                      float (&s)[3][kChunk][kPivotLanes]) {
  const Lanes8 d;
  for (std::size_t lane = 0; lane < kPivotLanes; lane += hn::MaxLanes(d)) {
    const auto weight = hn::LoadU(d, weights + lane);
    for (std::size_t row = 0; row < 3; ++row) {
      const auto moved = hn::Load(d, p[row] + lane);
      hn::Store(is_first ? hn::Mul(weight, moved) : fused(d, weight, moved, hn::Load(d, s[row][i] + lane)), d,
                s[row][i] + lane);
    }
  }
}

// The distances of a group's first `used` pivots from the centre, added to those of the sphere's groups before it.
HWY_INLINE void add_distances(const float (&p)[3][kPivotLanes], const float (&center)[3][kChunk], std::size_t i,
                              std::size_t used, bool is_first, float (&distances)[kPivotLanes]) {
  const Lanes8 d;
  const auto x = hn::Set(d, center[0][i]), y = hn::Set(d, center[1][i]), z = hn::Set(d, center[2][i]);
  for (std::size_t lane = 0; lane < kPivotLanes; lane += hn::MaxLanes(d)) {
    const auto dx = hn::Sub(hn::Load(d, p[0] + lane), x);
    const auto dy = hn::Sub(hn::Load(d, p[1] + lane), y);
    const auto dz = hn::Sub(hn::Load(d, p[2] + lane), z);
    auto distance = hn::Sqrt(fused(d, dz, dz, fused(d, dy, dy, hn::Mul(dx, dx))));
    if (used < kPivotLanes) {
      distance = hn::IfThenElseZero(hn::FirstN(d, used > lane ? used - lane : 0), distance);
    }
    hn::Store(is_first ? distance : hn::Add(hn::Load(d, distances + lane), distance), d, distances + lane);
  }
}

template <std::size_t kRow, std::size_t kColumn, bool kMorphs>
HWY_INLINE void refit_all(const BoneRefitInputs& in, Sphere* spheres) {
#if HWY_TARGET == HWY_AVX3
  if (in.group_count == in.sphere_count) {
    return wide::refit_all<kRow, kColumn, kMorphs>(in, spheres);
  }
#endif
  const bool calibrated = in.rule == RefitRule::kCalibrated, fit = in.radius == RadiusKind::kFit;
  std::size_t group = 0;
  TermPlace at{0, 0};
  for (std::size_t first = 0; first < in.sphere_count; first += kChunk) {
    const std::size_t count = in.sphere_count - first < kChunk ? in.sphere_count - first : kChunk;
    // Lanes of the spheres that the last chunk lacks stay whatever finite figure they are.
    HWY_ALIGN float p[kChunk][3][kPivotLanes];
    HWY_ALIGN float s[3][kChunk][kPivotLanes], distances[kChunk][kPivotLanes];
    HWY_ALIGN float center[3][kChunk], mean[kChunk];
    HWY_ALIGN float pivots[kChunk] = {1, 1, 1, 1}, size[kChunk] = {}, spread[kChunk] = {1, 1, 1, 1};
    if (count < kChunk) {
      for (std::size_t i = count; i < kChunk; ++i) {
        for (std::size_t lane = 0; lane < kPivotLanes; ++lane) {
          s[0][i][lane] = s[1][i][lane] = s[2][i][lane] = distances[i][lane] = 0;
        }
      }
    }
    const std::size_t first_group = group;
    const TermPlace start = at;
    bool kept = true;  // p holds all centroids of the chunk
    for (std::size_t i = 0; i < count; ++i) {
      const RestSphere& rest = in.rest[first + i];
      pivots[i] = static_cast<float>(rest.pivot_count);
      const float wanted = fit ? rest.radius : rest.detect_radius;
      size[i] = calibrated ? wanted : wanted / rest.radius;  // exactly 1 for the fit radius
      spread[i] = rest.pivot_spread;
      kept = kept && rest.pivot_count <= kPivotLanes;
      for (std::size_t k = 0; k < rest.pivot_count; k += kPivotLanes, ++group) {
        move_group<kRow, kColumn, kMorphs>(in, group, at, p[i]);
        share(p[i], in.weights[group].values, k == 0, i, s);
      }
    }
    for (std::size_t row = 0; row < 3; ++row) {
      sum_lanes(s[row], center[row]);
    }
    if (kept) {
      for (std::size_t i = 0; i < count; ++i) {
        add_distances(p[i], center, i, in.rest[first + i].pivot_count, true, distances[i]);
      }
    } else {  // there is no memory to keep any number of centroids in
      TermPlace again = start;
      std::size_t at_group = first_group;
      for (std::size_t i = 0; i < count; ++i) {
        const std::size_t pivot_count = in.rest[first + i].pivot_count;
        for (std::size_t k = 0; k < pivot_count; k += kPivotLanes, ++at_group) {
          move_group<kRow, kColumn, kMorphs>(in, at_group, again, p[i]);
          const std::size_t used = pivot_count - k < kPivotLanes ? pivot_count - k : kPivotLanes;
          add_distances(p[i], center, i, used, k == 0, distances[i]);
        }
      }
    }
    sum_lanes(distances, mean);
    HWY_ALIGN Sphere last[kChunk];
    auto* out = reinterpret_cast<float*>(count == kChunk ? spheres + first : last);
    const Lanes4 d;
    for (std::size_t i = 0; i < kChunk; i += hn::MaxLanes(d)) {
      const auto m = hn::Div(hn::Load(d, mean + i), hn::Load(d, pivots + i));
      const auto scale = hn::Load(d, size + i);
      const auto radius = calibrated ? hn::Mul(scale, hn::Div(m, hn::Load(d, spread + i))) : hn::Mul(m, scale);
      hn::StoreInterleaved4(hn::Load(d, center[0] + i), hn::Load(d, center[1] + i), hn::Load(d, center[2] + i), radius,
                            d, out + 4 * i);
    }
    for (std::size_t i = 0; count < kChunk && i < count; ++i) {
      spheres[first + i] = last[i];
    }
  }
}

template <std::size_t kRow, std::size_t kColumn>
HWY_INLINE void refit_with_or_without_morphs(const BoneRefitInputs& in, Sphere* spheres) {
  if (in.morph_weights == nullptr) {
    refit_all<kRow, kColumn, false>(in, spheres);
  } else {
    refit_all<kRow, kColumn, true>(in, spheres);
  }
}

void refit_bones(const BoneRefitInputs& in, Sphere* spheres) {
  switch (in.layout) {
    case MatrixLayout::kRowMajor3x4:
    case MatrixLayout::kRowMajor4x4:
      return refit_with_or_without_morphs<4, 1>(in, spheres);
    case MatrixLayout::kColumnMajor4x4:
      return refit_with_or_without_morphs<1, 4>(in, spheres);
    case MatrixLayout::kColumnMajor3x4:
      return refit_with_or_without_morphs<1, 3>(in, spheres);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace spherechain {
namespace {

SPHERECHAIN_KERNELS(refit_bones);

}  // namespace

void refit_from_pivots(const BoneRefitInputs& inputs, Target resolved, Sphere* spheres) {
  refit_bones_kernels[index_of(resolved)](inputs, spheres);
}

}  // namespace spherechain
#endif

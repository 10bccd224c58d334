// SPDX-License-Identifier: MIT
// A matrix's figure is a register, one instance a lane; a pivot's is the same for all of them.
#include "crowd_refit.h"

#include "arithmetic.h"
#include "crowd_lanes.h"
#include "simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "crowd_refit.cpp"
#include "highway.h"
#include "lane_matrices.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::ScalableTag<float>;
using Vector = hn::Vec<Floats>;
constexpr std::size_t kLanes = hn::MaxLanes(Floats());

// Pivots at a time: three sums each, four figures of the matrix and of the pivot; targets of sixteen registers have
// those.
constexpr std::size_t kAtATime = 4;

// One instance a lane, as transpose() does with matrices.
HWY_INLINE void transpose_morph_weights(const LaneRefit& batch) {
  for (std::size_t target = 0; target < batch.morph_count; ++target) {
    float* const out = batch.morph_weights + target * kLanes;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      out[lane] = lane < batch.count ? batch.inputs.morph_weights[lane * batch.morph_count + target] : 0;
    }
  }
}

struct GroupPlace {
  std::size_t term, morph_term;
};

// What the columns kFirst and kFirst + 2 of a term's matrix add to pivots [first, first + kAtATime) of its group.
template <bool kMorphs, std::size_t kFirst>
HWY_INLINE void add_columns(const LaneRefit& batch, const GroupPlace& at, std::size_t first,
                            Vector (&sums)[3][kAtATime]) {
  constexpr Floats kFloats;
  const BoneRefitInputs& in = batch.inputs;
  const BoneTerm& term = in.terms[at.term];
  const float* matrix = batch.matrices + in.term_bones[at.term] * kMatrixFloats * kLanes;
  const float* const columns[] = {term.x + first, term.y + first, term.z + first, term.w + first};
  for (std::size_t column = kFirst; column < 4; column += 2) {
    const Vector m0 = hn::Load(kFloats, matrix + column * kLanes),
                 m1 = hn::Load(kFloats, matrix + (4 + column) * kLanes),
                 m2 = hn::Load(kFloats, matrix + (8 + column) * kLanes);
    for (std::size_t k = 0; k < kAtATime; ++k) {
      Vector q = hn::Set(kFloats, columns[column][k]);
      if (kMorphs && column < 3) {
        for (std::size_t i = 0; i < in.morph_term_counts[at.term]; ++i) {
          const MorphTerm& morph = in.morph_terms[at.morph_term + i];
          const float* const deltas[] = {morph.x, morph.y, morph.z};
          const float* weight = batch.morph_weights + in.morph_targets[at.morph_term + i] * kLanes;
          q = fused(kFloats, hn::Load(kFloats, weight), hn::Set(kFloats, deltas[column][first + k]), q);
        }
      }
      sums[0][k] = fused(kFloats, m0, q, sums[0][k]);
      sums[1][k] = fused(kFloats, m1, q, sums[1][k]);
      sums[2][k] = fused(kFloats, m2, q, sums[2][k]);
    }
  }
}

// The sums over a group's terms of two columns. Returns where the next group starts.
template <bool kMorphs, std::size_t kFirst>
HWY_INLINE GroupPlace sum_columns(const LaneRefit& batch, GroupPlace at, std::size_t end, std::size_t first,
                                  Vector (&sums)[3][kAtATime]) {
  constexpr Floats kFloats;
  for (std::size_t k = 0; k < kAtATime; ++k) {
    sums[0][k] = sums[1][k] = sums[2][k] = hn::Zero(kFloats);
  }
  for (; at.term < end; ++at.term) {
    add_columns<kMorphs, kFirst>(batch, at, first, sums);
    at.morph_term += kMorphs ? batch.inputs.morph_term_counts[at.term] : 0;
  }
  return at;
}

// Two of the distances whose squares `roots` holds.
HWY_INLINE void take_roots(std::size_t first, Vector (&roots)[kPivotLanes]) {
  roots[first] = hn::Sqrt(roots[first]);
  roots[first + 1] = hn::Sqrt(roots[first + 1]);
}

// The centroids of a group's first `used` pivots; those of spare lanes are 0. Meanwhile takes the square roots of eight
// other figures, a few at a time: the unit that takes them is slow, and a register's worth of instances waits for none.
template <bool kMorphs>
HWY_INLINE void move_group(const LaneRefit& batch, std::size_t group, std::size_t used, GroupPlace& at,
                           Vector (&roots)[kPivotLanes], Vector (&out)[3][kPivotLanes]) {
  constexpr Floats kFloats;
  const std::size_t end = at.term + batch.inputs.term_counts[group];
  GroupPlace next = at;
  for (std::size_t first = 0; first < kPivotLanes; first += kAtATime) {
    if (first >= used) {
      take_roots(first, roots);
      take_roots(first + 2, roots);
      for (std::size_t k = 0; k < kAtATime; ++k) {
        out[0][first + k] = out[1][first + k] = out[2][first + k] = hn::Zero(kFloats);
      }
      continue;
    }
    Vector even[3][kAtATime];
    sum_columns<kMorphs, 0>(batch, at, end, first, even);
    for (std::size_t k = 0; k < kAtATime; ++k) {
      for (std::size_t row = 0; row < 3; ++row) {
        out[row][first + k] = even[row][k];
      }
    }
    take_roots(first, roots);
    Vector odd[3][kAtATime];
    next = sum_columns<kMorphs, 1>(batch, at, end, first, odd);
    for (std::size_t k = 0; k < kAtATime; ++k) {
      for (std::size_t row = 0; row < 3; ++row) {
        out[row][first + k] = hn::Add(out[row][first + k], odd[row][k]);
      }
    }
    take_roots(first + 2, roots);
  }
  at = next;
}

HWY_INLINE Vector tree(const Vector (&v)[kPivotLanes]) {
  return hn::Add(hn::Add(hn::Add(v[0], v[4]), hn::Add(v[2], v[6])), hn::Add(hn::Add(v[1], v[5]), hn::Add(v[3], v[7])));
}

// A sphere's radius from its pivots' distances, summed over its groups.
HWY_INLINE void finish(const LaneRefit& batch, std::size_t sphere, const Vector (&distances)[kPivotLanes]) {
  constexpr Floats kFloats;
  const BoneRefitInputs& in = batch.inputs;
  const RestSphere& rest = in.rest[sphere];
  const Vector mean = hn::Div(tree(distances), hn::Set(kFloats, static_cast<float>(rest.pivot_count)));
  const float wanted = in.radius == RadiusKind::kFit ? rest.radius : rest.detect_radius;
  const Vector radius = in.rule == RefitRule::kCalibrated
                            ? hn::Mul(hn::Set(kFloats, wanted), hn::Div(mean, hn::Set(kFloats, rest.pivot_spread)))
                            : hn::Mul(mean, hn::Set(kFloats, wanted / rest.radius));
  hn::Store(radius, kFloats, batch.lanes + kLaneFigures * kLanes * sphere + 3 * kLanes);
}

// The squares of a group's distances from the centre; 0 for spare lanes.
HWY_INLINE void square_distances(const Vector (&p)[3][kPivotLanes], const Vector (&center)[3], std::size_t used,
                                 Vector (&squares)[kPivotLanes]) {
  constexpr Floats kFloats;
  for (std::size_t lane = 0; lane < kPivotLanes; ++lane) {
    const Vector dx = hn::Sub(p[0][lane], center[0]), dy = hn::Sub(p[1][lane], center[1]),
                 dz = hn::Sub(p[2][lane], center[2]);
    squares[lane] = lane < used ? fused(kFloats, dz, dz, fused(kFloats, dy, dy, hn::Mul(dx, dx))) : hn::Zero(kFloats);
  }
}

// The header of RefitBonesJob has the arithmetic. The distances of a sphere of one group are taken while the next
// sphere is moved.
template <bool kMorphs>
HWY_INLINE void refit_all(const LaneRefit& batch) {
  constexpr Floats kFloats;
  const BoneRefitInputs& in = batch.inputs;
  std::size_t group = 0;
  GroupPlace at{0, 0};
  Fetcher fetcher(batch, in.sphere_count);
  Vector p[3][kPivotLanes], shares[3][kPivotLanes], center[3], roots[kPivotLanes], distances[kPivotLanes];
  for (std::size_t lane = 0; lane < kPivotLanes; ++lane) {
    roots[lane] = distances[lane] = shares[0][lane] = shares[1][lane] = shares[2][lane] = hn::Zero(kFloats);
  }
  bool is_waiting = false;  // the sphere before, for its `roots`
  for (std::size_t i = 0; i < in.sphere_count; ++i) {
    fetcher.fetch();
    const std::size_t pivot_count = in.rest[i].pivot_count, first_group = group;
    const GroupPlace start = at;
    for (std::size_t k = 0; k < pivot_count; k += kPivotLanes, ++group) {
      move_group<kMorphs>(batch, group, pivot_count - k, at, roots, p);
      if (is_waiting) {
        finish(batch, i - 1, roots);
        is_waiting = false;
      }
      for (std::size_t lane = 0; lane < kPivotLanes; ++lane) {
        const Vector weight = hn::Set(kFloats, in.weights[group].values[lane]);
        for (std::size_t row = 0; row < 3; ++row) {
          const Vector pivot = p[row][lane];
          shares[row][lane] = k == 0 ? hn::Mul(weight, pivot) : fused(kFloats, weight, pivot, shares[row][lane]);
        }
      }
    }
    float* const out = batch.lanes + kLaneFigures * kLanes * i;
    for (std::size_t row = 0; row < 3; ++row) {
      center[row] = tree(shares[row]);
      hn::Store(center[row], kFloats, out + row * kLanes);
    }
    if (pivot_count <= kPivotLanes) {
      square_distances(p, center, pivot_count, roots);
      is_waiting = true;
      continue;
    }
    GroupPlace again = start;
    for (std::size_t k = 0; k < pivot_count; k += kPivotLanes) {  // there is no memory to keep any number of them in
      move_group<kMorphs>(batch, first_group + k / kPivotLanes, pivot_count - k, again, roots, p);
      square_distances(p, center, pivot_count - k, roots);
      for (std::size_t lane = 0; lane < kPivotLanes; ++lane) {
        const Vector distance = hn::Sqrt(roots[lane]);
        distances[lane] = k == 0 ? distance : hn::Add(distances[lane], distance);
      }
    }
    finish(batch, i, distances);
  }
  if (is_waiting) {
    for (std::size_t first = 0; first < kPivotLanes; first += 2) {
      take_roots(first, roots);
    }
    finish(batch, in.sphere_count - 1, roots);
  }
}

void refit_batch(const LaneRefit& batch) {
  if (batch.inputs.sphere_count == 0) {
    return;
  }
  transpose(batch);
  if (batch.inputs.morph_weights == nullptr) {
    refit_all<false>(batch);
  } else {
    transpose_morph_weights(batch);
    refit_all<true>(batch);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace spherechain {
namespace {

SPHERECHAIN_KERNELS(refit_batch);

}  // namespace

void refit_lanes_from_pivots(Target resolved, const LaneRefit& batch) {
  refit_batch_kernels[index_of(resolved)](batch);
}

void refit_lanes(Target resolved, const LaneRefit& batch) {
  if (batch.inputs.rule == RefitRule::kMoments) {
    refit_lanes_from_moments(resolved, batch);
  } else {
    refit_lanes_from_pivots(resolved, batch);
  }
}

}  // namespace spherechain
#endif

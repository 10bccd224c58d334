// SPDX-License-Identifier: MIT
// The crowd's kernel, thread by thread, in steps with a barrier between them. It is compiled for the device, and by any
// C++ compiler for the tests, which run a block's threads one after the other, step by step. The arithmetic is that of
// refit_bones.h and detect.h: multiply-adds where fused() is written, and nowhere else.
#pragma once

#include <cfloat>
#include <cmath>
#include <cstring>

#include "crowd_view.h"

namespace spherechain::cuda {

SPHERECHAIN_HD float fused(float a, float b, float c) {
#if defined(__CUDA_ARCH__)
  return __fmaf_rn(a, b, c);
#else
  return std::fma(a, b, c);
#endif
}

SPHERECHAIN_HD void add_to(std::uint32_t* shared, std::uint32_t value) {
#if defined(__CUDA_ARCH__)
  atomicAdd(shared, value);
#else
  *shared += value;
#endif
}

SPHERECHAIN_HD void set_bits(std::uint32_t* shared, std::uint32_t value) {
#if defined(__CUDA_ARCH__)
  atomicOr(shared, value);
#else
  *shared |= value;
#endif
}

SPHERECHAIN_HD std::uint64_t reserve(std::uint64_t* count, std::uint32_t value) {
#if defined(__CUDA_ARCH__)
  return atomicAdd(reinterpret_cast<unsigned long long*>(count), static_cast<unsigned long long>(value));
#else
  *count += value;
  return *count - value;
#endif
}

SPHERECHAIN_HD std::uint32_t lowest_bit(std::uint32_t word) {
#if defined(__CUDA_ARCH__)
  return __ffs(static_cast<int>(word)) - 1;
#else
  return static_cast<std::uint32_t>(__builtin_ctz(word));
#endif
}

// The bits of `word` moved up by one, the sign of `value` below them.
SPHERECHAIN_HD std::uint32_t shift_in_sign(std::uint32_t word, float value) {
#if defined(__CUDA_ARCH__)
  return __funnelshift_l(__float_as_uint(value), word, 1);
#else
  return word << 1 | (value < 0 ? 1U : 0U);  // a NaN the device computes has no sign
#endif
}

// Whether it is so for any lane of the warp, or of those that run together: lanes stay together in loops that ask it.
SPHERECHAIN_HD bool any_lane(bool is_so) {
#if defined(__CUDA_ARCH__)
  return __any_sync(0xFFFFFFFFU, is_so) != 0;
#else
  return is_so;
#endif
}

SPHERECHAIN_HD void raise_to(std::uint32_t* shared, float value) {  // value >= 0
#if defined(__CUDA_ARCH__)
  atomicMax(shared, __float_as_uint(value));
#else
  float own = 0;
  std::memcpy(&own, shared, sizeof own);
  own = own < value ? value : own;
  std::memcpy(shared, &own, sizeof own);
#endif
}

SPHERECHAIN_HD std::uint32_t count_bits(std::uint32_t word) {
#if defined(__CUDA_ARCH__)
  return static_cast<std::uint32_t>(__popc(word));
#else
  return static_cast<std::uint32_t>(__builtin_popcount(word));
#endif
}

// What sqrtf does where `x` is from kLeastRoot to kMostRoot, without its test for that.
inline constexpr float kLeastRoot = 0x1p-100F, kMostRoot = 0x1p100F;
SPHERECHAIN_HD float usual_root(float x) {
#if defined(__CUDA_ARCH__)
  float inverse;
  asm("rsqrt.approx.ftz.f32 %0, %1;" : "=f"(inverse) : "f"(x));
  const float root = x * inverse;
  return __fmaf_rn(__fmaf_rn(-root, root, x), 0.5F * inverse, root);
#else
  return sqrtf(x);
#endif
}

// What a warp is to do next: on the device each warp that asks gets the next place; the tests' warps, whose threads run
// one after another, take turns.
SPHERECHAIN_HD std::uint32_t deal(std::uint32_t* dealt, const Place& at, std::uint32_t round) {
#if defined(__CUDA_ARCH__)
  std::uint32_t place = 0;
  if (at.lane() == 0) {
    place = atomicAdd(dealt, 1U);
  }
  return __shfl_sync(0xFFFFFFFFU, place, 0);
#else
  (void)dealt;
  return round * at.warps() + at.warp();
#endif
}

#if defined(__CUDA_ARCH__)
#define SPHERECHAIN_COPIES_PAST_CACHE (__CUDA_ARCH__ >= 800)
#else
#define SPHERECHAIN_COPIES_PAST_CACHE 0
#endif

// From Ampere on past the first cache, where the tables are. arrive() before the barrier that makes the copies seen.
SPHERECHAIN_HD void copy_past_cache(Float4* shared, const float* from) {
#if SPHERECHAIN_COPIES_PAST_CACHE
  const auto to = static_cast<std::uint32_t>(__cvta_generic_to_shared(shared));
  asm volatile("cp.async.cg.shared.global [%0], [%1], 16;" ::"r"(to), "l"(from) : "memory");
#else
  *shared = *reinterpret_cast<const Float4*>(from);
#endif
}

SPHERECHAIN_HD void arrive() {
#if SPHERECHAIN_COPIES_PAST_CACHE
  asm volatile("cp.async.wait_all;" ::: "memory");
#endif
}

// a / b rounded once, from share = 1 / b, for b from kLeastScale to 1 / kLeastScale and a root of usual_root, or a mean
// of such. The first quotient is off by less than two units in the last place, the second by less than one; what it
// leaves is exact, and so the third is a / b rounded (Markstein's theorem).
SPHERECHAIN_HD float usual_quotient(float a, float b, float share) {
  const float first = a * share, second = fused(fused(-b, first, a), share, first);
  return fused(fused(-b, second, a), share, second);
}

// Lanes past the last instance do as the last one does, and write nothing out.
SPHERECHAIN_HD std::uint32_t instance_of(const GroupView& v, const Place& at, std::uint32_t lane) {
  const std::uint32_t instance = at.block * kLanes + lane;
  return instance < v.instance_count ? instance : v.instance_count - 1;
}

SPHERECHAIN_HD std::uint32_t instances_in(const GroupView& v, const Place& at) {
  const std::uint32_t left = v.instance_count - at.block * kLanes;
  return left < kLanes ? left : kLanes;
}

SPHERECHAIN_HD void start_dealing(const Shared& shared, const Place& at) {
  if (at.thread < 2) {
    shared.dealt[at.thread] = 0;
  }
}

// Step 1: each warp takes some instances, so that their figures are read in the order they lie in.
SPHERECHAIN_HD void load_matrices(const GroupView& v, const Shared& shared, const Place& at) {
  if (v.wide_matrices) {
    for (std::uint32_t i = at.lane(); i < 3 * v.used_bone_count; i += kLanes) {
      const std::size_t row = v.used_bones[i / 3] * v.bone_stride + i % 3 * v.steps.row;
      for (std::uint32_t to = at.warp(); to < kLanes; to += at.warps()) {
        const float* from = v.matrices + instance_of(v, at, to) * v.instance_stride;
        copy_past_cache(&shared.matrices[i * kPitch + to], from + row);
      }
    }
  } else {
    for (std::uint32_t i = at.lane(); i < 12 * v.used_bone_count; i += kLanes) {
      const std::size_t figure =
          v.used_bones[i / 12] * v.bone_stride + i / 4 % 3 * v.steps.row + i % 4 * v.steps.column;
      for (std::uint32_t to = at.warp(); to < kLanes; to += at.warps()) {
        const float* from = v.matrices + instance_of(v, at, to) * v.instance_stride;
        (&shared.matrices[i / 4 * kPitch + to].x)[i % 4] = from[figure];
      }
    }
  }
  if (v.morph_weights != nullptr) {
    for (std::uint32_t i = at.thread; i < kLanes * v.morph_count; i += at.threads) {
      const std::uint32_t to = i / v.morph_count, target = i % v.morph_count;
      shared.morph_weights[target * kPitch + to] =
          v.morph_weights[std::size_t{instance_of(v, at, to)} * v.morph_count + target];
    }
  }
  arrive();
}

// Step 1 where the instances come as spheres.
SPHERECHAIN_HD void load_spheres(const GroupView& v, const Shared& shared, const Place& at) {
  for (std::uint32_t i = at.lane(); i < v.sphere_count; i += kLanes) {
    for (std::uint32_t to = at.warp(); to < kLanes; to += at.warps()) {
      const Sphere* from = v.spheres + instance_of(v, at, to) * v.sphere_stride + i;
      if (v.wide_spheres) {
        copy_past_cache(&shared.spheres[i * kPitch + to], &from->x);
      } else {
        shared.spheres[i * kPitch + to] = {from->x, from->y, from->z, from->radius};
      }
    }
  }
  arrive();
}

// Four pivots at a time: eight want more registers than leave three blocks to a multiprocessor.
struct HalfSums {
  float even[3][kHalf], odd[3][kHalf];
};

template <bool kIsFirst>
SPHERECHAIN_HD void add_term(const Float4 (&rows)[3], const float (&q)[4][kHalf], HalfSums& sums) {
  SPHERECHAIN_UNROLL
  for (std::size_t k = 0; k < kHalf; ++k) {
    SPHERECHAIN_UNROLL
    for (std::size_t i = 0; i < 3; ++i) {
      float &even = sums.even[i][k], &odd = sums.odd[i][k];
      even = fused(rows[i].z, q[2][k], fused(rows[i].x, q[0][k], kIsFirst ? 0.0F : even));
      odd = fused(rows[i].w, q[3][k], fused(rows[i].y, q[1][k], kIsFirst ? 0.0F : odd));
    }
  }
}

struct TermPlace {
  std::uint32_t term, morph_term;
  std::uint32_t matrix;  // of the term
};

template <bool kMorphs, bool kIsFirst>
SPHERECHAIN_HD void take_term(const GroupView& v, const Shared& shared, std::uint32_t lane, std::uint32_t half,
                              TermPlace& at, HalfSums& sums) {
  const auto* matrices = reinterpret_cast<const unsigned char*>(shared.matrices + lane);
  const auto* matrix = reinterpret_cast<const Float4*>(matrices + at.matrix);
  const HalfTerm& term = v.terms[2 * at.term + half];
  const Float4 rows[] = {matrix[0], matrix[kPitch], matrix[2 * kPitch]}, x = term.x, y = term.y, z = term.z, w = term.w;
  at.matrix = v.term_matrices[at.term + 1];
  float q[4][kHalf] = {{x.x, x.y, x.z, x.w}, {y.x, y.y, y.z, y.w}, {z.x, z.y, z.z, z.w}, {w.x, w.y, w.z, w.w}};
  if (kMorphs) {
    for (std::uint32_t left = v.morph_counts[at.term]; left > 0; --left, ++at.morph_term) {
      const float weight = shared.morph_weights[v.morph_targets[at.morph_term] * kPitch + lane];
      const MorphTerm& morph = v.morph_terms[at.morph_term];
      for (std::size_t k = 0; k < kHalf; ++k) {
        q[0][k] = fused(weight, morph.x[kHalf * half + k], q[0][k]);
        q[1][k] = fused(weight, morph.y[kHalf * half + k], q[1][k]);
        q[2][k] = fused(weight, morph.z[kHalf * half + k], q[2][k]);
      }
    }
  }
  ++at.term;
  add_term<kIsFirst>(rows, q, sums);
}

// The centroids of a group's eight pivots.
template <bool kMorphs>
SPHERECHAIN_HD void move_group(const GroupView& v, const Shared& shared, std::uint32_t lane, const GroupEntry& group,
                               float (&p)[3][kPivotLanes]) {
  const std::uint32_t end = group.first_term + group.term_count;
  SPHERECHAIN_UNROLL
  for (std::uint32_t half = 0; half < 2; ++half) {
    TermPlace at{group.first_term, group.first_morph_term, v.term_matrices[group.first_term]};
    HalfSums sums;
    take_term<kMorphs, true>(v, shared, lane, half, at, sums);
    while (at.term < end) {
      take_term<kMorphs, false>(v, shared, lane, half, at, sums);
    }
    SPHERECHAIN_UNROLL
    for (std::size_t k = 0; k < kHalf; ++k) {
      for (std::size_t i = 0; i < 3; ++i) {
        p[i][kHalf * half + k] = sums.even[i][k] + sums.odd[i][k];
      }
    }
  }
}

SPHERECHAIN_HD float tree(const float (&v)[kPivotLanes]) {
  return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
}

SPHERECHAIN_HD void add_shares(const GroupEntry& group, const float (&p)[3][kPivotLanes], bool is_first,
                               float (&shares)[3][kPivotLanes]) {
  const Float4 low = group.weights[0], high = group.weights[1];
  const float weights[] = {low.x, low.y, low.z, low.w, high.x, high.y, high.z, high.w};
  for (std::size_t k = 0; k < kPivotLanes; ++k) {
    for (std::size_t i = 0; i < 3; ++i) {
      shares[i][k] = is_first ? weights[k] * p[i][k] : fused(weights[k], p[i][k], shares[i][k]);
    }
  }
}

SPHERECHAIN_HD float squared_distance(const float (&p)[3][kPivotLanes], const float (&center)[3], std::size_t k) {
  const float dx = p[0][k] - center[0], dy = p[1][k] - center[1], dz = p[2][k] - center[2];
  return fused(dz, dz, fused(dy, dy, dx * dx));
}

SPHERECHAIN_HD float radius_of(const GroupView& v, const SphereEntry& sphere, float mean) {
  return v.calibrated ? sphere.wanted * (mean / sphere.scale) : mean * sphere.wanted;
}

SPHERECHAIN_HD float usual_radius(const GroupView& v, const SphereEntry& sphere, float mean) {
  return v.calibrated && sphere.scale_share != 0
             ? sphere.wanted * usual_quotient(mean, sphere.scale, sphere.scale_share)
             : radius_of(v, sphere, mean);
}

// Any number of pivots. There is no memory to keep any number of them in, so they are moved twice.
template <bool kMorphs>
SPHERECHAIN_HD_RARE Float4 refit_any_sphere(const GroupView& v, const Shared& shared, std::uint32_t lane,
                                            const SphereEntry& sphere) {
  float p[3][kPivotLanes], shares[3][kPivotLanes] = {}, distances[kPivotLanes] = {};
  for (std::uint32_t g = 0; g < sphere.group_count; ++g) {
    const GroupEntry& group = v.groups[sphere.first_group + g];
    move_group<kMorphs>(v, shared, lane, group, p);
    add_shares(group, p, g == 0, shares);
  }
  const float center[3] = {tree(shares[0]), tree(shares[1]), tree(shares[2])};
  for (std::uint32_t g = 0; g < sphere.group_count; ++g) {
    move_group<kMorphs>(v, shared, lane, v.groups[sphere.first_group + g], p);
    for (std::size_t k = 0; k < kPivotLanes; ++k) {
      const bool is_used = g * kPivotLanes + k < sphere.pivot_count;
      const float distance = is_used ? sqrtf(squared_distance(p, center, k)) : 0.0F;
      distances[k] = g == 0 ? distance : distances[k] + distance;
    }
  }
  const float mean = tree(distances) / static_cast<float>(sphere.pivot_count);
  return {center[0], center[1], center[2], radius_of(v, sphere, mean)};
}

SPHERECHAIN_HD_RARE float any_root(float x) { return sqrtf(x); }

// The same for eight pivots, which is what the baker gives a sphere.
template <bool kMorphs>
SPHERECHAIN_HD Float4 refit_usual_sphere(const GroupView& v, const Shared& shared, std::uint32_t lane,
                                         const SphereEntry& sphere) {
  float p[3][kPivotLanes], shares[3][kPivotLanes] = {}, distances[kPivotLanes];
  move_group<kMorphs>(v, shared, lane, sphere.group, p);
  add_shares(sphere.group, p, true, shares);
  const float center[3] = {tree(shares[0]), tree(shares[1]), tree(shares[2])};
  float least = FLT_MAX, most = 0;
  for (std::size_t k = 0; k < kPivotLanes; ++k) {
    distances[k] = squared_distance(p, center, k);
    least = fminf(least, distances[k]);
    most = fmaxf(most, distances[k]);
  }
  static_assert(kPivotLanes == 8, "the mean is exactly an eighth");
  if (least >= kLeastRoot && most <= kMostRoot) {
    for (std::size_t k = 0; k < kPivotLanes; ++k) {
      distances[k] = usual_root(distances[k]);
    }
    return {center[0], center[1], center[2], usual_radius(v, sphere, tree(distances) * 0.125F)};
  }
  for (std::size_t k = 0; k < kPivotLanes; ++k) {
    distances[k] = any_root(distances[k]);
  }
  return {center[0], center[1], center[2], radius_of(v, sphere, tree(distances) * 0.125F)};
}

// Step 2: a warp a sphere, the dearest first.
template <bool kMorphs>
SPHERECHAIN_HD void refit_spheres(const GroupView& v, const Shared& shared, const Place& at) {
  std::uint32_t place = deal(&shared.dealt[0], at, 0);
  for (std::uint32_t round = 1; place < v.sphere_count; ++round) {
    const SphereEntry& sphere = v.sphere_entries[place];
    place = deal(&shared.dealt[0], at, round);
    shared.spheres[sphere.sphere * kPitch + at.lane()] = sphere.pivot_count == kPivotLanes
                                                             ? refit_usual_sphere<kMorphs>(v, shared, at.lane(), sphere)
                                                             : refit_any_sphere<kMorphs>(v, shared, at.lane(), sphere);
  }
}

// Step 3, where they are asked for: a warp an instance.
SPHERECHAIN_HD void write_spheres(const GroupView& v, const Shared& shared, const Place& at) {
  for (std::uint32_t from = at.warp(); from < instances_in(v, at); from += at.warps()) {
    Sphere* const to = v.refitted + std::size_t{at.block * kLanes + from} * v.sphere_count;
    for (std::uint32_t i = at.lane(); i < v.sphere_count; i += kLanes) {
      const Float4 s = shared.spheres[i * kPitch + from];
      if (v.wide_refitted) {
        *reinterpret_cast<Float4*>(to + i) = s;
      } else {
        to[i] = {s.x, s.y, s.z, s.w};
      }
    }
  }
}

// Half of what radii r add to the squared reach of two spheres is at most rp^2 + rq^2. So with p and q seen from the
// instance's first sphere, and power(p) = rp^2 - |p|^2 / 2,
//   power(p) + power(q) + p.q >= ((rp + rq)^2 - |p - q|^2) / 2,
// which is above 0 where they touch. With G = |p|^2 + rp^2 of both, runtime/src/overlap.cpp shows of a sum much as this
// one that it is off by 33 * 2^-24 G at most; here each power adds 2 more. Each is larger by 64 * 2^-24 of its own
// sphere's share of G, and by 2^-120 for what underflows: so the computed sum is above 0 too. For what is too large for
// that, or not finite, it is infinite or no number, and not below 0 either.
SPHERECHAIN_HD float power_of(const Float4& s, const Float4& origin) {
  constexpr float kMargin = 0x1p-18F, kLeast = 0x1p-120F, kMostExtent = 1e36F;
  const float x = s.x - origin.x, y = s.y - origin.y, z = s.z - origin.z;
  const float squared_length = fused(z, z, fused(y, y, x * x)), squared_radius = s.w * s.w;
  const float power = fused(1.0F + kMargin, squared_radius, fused(kMargin - 0.5F, squared_length, kLeast));
  return squared_length + squared_radius <= kMostExtent ? power : INFINITY;
}

// Step 4: a warp a sphere; and the outputs' bits, which lie where the matrices were.
SPHERECHAIN_HD void prepare_pairs(const GroupView& v, const Shared& shared, const Place& at) {
  const std::uint32_t lane = at.lane();
  float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  const Float4 origin = shared.spheres[lane];
  for (std::uint32_t i = at.warp(); i < v.sphere_count; i += at.warps()) {
    Float4 sphere = shared.spheres[i * kPitch + lane];
    if (v.has_padding) {
      sphere.w += v.paddings[i];
      shared.spheres[i * kPitch + lane].w = sphere.w;
    }
    shared.powers[i * kPitch + lane] = power_of(sphere, origin);
    if (v.bounds != nullptr) {
      const float center[] = {sphere.x, sphere.y, sphere.z};
      for (int axis = 0; axis < 3; ++axis) {
        low[axis] = fminf(low[axis], center[axis]);
        high[axis] = fmaxf(high[axis], center[axis]);
      }
    }
  }
  if (v.bounds != nullptr) {
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      shared.boxes[(2 * axis * kMostWarps + at.warp()) * kLanes + lane] = low[axis];
      shared.boxes[((2 * axis + 1) * kMostWarps + at.warp()) * kLanes + lane] = high[axis];
    }
  }
  const std::uint32_t words = half_words(v) * kPitch;
  for (std::uint32_t i = at.thread; v.bits != nullptr && i < words; i += at.threads) {
    shared.bits[i] = 0;
  }
  for (std::uint32_t i = at.thread; v.pairs != nullptr && i < words; i += at.threads) {
    shared.ordered_bits[i] = 0;
  }
  if (at.thread < kLanes) {
    shared.counts[lane] = 0;
    if (v.bounds != nullptr) {
      shared.radii[lane] = 0;
    }
  }
}

// detect.h's rule; `reach` 1 for pairs that are not near ones.
SPHERECHAIN_HD bool touch(const Float4& p, const Float4& q, float reach) {
  const float dx = p.x - q.x, dy = p.y - q.y, dz = p.z - q.z;
  const float s = p.w + q.w, squared = s * s, t = reach * s;
  return ((dx * dx + dy * dy) + dz * dz) < t * t && squared <= FLT_MAX;
}

SPHERECHAIN_HD void report(const GroupView& v, const Shared& shared, std::uint32_t lane, std::uint32_t a,
                           std::uint32_t b) {
  add_to(&shared.counts[lane], 1);
  if (v.bits != nullptr) {
    const std::uint32_t bit = b * (b - 1) / 2 + a;
    set_bits(&shared.bits[bit / 32 * kPitch + lane], 1U << (bit % 32));
  }
  if (v.pairs != nullptr) {
    const std::uint32_t bit = a * (2 * v.sphere_count - a - 1) / 2 + (b - a - 1);
    set_bits(&shared.ordered_bits[bit / 32 * kPitch + lane], 1U << (bit % 32));
  }
}

// Pairs that the test by multiply-adds cannot tell apart from touching ones.
SPHERECHAIN_HD void test_candidates(const GroupView& v, const Shared& shared, std::uint32_t lane, const PairItem& item,
                                    std::uint32_t (&candidates)[2]) {
  while (any_lane((candidates[0] | candidates[1]) != 0)) {
    if ((candidates[0] | candidates[1]) != 0) {
      const bool is_first = candidates[0] != 0;
      const std::uint32_t word = is_first ? candidates[0] : candidates[1];
      const std::uint32_t at = kHalfItem - 1 - lowest_bit(word);
      candidates[0] = is_first ? word & (word - 1) : 0;
      candidates[1] = is_first ? candidates[1] : word & (word - 1);
      const std::uint32_t a = item.first_row + at % kRows;
      const std::uint32_t b = item.first_column + at / kRows + (is_first ? 0 : kHalfColumns);
      if (touch(shared.spheres[a * kPitch + lane], shared.spheres[b * kPitch + lane], 1.0F)) {
        report(v, shared, lane, a, b);
      }
    }
  }
}

SPHERECHAIN_HD void test_item(const GroupView& v, const Shared& shared, std::uint32_t lane, const PairItem& item) {
  const Float4 origin = shared.spheres[lane];
  const std::uint32_t first_row = item.first_row * kPitch + lane, first_column = item.first_column * kPitch + lane;
  const Float4 *row_spheres = shared.spheres + first_row, *column_spheres = shared.spheres + first_column;
  const float *row_powers = shared.powers + first_row, *column_powers = shared.powers + first_column;
  const auto seen_from_origin = [&](const Float4& s, float power) {
    return Float4{s.x - origin.x, s.y - origin.y, s.z - origin.z, power};
  };
  Float4 rows[kRows];
  SPHERECHAIN_UNROLL
  for (std::uint32_t r = 0; r < kRows; ++r) {
    rows[r] = seen_from_origin(row_spheres[r * kPitch], row_powers[r * kPitch]);
  }
  std::uint32_t apart[2] = {0, 0};
  SPHERECHAIN_UNROLL
  for (std::uint32_t c = 0; c < kColumns; ++c) {
    const Float4 column = seen_from_origin(column_spheres[c * kPitch], column_powers[c * kPitch]);
    SPHERECHAIN_UNROLL
    for (std::uint32_t r = 0; r < kRows; ++r) {
      float sum = fused(rows[r].x, column.x, rows[r].w + column.w);
      sum = fused(rows[r].y, column.y, sum);
      sum = fused(rows[r].z, column.z, sum);
      apart[c / kHalfColumns] = shift_in_sign(apart[c / kHalfColumns], sum);
    }
  }
  std::uint32_t candidates[2] = {~apart[0] & item.wanted[0], ~apart[1] & item.wanted[1]};
  test_candidates(v, shared, lane, item, candidates);
}

SPHERECHAIN_HD void test_near(const GroupView& v, const Shared& shared, std::uint32_t lane, const NearEntry& near) {
  if (touch(shared.spheres[near.a * kPitch + lane], shared.spheres[near.b * kPitch + lane], near.reach)) {
    report(v, shared, lane, near.a, near.b);
  }
}

// The middle of the box around all centres, and how far the warp's own spheres reach from there.
SPHERECHAIN_HD Vec3 middle_of(const Shared& shared, const Place& at) {
  float middle[3];
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    float low = INFINITY, high = -INFINITY;
    for (std::uint32_t warp = 0; warp < at.warps(); ++warp) {
      low = fminf(low, shared.boxes[(2 * axis * kMostWarps + warp) * kLanes + at.lane()]);
      high = fmaxf(high, shared.boxes[((2 * axis + 1) * kMostWarps + warp) * kLanes + at.lane()]);
    }
    middle[axis] = 0.5F * low + 0.5F * high;
  }
  return {middle[0], middle[1], middle[2]};
}

SPHERECHAIN_HD void reach_spheres(const GroupView& v, const Shared& shared, const Place& at) {
  const Vec3 middle = middle_of(shared, at);
  float most = 0;
  for (std::uint32_t i = at.warp(); i < v.sphere_count; i += at.warps()) {
    const Float4 s = shared.spheres[i * kPitch + at.lane()];
    const float dx = s.x - middle.x, dy = s.y - middle.y, dz = s.z - middle.z;
    most = fmaxf(most, sqrtf((dx * dx + dy * dy) + dz * dz) + s.w);
  }
  raise_to(&shared.radii[at.lane()], most * (1.0F + 0x1p-20F));  // for what was rounded
}

// Step 5: a warp an item, then a warp some near pairs.
SPHERECHAIN_HD void test_pairs(const GroupView& v, const Shared& shared, const Place& at) {
  constexpr std::uint32_t kNearAtATime = 8;
  const std::uint32_t lane = at.lane();
  std::uint32_t place = deal(&shared.dealt[1], at, 0), round = 1;
  for (; place < v.item_count; ++round) {
    const PairItem item = v.items[place];
    place = deal(&shared.dealt[1], at, round);
    test_item(v, shared, lane, item);
  }
  for (; (place - v.item_count) * kNearAtATime < v.near_count; ++round) {
    const std::uint32_t first = (place - v.item_count) * kNearAtATime;
    const std::uint32_t end = first + kNearAtATime < v.near_count ? first + kNearAtATime : v.near_count;
    place = deal(&shared.dealt[1], at, round);
    for (std::uint32_t i = first; i < end; ++i) {
      test_near(v, shared, lane, v.near[i]);
    }
  }
  if (v.bounds != nullptr) {
    reach_spheres(v, shared, at);
  }
}

// The words of the ordered bits that a warp lists.
struct Part {
  std::uint32_t first, last;
};

SPHERECHAIN_HD Part part_of(const GroupView& v, const Place& at, std::uint32_t warp) {
  const std::uint32_t each = (half_words(v) + at.warps() - 1) / at.warps(), first = warp * each;
  return {first, first + each < half_words(v) ? first + each : half_words(v)};
}

// Step 6: what an instance alone knows; the block's place in the list, and each warp's part of it.
SPHERECHAIN_HD void write_instances(const GroupView& v, const Shared& shared, const Place& at) {
  const std::uint32_t lane = at.lane(), first = at.block * kLanes, count = instances_in(v, at);
  if (at.thread < count && v.counts != nullptr) {
    v.counts[first + lane] = shared.counts[lane];
  }
  if (at.thread < count && v.bounds != nullptr) {
    const Vec3 middle = middle_of(shared, at);
    float radius = 0;
    std::memcpy(&radius, &shared.radii[lane], sizeof radius);
    v.bounds[first + lane] = {middle.x, middle.y, middle.z, radius};
  }
  if (v.bits != nullptr) {
    for (std::uint32_t from = at.warp(); from < count; from += at.warps()) {
      std::uint64_t* const to = v.bits + std::size_t{first + from} * v.bit_words;
      for (std::uint32_t i = lane; i < v.bit_words; i += kLanes) {
        const std::uint32_t* own = shared.bits + 2 * i * kPitch + from;
        to[i] = own[0] | std::uint64_t{own[kPitch]} << 32;
      }
    }
  }
  if (v.pairs != nullptr) {
    if (at.thread == 0) {
      std::uint32_t total = 0;
      for (std::uint32_t i = 0; i < count; ++i) {
        total += shared.counts[i];
      }
      *shared.start = reserve(v.pair_count, total);
    }
    const Part part = part_of(v, at, at.warp());
    std::uint32_t own = 0;
    for (std::uint32_t w = part.first; w < part.last; ++w) {
      own += count_bits(shared.ordered_bits[w * kPitch + lane]);
    }
    shared.parts[at.warp() * kLanes + lane] = own;
  }
}

// Step 7: the list, a lane an instance and a warp a part.
SPHERECHAIN_HD void write_pairs(const GroupView& v, const Shared& shared, const Place& at) {
  const std::uint32_t lane = at.lane(), instance = at.block * kLanes + lane;
  if (lane >= instances_in(v, at)) {
    return;
  }
  std::uint64_t place = *shared.start;
  for (std::uint32_t i = 0; i < lane; ++i) {
    place += shared.counts[i];
  }
  if (at.warp() == 0) {
    v.starts[instance] = place;
  }
  for (std::uint32_t warp = 0; warp < at.warp(); ++warp) {
    place += shared.parts[warp * kLanes + lane];
  }
  const Part part = part_of(v, at, at.warp());
  std::uint32_t a = 0, row = 0, row_end = v.sphere_count - 1;  // of a's bits
  for (std::uint32_t w = part.first; w < part.last; ++w) {
    for (std::uint32_t word = shared.ordered_bits[w * kPitch + lane]; word != 0; word &= word - 1, ++place) {
      const std::uint32_t bit = 32 * w + lowest_bit(word);
      while (bit >= row_end) {
        ++a;
        row = row_end;
        row_end += v.sphere_count - 1 - a;
      }
      if (place < v.pair_capacity) {
        v.pairs[place] = {instance, {a, a + 1 + (bit - row)}};
      }
    }
  }
}

// A block. `run` runs a step for its threads and waits for all of them.
template <bool kFromBones, bool kMorphs, typename Run>
SPHERECHAIN_HD void run_block(const GroupView& v, const Shared& shared, const Run& run) {
  if (kFromBones) {
    run([&](const Place& at) {
      start_dealing(shared, at);
      load_matrices(v, shared, at);
    });
    run([&](const Place& at) { refit_spheres<kMorphs>(v, shared, at); });
  } else {
    run([&](const Place& at) {
      start_dealing(shared, at);
      load_spheres(v, shared, at);
    });
  }
  if (kFromBones && v.refitted != nullptr) {
    run([&](const Place& at) { write_spheres(v, shared, at); });
  }
  run([&](const Place& at) { prepare_pairs(v, shared, at); });
  run([&](const Place& at) { test_pairs(v, shared, at); });
  run([&](const Place& at) { write_instances(v, shared, at); });
  if (v.pairs != nullptr) {
    run([&](const Place& at) { write_pairs(v, shared, at); });
  }
}

}  // namespace spherechain::cuda

// SPDX-License-Identifier: MIT
// The inner loop of refit from bones by moments (docs/arithmetic.md, "Refit from bones"). It has three steps:
//   1. Bones: C_b, the matrix of each bone, three rows of four, seen from the origin and the reference bone.
//   2. Grams: G_ab = transposed(C_a) C_b, four by four, for each pair of bones that some sphere of a batch needs.
//   3. Sums: a sphere's centre is the sum of C_b c_b over its bones. The mean squared distance of its pivots from the
//      centre is quadratic in the matrices: the sum of <M_ab, G_ab>, element by element, over its pairs of bones.
// A lane is an element of a 4 by 4 matrix, so vectors of any width add the same numbers in the same order. Steps hand
// over their results on the stack, which stays in the first cache: a batch has at most kMaxMomentPairs Gram matrices.
#include <cstring>

#include "runtime/src/base/arithmetic.h"
#include "runtime/src/refit/inputs.h"
#include "runtime/src/simd/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/src/refit/moments_kernel.cpp"
#include "runtime/src/simd/highway.h"

#include "runtime/src/refit/moments_bones.h"
#include "runtime/src/refit/moments_chunk.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {
namespace moments {

// Computes the Gram matrices of a batch. Lane 4 i + j is element (i, j): the dot product of column i of C_a and column
// j of C_b over the three rows. So each row of C_a is spread (each number over four lanes) and each row of C_b repeated
// (all four numbers in every group of four lanes). Pairs are sorted by `a`: a bone is spread once for all its pairs.
template <bool kKeeps>
HWY_INLINE void find_grams(const BonePair* pair, const BonePair* end, const Bones<kKeeps>& bones, Moment* gram) {
  const Lanes16 d;
  Moved left, right;
  while (pair < end) {
    const std::uint16_t a = pair->a;
    const float* row = bones.of(a, left);
    Vector spreads[3][kParts];
    for (std::size_t part = 0; part < kParts; ++part) {
      spreads[0][part] = spread(row, part);
      spreads[1][part] = spread(row + 4, part);
      spreads[2][part] = spread(row + 8, part);
    }
    do {
      const float* other = bones.of(pair->b, right);
      for (std::size_t part = 0; part < kParts; ++part) {
        Vector sum = hn::Mul(spreads[0][part], repeat(other, part));
        sum = fused(d, spreads[1][part], repeat(other + 4, part), sum);
        sum = fused(d, spreads[2][part], repeat(other + 8, part), sum);
        hn::StoreU(sum, d, gram->values + part * kLanes);
      }
      ++pair;
      ++gram;
    } while (pair < end && pair->a == a);
  }
}

// Positions in the tables: where the next sphere's entries start.
struct Place {
  const std::uint16_t* bones;
  const CenterTerm* centers;
  const std::uint8_t* pair_places;
  const Moment* moments;
};

// Sums up one sphere lane by lane: 16 partial sums of the squared spread, 3 rows of 4 of the centre. finish() adds the
// lanes. The first term is a product and each further one a fused multiply-add, as docs/arithmetic.md fixes it. With
// kBones > 0 the number of bones is known at compile time and the loops unroll; with 0 it is `known_bones`.
template <std::size_t kBones, bool kKeeps>
HWY_INLINE void add_sphere(std::size_t known_bones, const Bones<kKeeps>& bones, const Moment* grams, Place& at,
                           float* center_sums, float* squares) {
  const Lanes16 d;
  const std::size_t bone_count = kBones > 0 ? kBones : known_bones, pair_count = bone_count * (bone_count + 1) / 2;
  Vector center[kParts], square[kParts];
  for (std::size_t part = 0; part < kParts; ++part) {
    const Vector gram = hn::LoadU(d, grams[at.pair_places[0]].values + part * kLanes);
    square[part] = hn::Mul(gram, hn::LoadU(d, at.moments[0].values + part * kLanes));
  }
  HWY_UNROLL(32)
  for (std::size_t i = 1; i < pair_count; ++i) {
    const float *gram = grams[at.pair_places[i]].values, *moment = at.moments[i].values;
    for (std::size_t part = 0; part < kParts; ++part) {
      const Vector own = hn::LoadU(d, gram + part * kLanes);
      square[part] = fused(d, own, hn::LoadU(d, moment + part * kLanes), square[part]);
    }
  }
  Moved spare;
  const float* first = bones.of(at.bones[0], spare);
  for (std::size_t part = 0; part < kParts; ++part) {
    center[part] = hn::Mul(hn::LoadU(d, first + part * kLanes), repeat(&at.centers[0].x, part));
  }
  HWY_UNROLL(32)
  for (std::size_t i = 1; i < bone_count; ++i) {
    const float* rows = bones.of(at.bones[i], spare);
    for (std::size_t part = 0; part < kParts; ++part) {
      const Vector share = repeat(&at.centers[i].x, part);  // x, y, z and w follow each other
      center[part] = fused(d, share, hn::LoadU(d, rows + part * kLanes), center[part]);
    }
  }
  for (std::size_t part = 0; part < kParts; ++part) {
    hn::StoreU(center[part], d, center_sums + part * kLanes);
    hn::StoreU(square[part], d, squares + part * kLanes);
  }
  at.bones += bone_count;
  at.centers += bone_count;
  at.pair_places += pair_count;
  at.moments += pair_count;
}

// Sums up spheres until kSums are kept, then finishes them together: the additions across lanes of one sphere wait for
// each other, those of several spheres do not.
template <bool kKeeps>
class Refit {
 public:
  HWY_INLINE Refit(const RefitInputs& in, const Bones<kKeeps>& bones, Sphere* spheres)
      : bones_(bones),
        at_{in.moments->bones.data, in.moments->centers.data, in.moments->pair_places.data, in.moments->moments.data},
        numbers_(in.moments->spheres.data),
        radii_(in.radius == SC_RADIUS_FIT ? &in.rest->radius : &in.rest->detect_radius),
        spheres_(spheres) {}

  // Adds the spheres of a batch. `grams` are the batch's Gram matrices, [bone_counts, end) its spheres' numbers of
  // bones.
  HWY_INLINE void add(const Moment* grams, const std::uint8_t* bone_counts, const std::uint8_t* end) {
    while (bone_counts < end) {
      bone_counts = add_any_run(grams, bone_counts, end);
    }
  }

  HWY_NOINLINE void finish_all() {
    const std::size_t whole = count_ / kChunk * kChunk;
    for (std::size_t i = 0; i < whole; i += kChunk) {
      finish(sums_, i, kChunk, numbers_ + i, bones_.reference(), spheres_);
    }
    if (whole < count_) {
      for (std::size_t i = count_; i < kSums && i % kChunk != 0; ++i) {  // pads the last chunk with zeros
        std::memset(sums_.centers[i], 0, sizeof sums_.centers[i]);
        std::memset(sums_.squares[i], 0, sizeof sums_.squares[i]);
        sums_.wanted[i] = 0;
      }
      finish(sums_, whole, count_ - whole, numbers_ + whole, bones_.reference(), spheres_);
    }
    numbers_ += count_;
    count_ = 0;
  }

 private:
  // Adds the run of spheres that have as many bones as the first. Returns where the run ends.
  template <std::size_t kBones>
  HWY_INLINE const std::uint8_t* add_run(const Moment* grams, const std::uint8_t* bone_counts,
                                         const std::uint8_t* end) {
    constexpr std::size_t kRestFloats = sizeof(RestSphere) / sizeof(float);
    const std::size_t bone_count = *bone_counts;
    Place at = at_;  // a local copy: the bytes that are read might alias the member, which would then be loaded anew
    std::size_t count = count_;
    do {
      if (count == kSums) {
        count_ = count;
        finish_all();
        count = 0;
      }
      sums_.wanted[count] = radii_[numbers_[count] * kRestFloats];
      add_sphere<kBones>(bone_count, bones_, grams, at, sums_.centers[count], sums_.squares[count]);
      ++count;
      ++bone_counts;
    } while (bone_counts < end && *bone_counts == bone_count);
    at_ = at;
    count_ = count;
    return bone_counts;
  }

  HWY_INLINE const std::uint8_t* add_any_run(const Moment* grams, const std::uint8_t* bone_counts,
                                             const std::uint8_t* end) {
#if SPHERECHAIN_FUSES
    switch (*bone_counts) {
      case 1:
        return add_run<1>(grams, bone_counts, end);
      case 2:
        return add_run<2>(grams, bone_counts, end);
      case 3:
        return add_run<3>(grams, bone_counts, end);
      case 4:
        return add_run<4>(grams, bone_counts, end);
      case 5:
        return add_run<5>(grams, bone_counts, end);
      case 6:
        return add_run<6>(grams, bone_counts, end);
      default:
        break;
    }
#endif
    return add_run<0>(grams, bone_counts, end);
  }

  const Bones<kKeeps>& bones_;
  Place at_;
  const std::uint32_t* numbers_;  // of the spheres whose sums are kept
  const float* radii_;
  Sphere* spheres_;
  std::size_t count_ = 0;
  Sums sums_;
};

template <bool kKeeps>
HWY_INLINE void refit_all(const RefitInputs& in, Sphere* spheres) {
  const MomentTables& tables = *in.moments;
  const Bones<kKeeps> bones(in);
  HWY_ALIGN Moment grams[kMaxMomentPairs];
  Refit<kKeeps> refit(in, bones, spheres);
  const BonePair* pair = tables.pairs.data;
  const std::uint8_t* bone_count = tables.bone_counts.data;
  for (const MomentBatch *batch = tables.batches.data, *end = batch + tables.batches.size; batch < end; ++batch) {
    find_grams(pair, pair + batch->pair_count, bones, grams);
    refit.add(grams, bone_count, bone_count + batch->sphere_count);
    pair += batch->pair_count;
    bone_count += batch->sphere_count;
  }
  refit.finish_all();
}

}  // namespace moments

void refit_by_moments(const RefitInputs& in, Sphere* spheres) {
  if (in.bone_count <= moments::kKeptBones) {
    moments::refit_all<true>(in, spheres);
  } else {
    moments::refit_all<false>(in, spheres);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace spherechain {
namespace {

SPHERECHAIN_KERNELS(refit_by_moments);

}  // namespace

void refit_from_moments(const RefitInputs& inputs, Target resolved, Sphere* spheres) {
  refit_by_moments_kernels[index_of(resolved)](inputs, spheres);
}

}  // namespace spherechain
#endif

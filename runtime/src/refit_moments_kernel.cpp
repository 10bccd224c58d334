// SPDX-License-Identifier: MIT
// The inner loop of refit from bones by moments. A lane is an element of a 4 by 4 matrix, so targets of any width work
// alike. What passes from one step to the next goes over the stack, whose lines are in the first cache: the bones'
// matrices, a batch's Gram matrices, the sums of four spheres.
#include "arithmetic.h"
#include "bone_refit.h"
#include "simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "refit_moments_kernel.cpp"
#include "highway.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {
namespace moments {

namespace hn = hwy::HWY_NAMESPACE;

using Lanes16 = hn::CappedTag<float, kMomentSize>;
using Lanes4 = hn::CappedTag<float, 4>;
using Vector = hn::Vec<Lanes16>;
constexpr std::size_t kLanes = hn::MaxLanes(Lanes16());
constexpr std::size_t kParts = kMomentSize / kLanes;
constexpr std::size_t kChunk = 4;        // spheres
constexpr std::size_t kKeptBones = 256;  // an asset of more has its matrices moved wherever they are read

// A bone's matrix by rows of four, seen from the origin and the reference bone; and a fourth row, which no sum that is
// used reads.
struct Moved {
  HWY_ALIGN float rows[kMomentSize];
};

// Four spheres' sums: of each the centre's three rows of four columns, and the sixteen of its squared spread.
struct Chunk {
  HWY_ALIGN float centers[kChunk][kMomentSize];
  HWY_ALIGN float squares[kChunk][kMomentSize];
  HWY_ALIGN float wanted[kChunk];
  const std::uint32_t* spheres;
};

// Where in the tables a sphere's figures start.
struct Place {
  const std::uint16_t* bones;
  const CenterTerm* centers;
  const std::uint8_t* pair_places;
  const Moment* moments;
};

}  // namespace moments
}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#include "refit_moments_bones.h"
#include "refit_moments_chunk.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {
namespace moments {

// A batch's Gram matrices. Pairs of one bone follow each other: what of it falls on which lane is found once for them.
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

// A sphere's sums. Where the number of its bones is known, kBones, nothing is left to branch on.
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

template <bool kKeeps>
HWY_INLINE void add_any_sphere(std::size_t bone_count, const Bones<kKeeps>& bones, const Moment* grams, Place& at,
                               float* center, float* square) {
#if SPHERECHAIN_FUSES
  switch (bone_count) {
    case 1:
      return add_sphere<1>(1, bones, grams, at, center, square);
    case 2:
      return add_sphere<2>(2, bones, grams, at, center, square);
    case 3:
      return add_sphere<3>(3, bones, grams, at, center, square);
    case 4:
      return add_sphere<4>(4, bones, grams, at, center, square);
    case 5:
      return add_sphere<5>(5, bones, grams, at, center, square);
    case 6:
      return add_sphere<6>(6, bones, grams, at, center, square);
    default:
      break;
  }
#endif
  add_sphere<0>(bone_count, bones, grams, at, center, square);
}

template <bool kKeeps>
HWY_INLINE void refit_all(const BoneRefitInputs& in, Sphere* spheres) {
  const MomentInputs& tables = in.moments;
  const Bones<kKeeps> bones(in);
  HWY_ALIGN Moment grams[kMaxMomentPairs];
  Chunk chunk = {};  // what the last one lacks is 0
  chunk.spheres = tables.spheres;
  constexpr std::size_t kRestFloats = sizeof(RestSphere) / sizeof(float);
  const float* radii = in.radius == RadiusKind::kFit ? &in.rest->radius : &in.rest->detect_radius;
  std::size_t filled = 0;
  Place at{tables.bones, tables.centers, tables.pair_places, tables.moments};
  const BonePair* pair = tables.pairs;
  const std::uint8_t* bone_count = tables.bone_counts;
  for (const MomentBatch *batch = tables.batches, *end = batch + tables.batch_count; batch < end; ++batch) {
    find_grams(pair, pair + batch->pair_count, bones, grams);
    pair += batch->pair_count;
    for (const std::uint8_t* last = bone_count + batch->sphere_count; bone_count < last; ++bone_count) {
      add_any_sphere(*bone_count, bones, grams, at, chunk.centers[filled], chunk.squares[filled]);
      chunk.wanted[filled] = radii[chunk.spheres[filled] * kRestFloats];
      if (++filled == kChunk) {
        finish(chunk, kChunk, bones.reference(), spheres);
        chunk.spheres += kChunk;
        filled = 0;
      }
    }
  }
  if (filled > 0) {
    finish(chunk, filled, bones.reference(), spheres);
  }
}

}  // namespace moments

void refit_by_moments(const BoneRefitInputs& in, Sphere* spheres) {
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

void refit_from_moments(const BoneRefitInputs& inputs, Target resolved, Sphere* spheres) {
  refit_by_moments_kernels[index_of(resolved)](inputs, spheres);
}

}  // namespace spherechain
#endif

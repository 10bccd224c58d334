// SPDX-License-Identifier: MIT
// The inner loop of refit from bones by moments. A lane is an element of a 4 by 4 matrix, so targets of any width work
// alike. A batch's Gram matrices stay on the stack, in the first cache; four spheres at a time are summed up and
// written.
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
constexpr std::size_t kLanes = hn::MaxLanes(Lanes16());
constexpr std::size_t kParts = kMomentSize / kLanes;
constexpr std::size_t kChunk = 4;        // spheres
constexpr std::size_t kKeptBones = 256;  // an asset of more has its matrices moved wherever they are read

// A bone's matrix by rows of four, seen from the origin and the reference bone; and a fourth row, which no sum that is
// used reads.
struct Moved {
  HWY_ALIGN float rows[kMomentSize];
};

// Rows of a matrix in whatever layout: row r, column c lies kRow * r + kColumn * c floats from its start.
template <std::size_t kRow, std::size_t kColumn>
class Bones {
 public:
  explicit Bones(const BoneRefitInputs& in) : in_(in), keeps_(in.bone_count <= kKeptBones) {
    const Lanes4 d;
    for (std::size_t row = 0; row < 4; row += hn::MaxLanes(d)) {
      hn::Store(hn::Zero(d), d, reference_ + row);
    }
    Moved moved;
    move(in.moments.reference, moved);
    for (std::size_t row = 0; row < 3; ++row) {
      reference_[row] = moved.rows[4 * row + 3];
    }
    for (std::size_t bone = 0; keeps_ && bone < in.bone_count; ++bone) {
      move(bone, kept_[bone]);
    }
  }

  // Where `spare` is what it comes to lie in, good until that is used again.
  HWY_INLINE const float* of(std::size_t bone, Moved& spare) const {
    if (keeps_) {
      return kept_[bone].rows;
    }
    move(bone, spare);
    return spare.rows;
  }

  // Where the reference bone takes the origin.
  const float* reference() const { return reference_; }

 private:
  HWY_INLINE void move(std::size_t bone, Moved& out) const {
    const Lanes4 d;
    const float* matrix = in_.matrices + bone * in_.stride;
    HWY_ALIGN float columns[4][4];
    for (std::size_t column = 0; column < 4; ++column) {
      for (std::size_t row = 0; row < 3; ++row) {
        columns[column][row] = matrix[kRow * row + kColumn * column];
      }
      columns[column][3] = 0;
    }
    const Vec3& origin = in_.moments.origin;
    HWY_ALIGN float images[4];
    for (std::size_t row = 0; row < 4; row += hn::MaxLanes(d)) {
      auto image = hn::Load(d, columns[3] + row);
      image = fused(d, hn::Load(d, columns[0] + row), hn::Set(d, origin.x), image);
      image = fused(d, hn::Load(d, columns[1] + row), hn::Set(d, origin.y), image);
      image = fused(d, hn::Load(d, columns[2] + row), hn::Set(d, origin.z), image);
      hn::Store(hn::Sub(image, hn::Load(d, reference_ + row)), d, images + row);
    }
    for (std::size_t row = 0; row < 4; ++row) {
      for (std::size_t column = 0; column < 3; ++column) {
        out.rows[4 * row + column] = columns[column][row];
      }
      out.rows[4 * row + 3] = images[row];
    }
  }

  const BoneRefitInputs& in_;
  bool keeps_;
  HWY_ALIGN float reference_[4];
  Moved kept_[kKeptBones];
};

// Of four floats, as they fall on lane i of a part: row[i % 4], and row[i / 4].
HWY_INLINE hn::Vec<Lanes16> repeat(const float* row, std::size_t part) {
  const Lanes16 d;
#if HWY_TARGET == HWY_SCALAR
  return hn::Set(d, row[part % 4]);
#else
  (void)part;
  return hn::LoadDup128(d, row);
#endif
}

HWY_INLINE hn::Vec<Lanes16> spread(const float* row, std::size_t part) {
  const Lanes16 d;
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3
  alignas(64) static constexpr std::int32_t kSpread[kMomentSize] = {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};
  return hn::TableLookupLanes(hn::LoadDup128(d, row), hn::SetTableIndices(d, kSpread + part * kLanes));
#else
  return hn::Set(d, row[part * kLanes / 4]);
#endif
}

HWY_INLINE void find_gram(const float* left, const float* right, Moment& out) {
  const Lanes16 d;
  for (std::size_t part = 0; part < kParts; ++part) {
    auto sum = hn::Mul(spread(left, part), repeat(right, part));
    sum = fused(d, spread(left + 4, part), repeat(right + 4, part), sum);
    sum = fused(d, spread(left + 8, part), repeat(right + 8, part), sum);
    hn::StoreU(sum, d, out.values + part * kLanes);
  }
}

// Four spheres' sums: of each the centre's three rows of four columns, and the four that its squared spread has come
// down to.
struct Chunk {
  HWY_ALIGN float sums[kChunk][kMomentSize];
  HWY_ALIGN float wanted[kChunk];
  std::size_t spheres[kChunk];
};

// The first two steps of the tree.
HWY_INLINE void fold(const hn::Vec<Lanes16> (&sums)[kParts], float* out) {
  const Lanes4 d;
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3
  const hn::CappedTag<float, 8> half;
#if HWY_TARGET == HWY_AVX3
  const auto eight = hn::Add(hn::LowerHalf(half, sums[0]), hn::UpperHalf(half, sums[0]));
#else
  const auto eight = hn::Add(sums[0], sums[1]);
#endif
  hn::Store(hn::Add(hn::LowerHalf(d, eight), hn::UpperHalf(d, eight)), d, out);
#else
  constexpr std::size_t kQuarter = kParts / 4;
  for (std::size_t i = 0; i < kQuarter; ++i) {
    hn::Store(hn::Add(hn::Add(sums[i], sums[i + 2 * kQuarter]), hn::Add(sums[i + kQuarter], sums[i + 3 * kQuarter])), d,
              out + i * kLanes);
  }
#endif
}

// out[i] = (v[i][0] + v[i][2]) + (v[i][1] + v[i][3]) of the four floats of each sphere from `first` on.
HWY_INLINE void sum_four(const Chunk& chunk, std::size_t first, float* out) {
  const auto& v = chunk.sums;
#if HWY_TARGET == HWY_SCALAR
  for (std::size_t i = 0; i < kChunk; ++i) {
    out[i] = (v[i][first] + v[i][first + 2]) + (v[i][first + 1] + v[i][first + 3]);
  }
#else
  const Lanes4 d;
  const auto half = [&](std::size_t i) HWY_ATTR {
    const auto a = hn::Load(d, v[i] + first), b = hn::Load(d, v[i + 1] + first);
    return hn::Add(hn::ConcatLowerLower(d, b, a), hn::ConcatUpperUpper(d, b, a));
  };
  const auto low = half(0), high = half(2);
  hn::Store(hn::Add(hn::ConcatEven(d, high, low), hn::ConcatOdd(d, high, low)), d, out);
#endif
}

HWY_INLINE void finish(const Chunk& chunk, std::size_t count, const float* reference, Sphere* spheres) {
  const Lanes4 d;
  HWY_ALIGN float figures[4][kChunk];
  for (std::size_t row = 0; row < 4; ++row) {
    sum_four(chunk, 4 * row, figures[row]);
  }
  HWY_ALIGN Sphere out[kChunk];
  for (std::size_t i = 0; i < kChunk; i += hn::MaxLanes(d)) {
    auto squared = hn::Load(d, figures[3] + i);
    squared = hn::IfThenElse(hn::Lt(squared, hn::Zero(d)), hn::Zero(d), squared);
    hn::StoreInterleaved4(hn::Add(hn::Load(d, figures[0] + i), hn::Set(d, reference[0])),
                          hn::Add(hn::Load(d, figures[1] + i), hn::Set(d, reference[1])),
                          hn::Add(hn::Load(d, figures[2] + i), hn::Set(d, reference[2])),
                          hn::Mul(hn::Load(d, chunk.wanted + i), hn::Sqrt(squared)), d, &out[i].x);
  }
  for (std::size_t i = 0; i < count; ++i) {
    spheres[chunk.spheres[i]] = out[i];
  }
}

// Where in the tables a sphere's figures start.
struct Place {
  std::size_t bone, pair;
};

template <std::size_t kRow, std::size_t kColumn>
HWY_INLINE void add_sphere(const MomentInputs& in, std::size_t bone_count, const Bones<kRow, kColumn>& bones,
                           const Moment* grams, Place& at, float* out) {
  const Lanes16 d;
  hn::Vec<Lanes16> center[kParts], sums[kParts];
  Moved spare;
  for (std::size_t i = 0; i < bone_count; ++i, ++at.bone) {
    const float* term = &in.centers[at.bone].x;  // x, y, z and w follow each other
    const float* rows = bones.of(in.bones[at.bone], spare);
    for (std::size_t part = 0; part < kParts; ++part) {
      const auto row = hn::LoadU(d, rows + part * kLanes);
      center[part] = i == 0 ? hn::Mul(row, repeat(term, part)) : fused(d, row, repeat(term, part), center[part]);
    }
  }
  for (std::size_t i = 0; i < bone_count * (bone_count + 1) / 2; ++i, ++at.pair) {
    const float* moment = in.moments[at.pair].values;
    const float* gram = grams[in.pair_places[at.pair]].values;
    for (std::size_t part = 0; part < kParts; ++part) {
      const auto own = hn::LoadU(d, moment + part * kLanes), both = hn::LoadU(d, gram + part * kLanes);
      sums[part] = i == 0 ? hn::Mul(own, both) : fused(d, own, both, sums[part]);
    }
  }
  for (std::size_t part = 0; part < kParts; ++part) {
    hn::StoreU(center[part], d, out + part * kLanes);
  }
  fold(sums, out + 12);
}

template <std::size_t kRow, std::size_t kColumn>
HWY_INLINE void refit_all(const BoneRefitInputs& in, Sphere* spheres) {
  const MomentInputs& tables = in.moments;
  const Bones<kRow, kColumn> bones(in);
  HWY_ALIGN Moment grams[kMaxMomentPairs];
  Chunk chunk = {};
  std::size_t filled = 0;
  Place at{0, 0};
  const BonePair* pair = tables.pairs;
  const std::uint32_t* sphere = tables.spheres;
  const std::uint8_t* bone_count = tables.bone_counts;
  for (std::size_t batch = 0; batch < tables.batch_count; ++batch) {
    Moved left, right;
    for (std::size_t i = 0; i < tables.batches[batch].pair_count; ++i, ++pair) {
      find_gram(bones.of(pair->a, left), bones.of(pair->b, right), grams[i]);
    }
    for (std::size_t i = 0; i < tables.batches[batch].sphere_count; ++i, ++sphere, ++bone_count) {
      add_sphere(tables, *bone_count, bones, grams, at, chunk.sums[filled]);
      const RestSphere& rest = in.rest[*sphere];
      chunk.wanted[filled] = in.radius == RadiusKind::kFit ? rest.radius : rest.detect_radius;
      chunk.spheres[filled++] = *sphere;
      if (filled == kChunk) {
        finish(chunk, kChunk, bones.reference(), spheres);
        filled = 0;
      }
    }
  }
  finish(chunk, filled, bones.reference(), spheres);
}

}  // namespace moments

void refit_by_moments(const BoneRefitInputs& in, Sphere* spheres) {
  switch (in.layout) {
    case MatrixLayout::kRowMajor3x4:
    case MatrixLayout::kRowMajor4x4:
      return moments::refit_all<4, 1>(in, spheres);
    case MatrixLayout::kColumnMajor4x4:
      return moments::refit_all<1, 4>(in, spheres);
    case MatrixLayout::kColumnMajor3x4:
      return moments::refit_all<1, 3>(in, spheres);
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

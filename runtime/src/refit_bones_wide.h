// SPDX-License-Identifier: MIT
// Refit from bones where a register holds sixteen floats: two columns of a matrix at a time, sixteen spheres at a time.
// Included by refit_bones_kernel.cpp once a target; no include guard.

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {
namespace wide {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::ScalableTag<float>;
using Vector = hn::Vec<Floats>;
using Doubles = hn::Repartition<double, Floats>;

constexpr std::size_t kChunk = 16;  // spheres, each of one group
constexpr std::size_t kPairs = kChunk / 2;
static_assert(hn::MaxLanes(Floats()) == kChunk && 2 * kPivotLanes == kChunk, "a pair of groups a register");

struct Chunk {
  float moved[3][kPairs][kChunk], shares[3][kPairs][kChunk], distances[kPairs][kChunk];
  float centers[3][kChunk], wanted[kChunk], scale[kChunk];
  std::int32_t pivots[kChunk];
};

// Two floats that follow each other, again and again.
HWY_INLINE Vector broadcast_pair(const float* pair) {
  double both;
  std::memcpy(&both, pair, sizeof both);
  return hn::BitCast(Floats(), hn::Set(Doubles(), both));
}

// A matrix by rows of four.
template <std::size_t kRow, std::size_t kColumn>
struct Rows;

template <>
struct Rows<4, 1> {
  HWY_INLINE const float* of(const float* matrix) { return matrix; }
};

template <std::size_t kColumn>
struct Rows<1, kColumn> {
  HWY_INLINE Rows() {
    std::int32_t from[kChunk];
    for (std::size_t i = 0; i < kChunk; ++i) {
      from[i] = i < 12 ? static_cast<std::int32_t>(i / 4 + kColumn * (i % 4)) : 0;
    }
    order = hn::SetTableIndices(Floats(), from);
  }
  HWY_INLINE const float* of(const float* matrix) {
    constexpr Floats kFloats;
    const Vector columns = hn::MaskedLoad(hn::FirstN(kFloats, 3 * kColumn + 3), kFloats, matrix);
    hn::Store(hn::TableLookupLanes(columns, order), kFloats, rows);
    return rows;
  }
  hn::Indices512<float> order;
  HWY_ALIGN float rows[kChunk];
};

// Even lanes: the sums of columns 0 and 2, odd ones: of 1 and 3.
template <std::size_t kRow, std::size_t kColumn, bool kMorphs>
HWY_INLINE void move_group(const BoneRefitInputs& in, std::size_t group, TermPlace& at, Rows<kRow, kColumn>& rows,
                           Vector (&sums)[3]) {
  constexpr Floats kFloats;
  constexpr Lanes8 kHalf;
  alignas(64) static constexpr std::int32_t kInterleaved[kChunk] = {0, 8,  1, 9,  2, 10, 3, 11,
                                                                    4, 12, 5, 13, 6, 14, 7, 15};
  const auto interleaved = hn::SetTableIndices(kFloats, kInterleaved);
  sums[0] = sums[1] = sums[2] = hn::Zero(kFloats);
  for (const std::size_t end = at.term + in.term_counts[group]; at.term < end; ++at.term) {
    const float* term = in.terms[at.term].x;  // x, y, z and w follow each other
    Vector xy = hn::LoadU(kFloats, term), zw = hn::LoadU(kFloats, term + kChunk);
    if (kMorphs) {
      auto z = hn::LowerHalf(kHalf, zw);
      const auto w = hn::UpperHalf(kHalf, zw);
      for (const std::size_t last = at.morph_term + in.morph_term_counts[at.term]; at.morph_term < last;
           ++at.morph_term) {
        const float* morph = in.morph_terms[at.morph_term].x;
        const float weight = in.morph_weights[in.morph_targets[at.morph_term]];
        xy = hn::MulAdd(hn::Set(kFloats, weight), hn::LoadU(kFloats, morph), xy);
        z = hn::MulAdd(hn::Set(kHalf, weight), hn::LoadU(kHalf, morph + kChunk), z);
      }
      zw = hn::Combine(kFloats, w, z);
    }
    xy = hn::TableLookupLanes(xy, interleaved);
    zw = hn::TableLookupLanes(zw, interleaved);
    const float* matrix = rows.of(in.matrices + in.term_bones[at.term] * in.stride);
    for (std::size_t row = 0; row < 3; ++row) {
      sums[row] = hn::MulAdd(broadcast_pair(matrix + 4 * row), xy, sums[row]);
      sums[row] = hn::MulAdd(broadcast_pair(matrix + 4 * row + 2), zw, sums[row]);
    }
  }
}

// tree(v) of each sphere's lanes, as the header of the job says.
HWY_INLINE Vector sum_lanes(const float (&v)[kPairs][kChunk]) {
  constexpr Floats kFloats;
  constexpr Doubles kDoubles;
  const auto half = [&](std::size_t pair) HWY_ATTR {  // of four spheres: v0 + v4, v1 + v5, v2 + v6, v3 + v7
    const Vector p = hn::Load(kFloats, v[pair]), q = hn::Load(kFloats, v[pair + 1]);
    return hn::Add(Vector{_mm512_shuffle_f32x4(p.raw, q.raw, 0x88)}, Vector{_mm512_shuffle_f32x4(p.raw, q.raw, 0xDD)});
  };
  const auto quarter = [&](std::size_t pair) HWY_ATTR {  // of eight: the sum of the even ones, and of the odd ones
    const auto p = hn::BitCast(kDoubles, half(pair)), q = hn::BitCast(kDoubles, half(pair + 2));
    return hn::Add(hn::BitCast(kFloats, hn::ConcatEven(kDoubles, q, p)),
                   hn::BitCast(kFloats, hn::ConcatOdd(kDoubles, q, p)));
  };
  const Vector low = quarter(0), high = quarter(4);
  return hn::Add(hn::ConcatEven(kFloats, high, low), hn::ConcatOdd(kFloats, high, low));
}

// Two spheres' centroids, and their shares in the centres.
template <std::size_t kRow, std::size_t kColumn, bool kMorphs>
HWY_INLINE void move_pair(const BoneRefitInputs& in, std::size_t pair, TermPlace& at, Rows<kRow, kColumn>& rows,
                          Chunk& chunk) {
  constexpr Floats kFloats;
  const std::size_t sphere = 2 * pair, place = pair % kPairs;
  Vector first[3], second[3];
  move_group<kRow, kColumn, kMorphs>(in, sphere, at, rows, first);
  Vector weights;
  if (sphere + 1 < in.sphere_count) {
    move_group<kRow, kColumn, kMorphs>(in, sphere + 1, at, rows, second);
    weights = hn::LoadU(kFloats, in.weights[sphere].values);
  } else {
    second[0] = second[1] = second[2] = hn::Zero(kFloats);
    weights = hn::ZeroExtendVector(kFloats, hn::LoadU(Lanes8(), in.weights[sphere].values));
  }
  for (std::size_t row = 0; row < 3; ++row) {
    const Vector moved =
        hn::Add(hn::ConcatEven(kFloats, second[row], first[row]), hn::ConcatOdd(kFloats, second[row], first[row]));
    hn::Store(moved, kFloats, chunk.moved[row][place]);
    hn::Store(hn::Mul(weights, moved), kFloats, chunk.shares[row][place]);
  }
}

HWY_INLINE void find_centers(const BoneRefitInputs& in, std::size_t first, std::size_t count, Chunk& chunk) {
  const bool calibrated = in.rule == RefitRule::kCalibrated, fit = in.radius == RadiusKind::kFit;
  const RestSphere* rest = in.rest + first;
  for (std::size_t i = 0; i < count; ++i) {
    chunk.pivots[i] = rest[i].pivot_count;
    chunk.wanted[i] = fit ? rest[i].radius : rest[i].detect_radius;
    chunk.scale[i] = calibrated ? rest[i].pivot_spread : rest[i].radius;
  }
  for (std::size_t row = 0; row < 3; ++row) {
    hn::Store(sum_lanes(chunk.shares[row]), Floats(), chunk.centers[row]);
  }
}

// The distances of two spheres' centroids from their centres.
HWY_INLINE void measure_pair(std::size_t pair, Chunk& chunk) {
  constexpr Floats kFloats;
  alignas(64) static constexpr std::int32_t kPair[kChunk] = {0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1};
  const auto own = hn::SetTableIndices(kFloats, kPair);
  Vector d[3];
  for (std::size_t row = 0; row < 3; ++row) {
    const Vector both = broadcast_pair(chunk.centers[row] + 2 * pair);
    d[row] = hn::Sub(hn::Load(kFloats, chunk.moved[row][pair]), hn::TableLookupLanes(both, own));
  }
  const auto used = static_cast<std::uint16_t>(((1U << chunk.pivots[2 * pair]) - 1U) |
                                               (((1U << chunk.pivots[2 * pair + 1]) - 1U) << kPivotLanes));
  const Vector distance = hn::Sqrt(hn::MulAdd(d[2], d[2], hn::MulAdd(d[1], d[1], hn::Mul(d[0], d[0]))));
  hn::Store(hn::IfThenElseZero(hn::LoadMaskBits(kFloats, reinterpret_cast<const std::uint8_t*>(&used)), distance),
            kFloats, chunk.distances[pair]);
}

HWY_INLINE void finish(const BoneRefitInputs& in, std::size_t count, const Chunk& chunk, Sphere* spheres) {
  constexpr Floats kFloats;
  const hn::Rebind<std::int32_t, Floats> integers;
  const Vector pivots = hn::ConvertTo(kFloats, hn::Load(integers, chunk.pivots));
  const Vector mean = hn::Div(sum_lanes(chunk.distances), pivots);
  const Vector wanted = hn::Load(kFloats, chunk.wanted), scale = hn::Load(kFloats, chunk.scale);
  const Vector radius = in.rule == RefitRule::kCalibrated
                            ? hn::Mul(wanted, hn::Div(mean, scale))
                            : hn::Mul(mean, hn::Div(wanted, scale));  // exactly 1 for the fit radius
  const Vector x = hn::Load(kFloats, chunk.centers[0]), y = hn::Load(kFloats, chunk.centers[1]),
               z = hn::Load(kFloats, chunk.centers[2]);
  if (count == kChunk) {
    hn::StoreInterleaved4(x, y, z, radius, kFloats, &spheres->x);
  } else {
    HWY_ALIGN Sphere last[kChunk];
    hn::StoreInterleaved4(x, y, z, radius, kFloats, &last[0].x);
    std::memcpy(spheres, last, count * sizeof(Sphere));
  }
}

// What the last chunk lacks.
HWY_INLINE void clear(Chunk& chunk) {
  constexpr Floats kFloats;
  for (std::size_t pair = 0; pair < kPairs; ++pair) {
    for (std::size_t row = 0; row < 3; ++row) {
      hn::Store(hn::Zero(kFloats), kFloats, chunk.shares[row][pair]);
    }
    hn::Store(hn::Zero(kFloats), kFloats, chunk.distances[pair]);
  }
  for (std::size_t i = 0; i < kChunk; ++i) {
    chunk.wanted[i] = chunk.scale[i] = 1;
    chunk.pivots[i] = 1;
  }
}

// Of assets whose spheres are of one group each. The square roots of a chunk are taken while the next one is moved.
template <std::size_t kRow, std::size_t kColumn, bool kMorphs>
HWY_INLINE void refit_all(const BoneRefitInputs& in, Sphere* spheres) {
  Rows<kRow, kColumn> rows;
  TermPlace at{0, 0};
  HWY_ALIGN Chunk chunks[2];
  const std::size_t chunk_count = (in.sphere_count + kChunk - 1) / kChunk;
  std::size_t before = 0;  // spheres in the chunk before
  for (std::size_t i = 0; i <= chunk_count; ++i) {
    Chunk &chunk = chunks[i % 2], &last = chunks[1 - i % 2];
    const std::size_t left = in.sphere_count - i * kChunk;
    const std::size_t count = i == chunk_count ? 0 : left < kChunk ? left : kChunk;
    if (count < kChunk && count > 0) {
      clear(chunk);
    }
    for (std::size_t pair = 0; 2 * pair < count || 2 * pair < before; ++pair) {
      if (2 * pair < count) {
        move_pair<kRow, kColumn, kMorphs>(in, i * kPairs + pair, at, rows, chunk);
      }
      if (2 * pair < before) {
        measure_pair(pair, last);
      }
    }
    if (count > 0) {
      find_centers(in, i * kChunk, count, chunk);
    }
    if (before > 0) {
      finish(in, before, last, spheres + (i - 1) * kChunk);
    }
    before = count;
  }
}

}  // namespace wide
}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

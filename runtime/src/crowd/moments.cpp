// SPDX-License-Identifier: MIT
// Refit by moments of as many instances as a register has lanes, one a lane. docs/arithmetic.md has the
// arithmetic. A batch's Gram matrices are made once for all of its spheres, two columns at a time: half of them fit
// the first cache beside what else is read, and leave one register a sphere to be kept.
#include "runtime/src/base/arithmetic.h"
#include "runtime/src/crowd/lanes.h"
#include "runtime/src/simd/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/src/crowd/moments.cpp"
#include "runtime/src/pairs/sphere_registers.h"
#include "runtime/src/simd/highway.h"

#include <hwy/cache_control.h>

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

using Floats = hn::ScalableTag<float>;
using Vector = hn::Vec<Floats>;
constexpr std::size_t kLanes = hn::MaxLanes(Floats());

constexpr std::size_t kRows = 3, kColumns = 4;
constexpr std::size_t kHalfProducts = 2 * kColumns;  // entries of a Gram matrix at a time: columns c and c + 2

// Where a batch starts in the tables.
struct BatchPlace {
  std::size_t pair, sphere, bone, place;
};

HWY_INLINE float* matrix_of(const LaneRefit& batch, std::size_t bone) {
  return batch.matrices + bone * kMatrixFloats * kLanes;
}

// Matrices from one instance after the other to one a lane, by bone, row and column. The lanes of instances that are
// not there take after the last one.
HWY_INLINE void transpose(const LaneRefit& batch) {
  constexpr Floats kFloats;
  const MatrixLayout layout = batch.inputs.layout;
  const bool by_rows = layout == SC_ROWS_3X4 || layout == SC_ROWS_4X4;
  const std::size_t quads = layout == SC_COLUMNS_4X4 ? 4 : 3;
  std::size_t places[16];  // of a matrix's figures, as they come
  for (std::size_t i = 0; i < 4 * quads; ++i) {
    const std::size_t column_size = quads == 4 ? 4 : 3;
    const std::size_t row = i % column_size, column = i / column_size;
    places[i] = kLanes * (by_rows ? i : row < 3 ? 4 * row + column : kMatrixFloats);
  }
  const float* instances[kLanes];
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    instances[lane] = batch.inputs.matrices + (lane < batch.count ? lane : batch.count - 1) * batch.instance_stride;
  }
  for (std::size_t bone = 0; bone < batch.inputs.bone_count; ++bone) {
    float* const out = batch.matrices + bone * kMatrixFloats * kLanes;
    for (std::size_t quad = 0; quad < quads; ++quad) {
      const std::size_t at = bone * batch.inputs.stride + 4 * quad;
      Vector figures[4];
      const auto four_at = [&](std::size_t lane) -> const Sphere& {  // four figures, as a sphere has
        return *reinterpret_cast<const Sphere*>(instances[lane] + at);
      };
      load_spheres(kFloats, four_at, figures[0], figures[1], figures[2], figures[3]);
      for (std::size_t i = 0; i < 4; ++i) {
        if (places[4 * quad + i] < kLanes * kMatrixFloats) {
          hn::Store(figures[i], kFloats, out + places[4 * quad + i]);
        }
      }
    }
  }
}

// Fetches the matrices of the next call's instances into the cache, a few lines at each of `calls` calls.
class Fetcher {
 public:
  HWY_INLINE Fetcher(const LaneRefit& batch, std::size_t calls)
      : next_(batch.inputs.matrices + batch.count * batch.instance_stride),
        stride_(batch.instance_stride),
        size_((batch.inputs.bone_count - 1) * batch.inputs.stride + kMatrixFloats),
        left_(batch.next_count),
        step_((batch.next_count * (size_ / kLine + 1) + calls - 1) / calls) {}

  HWY_INLINE void fetch() {
    for (std::size_t i = 0; i < step_ && left_ > 0; ++i) {
      hwy::Prefetch(next_ + at_);
      at_ += kLine;
      if (at_ >= size_) {
        at_ = 0;
        next_ += stride_;
        --left_;
      }
    }
  }

 private:
  static constexpr std::size_t kLine = 16;  // floats
  const float* next_;
  std::size_t stride_, size_, left_, step_, at_ = 0;
};

// A bone's matrix, one figure a register.
struct Matrix {
  HWY_INLINE Matrix() {}  // for the target: an implicit one is compiled for the build's own, which NEON refuses
  Vector rows[kRows][kColumns];
};

HWY_INLINE void load_matrix(const float* from, Matrix& matrix) {
  for (std::size_t i = 0; i < kMatrixFloats; ++i) {
    matrix.rows[i / kColumns][i % kColumns] = hn::Load(Floats(), from + i * kLanes);
  }
}

// The fourth column becomes the image of the origin.
HWY_INLINE void move_origin(const Vec3& origin, Matrix& matrix) {
  constexpr Floats kFloats;
  for (Vector(&a)[kColumns] : matrix.rows) {
    a[3] = fused(kFloats, a[0], hn::Set(kFloats, origin.x), a[3]);
    a[3] = fused(kFloats, a[1], hn::Set(kFloats, origin.y), a[3]);
    a[3] = fused(kFloats, a[2], hn::Set(kFloats, origin.z), a[3]);
  }
}

// From bones' matrices to those relative to the origin and its image by the reference bone, which is handed back.
HWY_INLINE void make_relative(const LaneRefit& batch, Vector (&reference)[kRows]) {
  constexpr Floats kFloats;
  const MomentTables& tables = *batch.inputs.moments;
  Matrix matrix;
  load_matrix(matrix_of(batch, tables.reference), matrix);
  move_origin(tables.origin, matrix);
  for (std::size_t row = 0; row < kRows; ++row) {
    reference[row] = matrix.rows[row][3];
  }
  for (std::size_t bone = 0; bone < batch.inputs.bone_count; ++bone) {
    float* const out = matrix_of(batch, bone);
    load_matrix(out, matrix);
    move_origin(tables.origin, matrix);
    for (std::size_t row = 0; row < kRows; ++row) {
      matrix.rows[row][3] = hn::Sub(matrix.rows[row][3], reference[row]);
      for (std::size_t column = 0; column < kColumns; ++column) {
        const Vector figure = matrix.rows[row][column];
        hn::Store(hn::IfThenZeroElse(hn::Lt(hn::Abs(figure), hn::Set(kFloats, kMinMatrixFigure)), figure), kFloats,
                  out + (kColumns * row + column) * kLanes);
      }
    }
  }
}

// Whether row i / 2, column kFirst + 2 (i % 2) of a moment may be other than 0: of a bone's own, where all are 0 below
// the diagonal, only those on it and above.
template <std::size_t kFirst, bool kOwn>
constexpr bool has_product(std::size_t i) {
  return !kOwn || i / 2 <= kFirst + 2 * (i % 2);
}

// Columns kFirst and kFirst + 2 of a pair's Gram matrix, row by row; of a bone with itself, kOwn, what has_product()
// says.
template <std::size_t kFirst, bool kOwn>
HWY_INLINE void multiply_pair(const float* k, const float* l, float* out) {
  constexpr Floats kFloats;
  Vector left[kRows], right[kRows];
  for (std::size_t m = 0; m < kRows; ++m) {
    left[m] = hn::Load(kFloats, l + (kColumns * m + kFirst) * kLanes);
    right[m] = hn::Load(kFloats, l + (kColumns * m + kFirst + 2) * kLanes);
  }
  for (std::size_t row = 0; row < kColumns; ++row) {
    const Vector k0 = hn::Load(kFloats, k + row * kLanes), k1 = hn::Load(kFloats, k + (kColumns + row) * kLanes),
                 k2 = hn::Load(kFloats, k + (2 * kColumns + row) * kLanes);
    if (has_product<kFirst, kOwn>(2 * row)) {
      hn::Store(fused(kFloats, k2, left[2], fused(kFloats, k1, left[1], hn::Mul(k0, left[0]))), kFloats,
                out + 2 * row * kLanes);
    }
    if (has_product<kFirst, kOwn>(2 * row + 1)) {
      hn::Store(fused(kFloats, k2, right[2], fused(kFloats, k1, right[1], hn::Mul(k0, right[0]))), kFloats,
                out + (2 * row + 1) * kLanes);
    }
  }
}

template <std::size_t kFirst>
HWY_INLINE void multiply_pairs(const LaneRefit& batch, const BonePair* pairs, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const float *const k = matrix_of(batch, pairs[i].a), *const l = matrix_of(batch, pairs[i].b);
    float* const out = batch.products + i * kHalfProducts * kLanes;
    if (pairs[i].a == pairs[i].b) {
      multiply_pair<kFirst, true>(k, l, out);
    } else {
      multiply_pair<kFirst, false>(k, l, out);
    }
  }
}

// Takes a pair's products up into the sums of spheres whose moments are `step` apart. Entries that are 0 add nothing.
template <std::size_t kSpheres, std::size_t kFirst, bool kOwn, bool kIsFirst>
HWY_INLINE void add_pair(const float* product, const Moment* moments, std::size_t step,
                         Vector (&sums)[kSpheres][kHalfProducts]) {
  constexpr Floats kFloats;
  for (std::size_t i = 0; i < kHalfProducts; ++i) {
    if (!has_product<kFirst, kOwn>(i)) {
      for (std::size_t s = 0; kIsFirst && s < kSpheres; ++s) {
        sums[s][i] = hn::Set(kFloats, -0.0F);
      }
      continue;
    }
    const Vector g = hn::Load(kFloats, product + i * kLanes);
    for (std::size_t s = 0; s < kSpheres; ++s) {
      const Vector moment = hn::Set(kFloats, moments[s * step].values[kFirst + 2 * i]);
      sums[s][i] = kIsFirst ? hn::Mul(moment, g) : fused(kFloats, moment, g, sums[s][i]);
    }
  }
}

// Sums two columns of the halving tree: the shares of columns kFirst and kFirst + 2 in the mean squared distances of
// kSpheres spheres. The spheres have the same bones, and their moments follow each other.
template <std::size_t kSpheres, std::size_t kFirst>
HWY_INLINE void sum_pairs(const LaneRefit& batch, const std::uint8_t* places, std::size_t bone_count,
                          const Moment* moments, Vector (&out)[kSpheres]) {
  const std::size_t count = bone_count * (bone_count + 1) / 2;
  const auto product = [&](std::size_t pair)
                           HWY_ATTR { return batch.products + places[pair] * kHalfProducts * kLanes; };
  Vector sums[kSpheres][kHalfProducts];
  add_pair<kSpheres, kFirst, true, true>(product(0), moments, count, sums);
  std::size_t pair = 1;
  for (std::size_t others = bone_count - 1; pair < count; --others) {
    for (const std::size_t end = pair + others; pair < end; ++pair) {
      add_pair<kSpheres, kFirst, false, false>(product(pair), moments + pair, count, sums);
    }
    add_pair<kSpheres, kFirst, true, false>(product(pair), moments + pair, count, sums);
    ++pair;
  }
  for (std::size_t s = 0; s < kSpheres; ++s) {
    const Vector(&v)[kHalfProducts] = sums[s];
    const Vector low = hn::Add(hn::Add(v[0], v[4]), hn::Add(v[2], v[6]));
    const Vector high = hn::Add(hn::Add(v[1], v[5]), hn::Add(v[3], v[7]));
    out[s] = hn::Add(low, high);
  }
}

// Takes up a bone's share of a sphere's centre.
template <bool kIsFirst>
HWY_INLINE void add_bone(const float* matrix, const CenterTerm& term, Vector (&sums)[kRows][kColumns]) {
  constexpr Floats kFloats;
  const Vector u[kColumns] = {hn::Set(kFloats, term.x), hn::Set(kFloats, term.y), hn::Set(kFloats, term.z),
                              hn::Set(kFloats, term.w)};
  for (std::size_t row = 0; row < kRows; ++row) {
    for (std::size_t column = 0; column < kColumns; ++column) {
      const Vector c = hn::Load(kFloats, matrix + (kColumns * row + column) * kLanes);
      sums[row][column] = kIsFirst ? hn::Mul(c, u[column]) : fused(kFloats, c, u[column], sums[row][column]);
    }
  }
}

HWY_INLINE void place_center(const LaneRefit& batch, const std::uint16_t* bones, const CenterTerm* terms,
                             std::size_t count, const Vector (&reference)[kRows], float* out) {
  constexpr Floats kFloats;
  Vector sums[kRows][kColumns];
  add_bone<true>(matrix_of(batch, bones[0]), terms[0], sums);
  for (std::size_t i = 1; i < count; ++i) {
    add_bone<false>(matrix_of(batch, bones[i]), terms[i], sums);
  }
  for (std::size_t row = 0; row < kRows; ++row) {
    const Vector sum = hn::Add(hn::Add(sums[row][0], sums[row][2]), hn::Add(sums[row][1], sums[row][3]));
    hn::Store(hn::Add(sum, reference[row]), kFloats, out + row * kLanes);
  }
}

HWY_INLINE Vector radius_of(const LaneRefit& batch, std::size_t sphere, Vector sum) {
  constexpr Floats kFloats;
  const RestSphere& rest = batch.inputs.rest[sphere];
  const float wanted = batch.inputs.radius == SC_RADIUS_FIT ? rest.radius : rest.detect_radius;
  const Vector zero = hn::Zero(kFloats), root = hn::Sqrt(hn::IfThenZeroElse(hn::Le(sum, zero), sum));
  return hn::Mul(hn::Set(kFloats, wanted), hn::MulAdd(sum, zero, root));  // no number where the sum is not finite
}

HWY_INLINE bool have_same_pairs(const std::uint8_t* places, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    if (places[i] != places[count + i]) {
      return false;
    }
  }
  return true;
}

// Half of the spheres' radii: their sums so far are kept where the radii go.
template <bool kIsSecond>
HWY_INLINE void sum_spheres(const LaneRefit& batch, const BatchPlace& start, std::size_t sphere_count,
                            Fetcher& fetcher) {
  constexpr Floats kFloats;
  const MomentTables& tables = *batch.inputs.moments;
  constexpr std::size_t kFirst = kIsSecond ? 1 : 0;
  std::size_t place = start.place;
  const auto finish = [&](std::size_t i, Vector sum) HWY_ATTR {
    const std::size_t sphere = tables.spheres.data[i];
    float* const radius = batch.lanes + (kLaneFigures * sphere + 3) * kLanes;
    hn::Store(kIsSecond ? radius_of(batch, sphere, hn::Add(hn::Load(kFloats, radius), sum)) : sum, kFloats, radius);
    fetcher.fetch();
  };
  for (std::size_t i = start.sphere; i < start.sphere + sphere_count;) {
    const std::size_t bone_count = tables.bone_counts.data[i], count = bone_count * (bone_count + 1) / 2;
    const std::uint8_t* const places = tables.pair_places.data + place;
    const Moment* const moments = tables.moments.data + place;
    if (i + 1 < start.sphere + sphere_count && tables.bone_counts.data[i + 1] == bone_count &&
        have_same_pairs(places, count)) {
      Vector sums[2];
      sum_pairs<2, kFirst>(batch, places, bone_count, moments, sums);
      finish(i, sums[0]);
      finish(i + 1, sums[1]);
      i += 2;
      place += 2 * count;
    } else {
      Vector sums[1];
      sum_pairs<1, kFirst>(batch, places, bone_count, moments, sums);
      finish(i, sums[0]);
      ++i;
      place += count;
    }
  }
}

void refit_batch(const LaneRefit& batch) {
  const MomentTables& tables = *batch.inputs.moments;
  transpose(batch);
  Vector reference[kRows];
  make_relative(batch, reference);
  Fetcher fetcher(batch, 2 * batch.inputs.sphere_count);
  BatchPlace at{0, 0, 0, 0};
  for (std::size_t b = 0; b < tables.batches.size; ++b) {
    const std::size_t pair_count = tables.batches.data[b].pair_count,
                      sphere_count = tables.batches.data[b].sphere_count;
    multiply_pairs<0>(batch, tables.pairs.data + at.pair, pair_count);
    sum_spheres<false>(batch, at, sphere_count, fetcher);
    multiply_pairs<1>(batch, tables.pairs.data + at.pair, pair_count);
    sum_spheres<true>(batch, at, sphere_count, fetcher);
    for (std::size_t i = 0; i < sphere_count; ++i) {
      const std::size_t bone_count = tables.bone_counts.data[at.sphere];
      place_center(batch, tables.bones.data + at.bone, tables.centers.data + at.bone, bone_count, reference,
                   batch.lanes + kLaneFigures * kLanes * tables.spheres.data[at.sphere]);
      ++at.sphere;
      at.bone += bone_count;
      at.place += bone_count * (bone_count + 1) / 2;
    }
    at.pair += pair_count;
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

std::size_t product_floats(const MomentTables& moments) {
  std::size_t most = 0;
  for (const MomentBatch& batch : moments.batches) {
    most = most < batch.pair_count ? batch.pair_count : most;
  }
  return kMomentSize / 2 * kMaxLanes * most;
}

void refit_lanes(Target resolved, const LaneRefit& batch) { refit_batch_kernels[index_of(resolved)](batch); }

}  // namespace spherechain
#endif

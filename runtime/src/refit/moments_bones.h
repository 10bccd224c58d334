// SPDX-License-Identifier: MIT
// Step 1 of refit by moments: loads the matrices of bones, whatever their layout, and moves them to the origin and the
// reference bone.
#include "runtime/src/simd/highway.h"

#if defined(SPHERECHAIN_REFIT_MOMENTS_BONES_H) == defined(HWY_TARGET_TOGGLE)  // once a target
#ifdef SPHERECHAIN_REFIT_MOMENTS_BONES_H
#undef SPHERECHAIN_REFIT_MOMENTS_BONES_H
#else
#define SPHERECHAIN_REFIT_MOMENTS_BONES_H
#endif

#include "runtime/src/refit/inputs.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {
namespace moments {

using Lanes16 = hn::CappedTag<float, kMomentSize>;
using Lanes4 = hn::CappedTag<float, 4>;
using Vector = hn::Vec<Lanes16>;
constexpr std::size_t kLanes = hn::MaxLanes(Lanes16());
constexpr std::size_t kParts = kMomentSize / kLanes;
constexpr std::size_t kKeptBones = 256;  // an asset with more bones moves a matrix each time that it is read

// C_b: three rows of four numbers, and a fourth row, whose values reach no sum that is used.
struct Moved {
  HWY_ALIGN float rows[kMomentSize];
};

// Repeats four floats over the lanes of a part: lane i holds row[i % 4], or row[i / 4].
HWY_INLINE Vector repeat(const float* row, std::size_t part) {
  const Lanes16 d;
#if HWY_TARGET == HWY_SCALAR
  return hn::Set(d, row[part % 4]);
#else
  (void)part;
  return hn::LoadDup128(d, row);
#endif
}

HWY_INLINE Vector spread(const float* row, std::size_t part) {
  const Lanes16 d;
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3
  alignas(64) static constexpr std::int32_t kSpread[kMomentSize] = {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};
  return hn::TableLookupLanes(hn::LoadDup128(d, row), hn::SetTableIndices(d, kSpread + part * kLanes));
#else
  return hn::Set(d, row[part * kLanes / 4]);
#endif
}

#if HWY_TARGET == HWY_SCALAR

// Loads a matrix into rows of four. kColumn is 4 or 3 for columns that lie so many floats apart, 1 for rows of four.
template <std::size_t kColumn>
HWY_INLINE void load_rows(const float* matrix, Vector (&rows)[kParts]) {
  for (std::size_t i = 0; i < kMomentSize; ++i) {
    const std::size_t place = kColumn == 1 ? i : i / 4 + kColumn * (i % 4);
    rows[i] = hn::Set(Lanes16(), i < 12 ? matrix[place] : 0);
  }
}

// Replaces the translation, the fourth column, by the place that the matrix takes the origin to.
HWY_INLINE void move_origin(const Vec3& origin, Vector (&rows)[kParts]) {
  const Lanes16 d;
  for (std::size_t i = 0; i < 12; i += 4) {
    rows[i + 3] = fused(d, rows[i], hn::Set(d, origin.x), rows[i + 3]);
    rows[i + 3] = fused(d, rows[i + 1], hn::Set(d, origin.y), rows[i + 3]);
    rows[i + 3] = fused(d, rows[i + 2], hn::Set(d, origin.z), rows[i + 3]);
  }
}

HWY_INLINE void subtract_column(const Vector (&reference)[kParts], Vector (&rows)[kParts]) {
  for (std::size_t i = 3; i < 12; i += 4) {
    rows[i] = hn::Sub(rows[i], reference[i]);
  }
}

#else

#if HWY_TARGET == HWY_AVX3

template <std::size_t kColumn>
HWY_INLINE void load_rows(const float* matrix, Vector (&rows)[kParts]) {
  const Lanes16 d;
  if (kColumn == 1) {
    rows[0] = hn::MaskedLoad(hn::FirstN(d, 12), d, matrix);
    return;
  }
  alignas(64) std::int32_t from[kMomentSize];
  for (std::size_t i = 0; i < kMomentSize; ++i) {
    from[i] = static_cast<std::int32_t>(i < 12 ? i / 4 + kColumn * (i % 4) : 15);  // a lane that is 0
  }
  const Vector columns = hn::MaskedLoad(hn::FirstN(d, 3 * kColumn + 3), d, matrix);
  rows[0] = hn::TableLookupLanes(columns, hn::SetTableIndices(d, from));
}

#else

template <std::size_t kColumn>
HWY_INLINE void load_rows(const float* matrix, Vector (&rows)[kParts]) {
  const Lanes4 d;
  hn::Vec<Lanes4> row[3];
  if (kColumn == 1) {
    for (std::size_t i = 0; i < 3; ++i) {
      row[i] = hn::LoadU(d, matrix + 4 * i);
    }
  } else {
    const auto x = hn::LoadU(d, matrix), y = hn::LoadU(d, matrix + kColumn), z = hn::LoadU(d, matrix + 2 * kColumn);
    const auto t = kColumn == 4 ? hn::LoadU(d, matrix + 12) : hn::Shuffle0321(hn::LoadU(d, matrix + 8));
    const auto xz = hn::InterleaveLower(d, x, z), yt = hn::InterleaveLower(d, y, t);
    row[0] = hn::InterleaveLower(d, xz, yt);
    row[1] = hn::InterleaveUpper(d, xz, yt);
    row[2] = hn::InterleaveLower(d, hn::InterleaveUpper(d, x, z), hn::InterleaveUpper(d, y, t));
  }
#if HWY_TARGET == HWY_AVX2
  rows[0] = hn::Combine(Lanes16(), row[1], row[0]);
  rows[1] = hn::ZeroExtendVector(Lanes16(), row[2]);
#else
  for (std::size_t i = 0; i < 3; ++i) {
    rows[i] = row[i];
  }
  rows[3] = hn::Zero(d);
#endif
}

#endif

HWY_INLINE hn::Mask<Lanes16> fourth_column() {
  const Lanes16 d;
  alignas(64) static constexpr float kColumns[kMomentSize] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  return hn::Gt(hn::Load(d, kColumns), hn::Zero(d));
}

HWY_INLINE void move_origin(const Vec3& origin, Vector (&rows)[kParts]) {
  const Lanes16 d;
  for (Vector& row : rows) {
    Vector image = fused(d, hn::Broadcast<0>(row), hn::Set(d, origin.x), row);
    image = fused(d, hn::Broadcast<1>(row), hn::Set(d, origin.y), image);
    image = fused(d, hn::Broadcast<2>(row), hn::Set(d, origin.z), image);
    row = hn::IfThenElse(fourth_column(), image, row);
  }
}

HWY_INLINE void subtract_column(const Vector (&reference)[kParts], Vector (&rows)[kParts]) {
  for (std::size_t part = 0; part < kParts; ++part) {
    rows[part] = hn::IfThenElse(fourth_column(), hn::Sub(rows[part], reference[part]), rows[part]);
  }
}

#endif

// Replaces numbers nearer to 0 than kMinMatrixFigure by 0. A NaN stays: it compares false.
HWY_INLINE Vector without_least(Vector v) {
  const Lanes16 d;
  return hn::IfThenZeroElse(hn::Lt(hn::Abs(v), hn::Set(d, kMinMatrixFigure)), v);
}

// All bones. With kKeeps their C_b are computed once and kept; else each is computed when it is asked for.
template <bool kKeeps>
class Bones {
 public:
  HWY_INLINE explicit Bones(const RefitInputs& in) : in_(in) {
    load(in.moments->reference, reference_);
    if (kKeeps) {
      if (in.layout == SC_COLUMNS_4X4) {
        keep<4>();
      } else if (in.layout == SC_COLUMNS_3X4) {
        keep<3>();
      } else {
        keep<1>();
      }
    }
  }

  // C_b of a bone. It stays valid until `spare` is used again.
  HWY_INLINE const float* of(std::size_t bone, Moved& spare) const {
    if (kKeeps) {
      return kept_[bone].rows;
    }
    Vector rows[kParts];
    load(bone, rows);
    store(rows, spare);
    return spare.rows;
  }

  // The reference bone's matrix. Its fourth column is where that bone takes the origin.
  const Vector (&reference() const)[kParts] { return reference_; }

 private:
  HWY_INLINE void load(std::size_t bone, Vector (&rows)[kParts]) const {
    const float* matrix = in_.matrices + bone * in_.stride;
    if (in_.layout == SC_COLUMNS_4X4) {
      load_rows<4>(matrix, rows);
    } else if (in_.layout == SC_COLUMNS_3X4) {
      load_rows<3>(matrix, rows);
    } else {
      load_rows<1>(matrix, rows);
    }
    move_origin(in_.moments->origin, rows);
  }

  HWY_INLINE void store(Vector (&rows)[kParts], Moved& out) const {
    const Lanes16 d;
    subtract_column(reference_, rows);
    for (std::size_t part = 0; part < kParts; ++part) {
      hn::Store(without_least(rows[part]), d, out.rows + part * kLanes);
    }
  }

  template <std::size_t kColumn>
  HWY_INLINE void keep() {
    // Local copies: the stores below might alias the inputs, which would then be loaded anew.
    const Vec3 origin = in_.moments->origin;
    const std::size_t stride = in_.stride;
    const float* matrix = in_.matrices;
    Moved* out = kept_;
    for (const Moved* const end = kept_ + in_.bone_count; out < end; ++out, matrix += stride) {
      Vector rows[kParts];
      load_rows<kColumn>(matrix, rows);
      move_origin(origin, rows);
      store(rows, *out);
    }
  }

  const RefitInputs& in_;
  Vector reference_[kParts];
  Moved kept_[kKeeps ? kKeptBones : 1];
};

}  // namespace moments
}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#endif

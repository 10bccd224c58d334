// SPDX-License-Identifier: MIT
// Cluster bounds: boxes and balls around clusters in a pose, from bones alone.
//
// A cluster's vertices lie at rest in a box of centre c and half extents h, within rho of c. With the mid weights w_b,
// the deviations d_b of the weights from them, M_b = (R_b; t_b) the bones' matrices, R = sum w_b R_b, t = sum w_b t_b
// and m = R c + t, a vertex v = c + p whose weights are w_b + e_b is moved to
//   sum (w_b + e_b) M_b v = m + R p + sum e_b ((M_b c - m) + (R_b - R) p) + sum e_b (m + R p),
// the last of which is rounding, for the e_b add up to 0. So along axis i it is within
//   sum_j |R|_ij h_j + s_i    of m_i,    s_i = sum_b d_b (|M_b c - m|_i + sum_j |R_b - R|_ij h_j),
// and within rho |R| + |s| of m: the box is the lesser of the two, axis by axis. A morph target of weight a whose
// deltas lie within r of e moves c by a e, and adds |a| r to h and rho.
//
// The margin for roundings, to first order, in units of u Q, u = 2^-24 and Q = max_b (|R_b| X + max |t_b|), of
// X = |c|_1 + rho and as much for each morph, times |a|. N counts the group's bones and moving morph targets, D = sum
// d_b. A product added to a sum is rounded twice where the target has no fma. Any partial sum of a row of M_b v is at
// most Q, and of |R_b| h at most 1.8 Q, as |h| is at most 3^0.5 rho.
//   a vertex, skinned here: 3 a row, one a bone               N + 4
//   the same with blended matrices, or without fma          2 N + 8, in place of that
//   sum e_b, of at most 4 u: |m| + |R p|                    11
//   m: the entries of R and t, 2 a bone; then 2 a product   2 N + 6
//   |R| h: likewise, of 1.8 Q                               3.6 N + 11
//   |M_b c - m|, weighted by d_b                            (2 N + 14) D
//   |R_b - R| h, weighted by d_b                            (3.6 N + 25) D
//   the sum s_i over the bones, 2 a bone, of 5.6 Q D        11.2 N D
//   |s|, at most 3^0.5 times these three                    (29.1 N + 80) D, in place of them
//   rho |R| in place of |R| h: Gram matrix, row sums, root  3.6 N + 20
//   box and ball put together, low and high                 12 + 22 D
//   morphs: c, h and rho, 2 each, moved by M_b and R        no more than a bone each
// Together less than 64 + 8 N + (128 + 32 N) D.
#include "runtime/src/simd/highway.h"

#if defined(SPHERECHAIN_SKIN_CLUSTER_BOUNDS_H) == defined(HWY_TARGET_TOGGLE)  // once a target
#ifdef SPHERECHAIN_SKIN_CLUSTER_BOUNDS_H
#undef SPHERECHAIN_SKIN_CLUSTER_BOUNDS_H
#else
#define SPHERECHAIN_SKIN_CLUSTER_BOUNDS_H
#endif

#include "runtime/src/clusters/boxes.h"
#include "runtime/src/clusters/posed_clusters.h"
#include "runtime/src/clusters/slots.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

using GroupLanes = hn::CappedTag<float, kClusterLanes>;
using GroupVector = hn::Vec<GroupLanes>;

// A group's entries in the tables.
struct GroupEntries {
  std::size_t first_term, end_term, first_morph, end_morph;
};

HWY_INLINE GroupEntries entries_of_group(const PosedClusters& posed, std::size_t group) {
  const std::uint32_t* const terms = posed.surface->bounds_first_terms.data + group;
  if (posed.skin.morph_weights == nullptr) {
    return {terms[0], terms[1], 0, 0};
  }
  const std::uint32_t* const morphs = posed.surface->bounds_first_morphs.data + group;
  return {terms[0], terms[1], morphs[0], morphs[1]};
}

// Bounds of a group's clusters in the morphed rest pose.
struct GroupRest {
  HWY_INLINE GroupRest() {}  // for the target: an implicit one is compiled for the build's own, which NEON refuses
  GroupVector center[3], half[3], radius;
  GroupVector extent;  // the X of Q: of the rest and of each morph's part of it, as these may cancel out
};

HWY_INLINE GroupRest rest_of_group(const PosedClusters& posed, std::size_t group, const GroupEntries& entries,
                                   std::size_t lane) {
  constexpr GroupLanes d;
  const Surface& surface = *posed.surface;
  GroupRest out;
  const BoxLanes& box = surface.boxes.data[group];
  const float* const columns[6] = {box.x, box.y, box.z, box.half_x, box.half_y, box.half_z};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    out.center[axis] = hn::LoadU(d, columns[axis] + lane);
    out.half[axis] = hn::LoadU(d, columns[3 + axis] + lane);
  }
  out.radius = hn::LoadU(d, box.radius + lane);
  GroupVector of_morphs = hn::Zero(d);
  for (std::size_t i = entries.first_morph; i < entries.end_morph; ++i) {
    const BallLanes& ball = surface.bounds_morphs.data[i];
    const GroupVector weight = hn::Set(d, posed.skin.morph_weights[surface.bounds_morph_targets.data[i]]);
    const GroupVector x = hn::LoadU(d, ball.x + lane), y = hn::LoadU(d, ball.y + lane), z = hn::LoadU(d, ball.z + lane),
                      reach = hn::LoadU(d, ball.radius + lane), radius = hn::Mul(hn::Abs(weight), reach);
    out.center[0] = hn::MulAdd(weight, x, out.center[0]);
    out.center[1] = hn::MulAdd(weight, y, out.center[1]);
    out.center[2] = hn::MulAdd(weight, z, out.center[2]);
    for (GroupVector& half : out.half) {
      half = hn::Add(half, radius);
    }
    out.radius = hn::Add(out.radius, radius);
    const GroupVector extent = hn::Add(hn::Add(hn::Abs(x), hn::Abs(y)), hn::Add(hn::Abs(z), reach));
    // Twice: once more for what it took from the centre's extent.
    of_morphs = hn::MulAdd(hn::Set(d, 2.0F), hn::Mul(hn::Abs(weight), extent), of_morphs);
  }
  const GroupVector of_center =
      hn::Add(hn::Add(hn::Abs(out.center[0]), hn::Abs(out.center[1])), hn::Add(hn::Abs(out.center[2]), out.radius));
  out.extent = hn::Add(of_center, of_morphs);
  return out;
}

// Below this length squares run out of exponents: no bound is less.
constexpr float kMinLength = 0x1p-60F;

// At least the spectral norm, but for rounding: the root of the greatest row sum of |R^T R|. Infinite where squares
// overflow: without fma their sum is then no number, which a maximum would lose.
HWY_INLINE GroupVector spectral_bound(const GroupVector (&r)[3][4]) {
  GroupVector sums[3];
  const auto dot = [&](std::size_t i, std::size_t j) HWY_ATTR {
    return hn::Abs(hn::MulAdd(r[2][i], r[2][j], hn::MulAdd(r[1][i], r[1][j], hn::Mul(r[0][i], r[0][j]))));
  };
  const GroupVector xy = dot(0, 1), yz = dot(1, 2), zx = dot(2, 0);
  sums[0] = hn::Add(hn::Add(dot(0, 0), xy), zx);
  sums[1] = hn::Add(hn::Add(dot(1, 1), xy), yz);
  sums[2] = hn::Add(hn::Add(dot(2, 2), yz), zx);
  constexpr GroupLanes d;
  const GroupVector norm = hn::Max(hn::Sqrt(hn::Max(hn::Max(sums[0], sums[1]), sums[2])), hn::Set(d, kMinLength));
  const GroupVector all = hn::Add(hn::Add(sums[0], sums[1]), sums[2]);
  return hn::IfThenElse(hn::Eq(all, all), norm, hn::Inf(d));
}

// Balls this much smaller than what their margins are made of may be points: vertices tell. Margins are smaller.
constexpr float kPointReach = 0x1p-11F;

// Clusters from `first` on whose balls are smaller than that: those that have no shape get an empty box, before each is
// paired with each.
inline HWY_NOINLINE void drop_points(const PosedClusters& posed, std::size_t first, GroupVector reach) {
  constexpr GroupLanes d;
  HWY_ALIGN float reaches[kClusterLanes];
  hn::Store(reach, d, reaches);
  for (std::size_t lane = 0; lane < hn::MaxLanes(d); ++lane) {
    const std::size_t cluster = first + lane;
    if (posed.ball_columns[3][cluster] < reaches[lane]) {
      load(posed, cluster);
      const Box box = box_of_span(posed, cluster);
      if (box.low[0] > box.high[0]) {
        put_box(posed.clusters, cluster, box);
      }
    }
  }
}

// One register's lanes of a group of clusters.
HWY_INLINE void bound_lanes(const PosedClusters& posed, std::size_t group, const GroupEntries& entries,
                            std::size_t lane) {
  constexpr GroupLanes d;
  const BoundsTerm* const terms = posed.surface->bounds_terms.data;
  const std::uint32_t* const term_bones = posed.surface->bounds_term_bones.data;
  const BoneSize* const sizes = posed.bone_sizes;
  const BoneMatrices bones = posed.skin.bones;
  const GroupRest rest = rest_of_group(posed, group, entries, lane);

  GroupVector blend[3][4];
  for (auto& row : blend) {
    row[0] = row[1] = row[2] = row[3] = hn::Zero(d);
  }
  for (std::size_t t = entries.first_term; t < entries.end_term; ++t) {
    const float* row = bones.data + term_bones[t] * bones.stride;
    const GroupVector weight = hn::LoadU(d, terms[t].weights + lane);
    for (std::size_t i = 0; i < 3; ++i, row += bones.row) {
      for (std::size_t j = 0; j < 4; ++j) {
        blend[i][j] = hn::MulAdd(weight, hn::Set(d, row[j * bones.column]), blend[i][j]);
      }
    }
  }
  const auto move = [&](GroupVector x, GroupVector y, GroupVector z, GroupVector t) HWY_ATTR {
    return hn::MulAdd(z, rest.center[2], hn::MulAdd(y, rest.center[1], hn::MulAdd(x, rest.center[0], t)));
  };
  GroupVector center[3], strays[3];
  for (std::size_t i = 0; i < 3; ++i) {
    center[i] = move(blend[i][0], blend[i][1], blend[i][2], blend[i][3]);
    strays[i] = hn::Zero(d);
  }
  GroupVector most = hn::Zero(d), deviations = hn::Zero(d);
  for (std::size_t t = entries.first_term; t < entries.end_term; ++t) {
    const std::size_t bone = term_bones[t];
    const float* row = bones.data + bone * bones.stride;
    const GroupVector deviation = hn::LoadU(d, terms[t].deviations + lane);
    const auto moves = hn::Gt(hn::Add(deviation, hn::LoadU(d, terms[t].weights + lane)), hn::Zero(d));
    const GroupVector size = hn::MulAdd(hn::Set(d, sizes[bone].norm), rest.extent, hn::Set(d, sizes[bone].translation));
    most = hn::Max(most, hn::IfThenElseZero(moves, size));
    deviations = hn::Add(deviations, deviation);
    const auto strays_from_mid = hn::Gt(deviation, hn::Zero(d));  // else 0, though what it is to weight may overflow
    for (std::size_t i = 0; i < 3; ++i, row += bones.row) {
      const GroupVector x = hn::Set(d, row[0]), y = hn::Set(d, row[bones.column]),
                        z = hn::Set(d, row[2 * bones.column]);
      GroupVector stray = hn::Abs(hn::Sub(move(x, y, z, hn::Set(d, row[3 * bones.column])), center[i]));
      stray = hn::MulAdd(hn::Abs(hn::Sub(x, blend[i][0])), rest.half[0], stray);
      stray = hn::MulAdd(hn::Abs(hn::Sub(y, blend[i][1])), rest.half[1], stray);
      stray = hn::MulAdd(hn::Abs(hn::Sub(z, blend[i][2])), rest.half[2], stray);
      strays[i] = hn::MulAdd(deviation, hn::IfThenElseZero(strays_from_mid, stray), strays[i]);
    }
  }
  constexpr float kUnit = 1.0F / 16777216.0F;
  const auto count =
      static_cast<float>(entries.end_term - entries.first_term + (entries.end_morph - entries.first_morph));
  const GroupVector factor =
      hn::MulAdd(hn::Set(d, kUnit * (128.0F + 32.0F * count)), deviations, hn::Set(d, kUnit * (64.0F + 8.0F * count)));
  const GroupVector margin = hn::MulAdd(factor, most, hn::Set(d, kMinLength));
  const GroupVector stray =
      hn::Sqrt(hn::MulAdd(strays[2], strays[2], hn::MulAdd(strays[1], strays[1], hn::Mul(strays[0], strays[0]))));
  const GroupVector radius = hn::Add(hn::MulAdd(rest.radius, spectral_bound(blend), stray), margin);
  const std::size_t first = group * kClusterLanes + lane;
  for (std::size_t i = 0; i < 3; ++i) {
    GroupVector half = strays[i];
    for (std::size_t j = 0; j < 3; ++j) {
      half = hn::MulAdd(hn::Abs(blend[i][j]), rest.half[j], half);
    }
    half = hn::Min(hn::Add(half, margin), radius);
    const GroupVector low = hn::Sub(center[i], half), high = hn::Add(center[i], half);
    // A NaN after an overflow becomes an infinite bound: otherwise it would be lost on the way to the sphere's box.
    hn::StoreU(hn::IfThenElse(hn::Eq(low, low), low, hn::Neg(hn::Inf(d))), d, posed.clusters.low[i] + first);
    hn::StoreU(hn::IfThenElse(hn::Eq(high, high), high, hn::Inf(d)), d, posed.clusters.high[i] + first);
    hn::StoreU(center[i], d, posed.ball_columns[i] + first);
  }
  hn::StoreU(radius, d, posed.ball_columns[3] + first);
  const GroupVector reach = hn::Mul(hn::Set(d, kPointReach), most);
  if (HWY_UNLIKELY(!hn::AllFalse(d, hn::Lt(radius, reach)))) {
    drop_points(posed, first, reach);
  }
}

// The groups that hold the clusters [first, end), where they are not bounded yet.
inline HWY_NOINLINE void bound_clusters_by_bones(const PosedClusters& posed, std::size_t first, std::size_t end) {
  for (std::size_t group = first / kClusterLanes; group < (end + kClusterLanes - 1) / kClusterLanes; ++group) {
    if (posed.is_group_bounded[group] == 0) {
      posed.is_group_bounded[group] = 1;
      const GroupEntries entries = entries_of_group(posed, group);
      for (std::size_t lane = 0; lane < kClusterLanes; lane += hn::MaxLanes(GroupLanes())) {
        bound_lanes(posed, group, entries, lane);
      }
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#endif

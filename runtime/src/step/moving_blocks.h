// SPDX-License-Identifier: MIT
// The triangles of a cluster that could touch a box on their way, and which pairs of them a plane parts all the time.
#include "runtime/src/simd/highway.h"

#if defined(SPHERECHAIN_STEP_MOVING_BLOCKS_H) == defined(HWY_TARGET_TOGGLE)  // once a target
#ifdef SPHERECHAIN_STEP_MOVING_BLOCKS_H
#undef SPHERECHAIN_STEP_MOVING_BLOCKS_H
#else
#define SPHERECHAIN_STEP_MOVING_BLOCKS_H
#endif

#include "runtime/src/clusters/blocks.h"
#include "runtime/src/contacts/single_precision.h"
#include "runtime/src/step/moving_skin.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

// How two clusters move together: the mean of what their boxes' middles do. Seen from what goes along with that, boxes
// around their ways are small; whether two triangles touch is the same.
struct Drift {
  float by[3];

  HWY_INLINE Drift(const Box& start_a, const Box& end_a, const Box& start_b, const Box& end_b) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      by[axis] = 0.25F * (((end_a.low[axis] + end_a.high[axis]) - (start_a.low[axis] + start_a.high[axis])) +
                          ((end_b.low[axis] + end_b.high[axis]) - (start_b.low[axis] + start_b.high[axis])));
    }
  }
  HWY_INLINE Box take_from(const Box& box, float sign) const {
    Box out;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      out.low[axis] = box.low[axis] - sign * by[axis];
      out.high[axis] = box.high[axis] - sign * by[axis];
    }
    return out;
  }
};

// As a Block, at the start and at the end; there without the drift.
struct MovingBlock {
  std::size_t cluster, count;
  std::uint32_t triangles[kBlock + kContactPadding];
  std::uint8_t places[3][kBlock];                                             // the corners' slots
  float corners[2][3][3][kBlock + kContactPadding];                           // by pose, by corner, by axis
  float low[3][kBlock + kContactPadding], high[3][kBlock + kContactPadding];  // around the way
  Box box;                                                                    // of all
};

// Where a block's triangle stands in a pose.
HWY_INLINE TriangleCorners corners_of(const PosedClusters& posed, const MovingBlock& block, std::size_t i) {
  const Slots slots = slots_of(posed, block.cluster);
  TriangleCorners out;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t slot = block.places[k][i];
    out.p[k] = {slots.axes[0][slot], slots.axes[1][slot], slots.axes[2][slot]};
  }
  return out;
}

HWY_INLINE Box way_of_spans(const MovingSkin& posed, std::size_t cluster, const Drift& drift, float stray) {
  const Box start = box_of_span(posed.start, cluster), end = drift.take_from(box_of_span(posed.end, cluster), 1);
  Box out;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    out.low[axis] = (start.low[axis] < end.low[axis] ? start.low[axis] : end.low[axis]) - stray;
    out.high[axis] = (start.high[axis] > end.high[axis] ? start.high[axis] : end.high[axis]) + stray;
  }
  return out;
}

// The cluster's triangles whose boxes around the way, `stray` wider, touch the box, but for what single corners tell;
// seen along with the drift.
// False where there are none. Triangles that are degenerate at one end are left out: on the way to a point all would
// meet.
inline HWY_NOINLINE bool load_moving_block(const MovingSkin& posed, std::size_t cluster_index, const Box& box,
                                           const Drift& drift, float stray, MovingBlock& out) {
  constexpr Floats kFloats;
  const Surface& surface = *posed.start.surface;
  const Cluster& cluster = surface.clusters.data[cluster_index];
  const std::uint8_t* corners = surface.corners.data + 3 * std::size_t{cluster.first_triangle};
  HWY_ALIGN Codes codes, codes_at_end;
  find_sides(posed.start, cluster_index, BoxProbe(box), codes);
  find_sides(posed.end, cluster_index, BoxProbe(drift.take_from(box, -1)), codes_at_end);
  for (std::size_t i = 0; i < cluster.vertex_count; ++i) {
    codes[i] &= codes_at_end[i];  // beyond all the way
  }
  const Slots slots[2] = {slots_of(posed.start, cluster_index), slots_of(posed.end, cluster_index)};
  std::uint8_t last[3 * kBlock];
  if (3 * (cluster.first_triangle + kBlock) > surface.corners.size) {  // the asset's last few
    std::memset(last, 0, sizeof last);
    std::memcpy(last, corners, 3 * std::size_t{cluster.triangle_count});
    corners = last;
  }
  std::size_t count = 0;
  for (std::uint64_t bits = within(corners, cluster.triangle_count, cluster.vertex_count, codes); bits != 0;
       bits &= bits - 1, ++count) {
    const std::size_t i = lowest_bit(bits);
    out.triangles[count] = static_cast<std::uint32_t>(cluster.first_triangle + i);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint8_t slot = corners[3 * i + k];
      out.places[k][count] = slot;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        out.corners[0][k][axis][count] = slots[0].axes[axis][slot];
        out.corners[1][k][axis][count] = slots[1].axes[axis][slot] - drift.by[axis];
      }
    }
  }
  if (count == 0) {
    return false;
  }
  out.cluster = cluster_index;
  out.count = count;
  const Vector empty_low = hn::Set(kFloats, FLT_MAX), empty_high = hn::Set(kFloats, -FLT_MAX);
  const Vector wide = hn::Set(kFloats, stray);
  Vector least[3] = {empty_low, empty_low, empty_low}, most[3] = {empty_high, empty_high, empty_high};
  for (std::size_t i = 0; i < count; i += kLanes) {
    const auto used = hn::FirstN(kFloats, count - i);
    Vector low[3], high[3];
    auto is_empty = hn::Not(used);
    for (std::size_t pose = 0; pose < 2; ++pose) {
      Vector pose_low[3], pose_high[3];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const Vector a = hn::LoadU(kFloats, out.corners[pose][0][axis] + i);
        const Vector b = hn::LoadU(kFloats, out.corners[pose][1][axis] + i);
        const Vector c = hn::LoadU(kFloats, out.corners[pose][2][axis] + i);
        pose_low[axis] = hn::Min(hn::Min(a, b), c);
        pose_high[axis] = hn::Max(hn::Max(a, b), c);
        low[axis] = pose == 0 ? pose_low[axis] : hn::Min(pose_low[axis], low[axis]);
        high[axis] = pose == 0 ? pose_high[axis] : hn::Max(pose_high[axis], high[axis]);
      }
      is_empty = hn::Or(is_empty, without_shape(out.corners[pose], i, pose_low, pose_high));
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Vector first = hn::IfThenElse(is_empty, empty_low, hn::Sub(low[axis], wide));
      const Vector end = hn::IfThenElse(is_empty, empty_high, hn::Add(high[axis], wide));
      hn::StoreU(first, kFloats, out.low[axis] + i);
      hn::StoreU(end, kFloats, out.high[axis] + i);
      least[axis] = hn::Min(first, least[axis]);
      most[axis] = hn::Max(end, most[axis]);
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    out.box.low[axis] = hn::GetLane(hn::MinOfLanes(kFloats, least[axis]));
    out.box.high[axis] = hn::GetLane(hn::MaxOfLanes(kFloats, most[axis]));
  }
  return out.box.low[0] <= out.box.high[0];
}

// Some of a register of triangles of a block, in any order.
struct GatheredMovingTriangles {
  const MovingBlock* block;
  std::size_t first;  // of the register
  hn::Vec<hn::Rebind<std::int32_t, Floats> > which;

  HWY_INLINE GatheredMovingTriangles(const MovingBlock& from, std::size_t begin, const std::int32_t* places)
      : block(&from), first(begin), which(hn::LoadU(hn::Rebind<std::int32_t, Floats>(), places)) {}
  HWY_INLINE Vector of(const float* column) const {
    constexpr Floats kFloats;
    return hn::TableLookupLanes(hn::LoadU(kFloats, column + first), hn::IndicesFromVec(kFloats, which));
  }
  HWY_INLINE Vector3 corner(std::size_t pose, std::size_t k) const {
    return {of(block->corners[pose][k][0]), of(block->corners[pose][k][1]), of(block->corners[pose][k][2])};
  }
};

// Each lane's two triangles: does a plane stay between them that keeps its direction, the normal of one of the two half
// way, or the line between them? Roundings are less than 2^-20 of what `stray` counts in.
HWY_INLINE std::uint64_t stay_apart(const GatheredMovingTriangles& first, const GatheredMovingTriangles& second,
                                    float stray) {
  constexpr Floats kFloats;
  const Vector3 origin = first.corner(0, 0);
  const auto corner = [&](const GatheredMovingTriangles& of, std::size_t pose, std::size_t k)
                          HWY_ATTR { return subtract(of.corner(pose, k), origin); };
  const Vector3 a[2][3] = {{corner(first, 0, 0), corner(first, 0, 1), corner(first, 0, 2)},
                           {corner(first, 1, 0), corner(first, 1, 1), corner(first, 1, 2)}};
  const Vector3 b[2][3] = {{corner(second, 0, 0), corner(second, 0, 1), corner(second, 0, 2)},
                           {corner(second, 1, 0), corner(second, 1, 1), corner(second, 1, 2)}};
  const auto twice_middle = [](const Vector3(&corners)[2][3], std::size_t k) HWY_ATTR {
    const Vector3 &p = corners[0][k], &q = corners[1][k];
    return Vector3{hn::Add(p.x, q.x), hn::Add(p.y, q.y), hn::Add(p.z, q.z)};
  };
  const Vector3 mid_a[3] = {twice_middle(a, 0), twice_middle(a, 1), twice_middle(a, 2)};
  const Vector3 mid_b[3] = {twice_middle(b, 0), twice_middle(b, 1), twice_middle(b, 2)};
  const auto parts = [&](const Vector3& n) HWY_ATTR {
    const Vector least = hn::Mul(hn::Sqrt(dot_product(n, n)), hn::Set(kFloats, stray * (1 + 0x1p-18F)));
    auto above = hn::FirstN(kFloats, kLanes), below = above;
    for (std::size_t pose = 0; pose < 2; ++pose) {
      Vector low[2], high[2];
      for (std::size_t which = 0; which < 2; ++which) {
        const Vector3(&corners)[3] = which == 0 ? a[pose] : b[pose];
        const Vector p = dot_product(n, corners[0]), q = dot_product(n, corners[1]), r = dot_product(n, corners[2]);
        low[which] = hn::Min(hn::Min(p, q), r);
        high[which] = hn::Max(hn::Max(p, q), r);
      }
      above = hn::And(above, hn::Gt(hn::Sub(low[1], high[0]), least));
      below = hn::And(below, hn::Gt(hn::Sub(low[0], high[1]), least));
    }
    return hn::Or(above, below);
  };
  const auto of_a = parts(cross_product(subtract(mid_a[1], mid_a[0]), subtract(mid_a[2], mid_a[0])));
  const auto of_b = parts(cross_product(subtract(mid_b[1], mid_b[0]), subtract(mid_b[2], mid_b[0])));
  const auto sum = [&](const Vector3(&p)[3]) HWY_ATTR {
    return Vector3{hn::Add(hn::Add(p[0].x, p[1].x), p[2].x), hn::Add(hn::Add(p[0].y, p[1].y), p[2].y),
                   hn::Add(hn::Add(p[0].z, p[1].z), p[2].z)};
  };
  const auto between = parts(subtract(sum(mid_b), sum(mid_a)));
  return bits_of(hn::Or(hn::Or(of_a, of_b), between));
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#endif

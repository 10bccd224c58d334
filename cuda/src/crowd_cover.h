// SPDX-License-Identifier: MIT
// The crowd's kernel: from matrices to balls around the skin. The arithmetic is that of runtime/src/cover_kernel.cpp
// for leaves, and of runtime/src/cover.cpp for the bones' sizes and the spheres.
#pragma once

#include "crowd_refit.h"

namespace spherechain::cuda {

// What comes of a NaN is not what fmaxf and fminf make of it.
SPHERECHAIN_HD float larger(float a, float b) { return b > a ? b : a; }
SPHERECHAIN_HD float smaller(float a, float b) { return b < a ? b : a; }

// Step 2: a warp a bone.
SPHERECHAIN_HD void size_bones(const GroupView& v, const Shared& shared, const Place& at) {
  for (std::uint32_t bone = at.warp(); bone < v.used_bone_count; bone += at.warps()) {
    const Float4* m = shared.matrices + 3 * bone * kPitch + at.lane();
    const Float4 x = m[0], y = m[kPitch], z = m[2 * kPitch];
    const float columns[3][3] = {{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}};
    const auto product = [&](int i, int j) {
      const float(&p)[3] = columns[i], (&q)[3] = columns[j];
      return fabsf((p[0] * q[0] + p[1] * q[1]) + p[2] * q[2]);
    };
    float most = 0;
    for (int i = 0; i < 3; ++i) {
      most = larger(most, (product(i, 0) + product(i, 1)) + product(i, 2));
    }
    const float translation = larger(larger(fabsf(x.w), fabsf(y.w)), fabsf(z.w));
    shared.bone_sizes[bone * kPitch + at.lane()] = {sqrtf(most), translation};
  }
}

struct Matrix3 {
  float at[3][3];
};

SPHERECHAIN_HD float norm_of(const Matrix3& r) {
  const auto product = [&](int i, int j) {
    return fabsf(fused(r.at[2][i], r.at[2][j], fused(r.at[1][i], r.at[1][j], r.at[0][i] * r.at[0][j])));
  };
  const float xy = product(0, 1), xz = product(0, 2), yz = product(1, 2);
  const float first = (product(0, 0) + xy) + xz, second = (xy + product(1, 1)) + yz, third = (xz + yz) + product(2, 2);
  return sqrtf(larger(larger(first, second), third));
}

// A leaf's ball at rest as the morphs move it, and the X of the margin.
struct RestBall {
  float x, y, z, rho, extent;
};

SPHERECHAIN_HD void add_leaf_morphs(const GroupView& v, const Shared& shared, std::uint32_t lane, const LeafEntry& leaf,
                                    RestBall& rest) {
  for (std::uint32_t i = leaf.first_morph; i < leaf.first_morph + leaf.morph_count; ++i) {
    const LeafMorph& morph = v.leaf_morphs[i];
    const float weight = shared.morph_weights[morph.target * kPitch + lane], size = fabsf(weight);
    if (weight != 0) {
      const Float4 ball = morph.ball;
      rest.x = fused(weight, ball.x, rest.x);
      rest.y = fused(weight, ball.y, rest.y);
      rest.z = fused(weight, ball.z, rest.z);
      rest.rho = fused(size, ball.w, rest.rho);
      rest.extent = fused(size, (fabsf(ball.x) + fabsf(ball.y)) + (fabsf(ball.z) + ball.w), rest.extent);
    }
  }
}

SPHERECHAIN_HD float move_row(const Float4& row, const RestBall& rest) {
  return fused(row.z, rest.z, fused(row.y, rest.y, fused(row.x, rest.x, row.w)));
}

SPHERECHAIN_HD Float4 cover_leaf(const GroupView& v, const Shared& shared, std::uint32_t lane, const LeafEntry& leaf) {
  const Float4 ball = leaf.ball;
  RestBall rest{ball.x, ball.y, ball.z, ball.w, (fabsf(ball.x) + fabsf(ball.y)) + (fabsf(ball.z) + ball.w)};
  const std::uint32_t end = leaf.first_term + leaf.term_count;
  std::uint32_t count = leaf.term_count;
  if (v.morph_weights != nullptr) {
    add_leaf_morphs(v, shared, lane, leaf, rest);
    count += leaf.morph_count;
  }
  Matrix3 r{};
  float m[3] = {0, 0, 0};
  for (std::uint32_t t = leaf.first_term; t < end; ++t) {
    const LeafTerm term = v.leaf_terms[t];
    const Float4* matrix = shared.matrices + 3 * term.bone * kPitch + lane;
    SPHERECHAIN_UNROLL
    for (int i = 0; i < 3; ++i) {
      const Float4 row = matrix[i * kPitch];
      m[i] = fused(term.weight, move_row(row, rest), m[i]);
      r.at[i][0] = fused(term.weight, row.x, r.at[i][0]);
      r.at[i][1] = fused(term.weight, row.y, r.at[i][1]);
      r.at[i][2] = fused(term.weight, row.z, r.at[i][2]);
    }
  }
  float blend = rest.rho * norm_of(r), most = 0, largest = 0, deviations = 0;
  for (std::uint32_t t = leaf.first_term; t < end; ++t) {
    const LeafTerm term = v.leaf_terms[t];
    const Float4* matrix = shared.matrices + 3 * term.bone * kPitch + lane;
    const BoneSize size = shared.bone_sizes[term.bone * kPitch + lane];
    float square = 0, turn = 0;
    SPHERECHAIN_UNROLL
    for (int i = 0; i < 3; ++i) {
      const Float4 row = matrix[i * kPitch];
      const float away = move_row(row, rest) - m[i];
      const float x = row.x - r.at[i][0], y = row.y - r.at[i][1], z = row.z - r.at[i][2];
      square = fused(away, away, square);
      turn = fused(z, z, fused(y, y, fused(x, x, turn)));
    }
    const float distance = sqrtf(square);
    const bool moves = term.deviation + term.weight > 0;
    most = larger(most, moves ? fused(rest.rho, size.norm, distance) : 0.0F);
    largest = larger(largest, moves ? fused(size.norm, rest.extent, size.translation) : 0.0F);
    blend = fused(term.deviation, fused(sqrtf(turn), rest.rho, distance), blend);
    deviations = deviations + term.deviation;
  }
  constexpr float kUnit = 1.0F / 16777216.0F;
  const auto terms = static_cast<float>(count);
  const float factor = fused(kUnit * (64.0F + 16.0F * terms), deviations, kUnit * (64.0F + 8.0F * terms));
  constexpr float kLost = 0x1p-60F;
  const float lost = fused(kLost, rest.extent, kLost);
  return {m[0], m[1], m[2], fused(factor, largest, smaller(most, blend)) + fused(deviations, lost, lost)};
}

SPHERECHAIN_HD bool is_written(const GroupView& v, const Place& at) { return at.lane() < instances_in(v, at); }

// Around a sphere's leaves. The box around them comes first, so they are looked at twice: those that there is no room
// to keep are worked out again.
SPHERECHAIN_HD Float4 cover_sphere(const GroupView& v, const Shared& shared, const Place& at,
                                   const CoverEntry& sphere) {
  constexpr std::uint32_t kKept = 16;
  Float4 kept[kKept];
  Float4 low{0, 0, 0, 0}, high = low, cover = low;
  const std::size_t first = std::size_t{at.block * kLanes + at.lane()} * v.leaf_count + sphere.first_leaf;
  for (std::uint32_t i = 0; i < 2 * sphere.leaf_count; ++i) {
    const bool is_second = i >= sphere.leaf_count;
    const std::uint32_t l = is_second ? i - sphere.leaf_count : i;
    const Float4 leaf =
        is_second && l < kKept ? kept[l] : cover_leaf(v, shared, at.lane(), v.leaf_entries[sphere.first_leaf + l]);
    if (is_second) {
      if (l == 0) {
        cover = {0.5F * (low.x + high.x), 0.5F * (low.y + high.y), 0.5F * (low.z + high.z), 0};
      }
      const float dx = leaf.x - cover.x, dy = leaf.y - cover.y, dz = leaf.z - cover.z;
      cover.w = larger(cover.w, sqrtf((dx * dx + dy * dy) + dz * dz) + leaf.w);
      continue;
    }
    const Float4 below{leaf.x - leaf.w, leaf.y - leaf.w, leaf.z - leaf.w, 0};
    const Float4 above{leaf.x + leaf.w, leaf.y + leaf.w, leaf.z + leaf.w, 0};
    low = l == 0 ? below : Float4{smaller(low.x, below.x), smaller(low.y, below.y), smaller(low.z, below.z), 0};
    high = l == 0 ? above : Float4{larger(high.x, above.x), larger(high.y, above.y), larger(high.z, above.z), 0};
    if (l < kKept) {
      kept[l] = leaf;
    }
    if (v.leaves != nullptr && is_written(v, at)) {
      write_sphere(v.leaves + first + l, leaf, v.wide_leaves);
    }
  }
  cover.w = cover.w * (1.0F + 8.0F / 16777216.0F) + 0x1p-60F;
  return cover;
}

// Step 3: a warp a sphere, those of most leaves first. One without leaves is nowhere.
SPHERECHAIN_HD void cover_spheres(const GroupView& v, const Shared& shared, const Place& at) {
  std::uint32_t place = deal(&shared.dealt[0], at, 0);
  for (std::uint32_t round = 1; place < v.sphere_count; ++round) {
    const CoverEntry& sphere = v.cover_entries[place];
    place = deal(&shared.dealt[0], at, round);
    shared.spheres[sphere.sphere * kPitch + at.lane()] =
        sphere.leaf_count > 0 ? cover_sphere(v, shared, at, sphere) : Float4{NAN, NAN, NAN, 0};
  }
}

// Step 4, where they are asked for: a warp an instance.
SPHERECHAIN_HD void write_covers(const GroupView& v, const Shared& shared, const Place& at) {
  for (std::uint32_t from = at.warp(); from < instances_in(v, at); from += at.warps()) {
    Sphere* const to = v.refitted + std::size_t{at.block * kLanes + from} * v.sphere_count;
    for (std::uint32_t place = at.lane(); place < v.sphere_count; place += kLanes) {
      const CoverEntry& entry = v.cover_entries[place];
      const Float4 s = shared.spheres[entry.sphere * kPitch + from];
      const Float4 rest{entry.rest.x, entry.rest.y, entry.rest.z, 0};
      write_sphere(to + entry.sphere, entry.leaf_count > 0 ? s : rest, v.wide_refitted);
    }
  }
}

}  // namespace spherechain::cuda

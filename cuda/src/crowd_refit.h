// SPDX-License-Identifier: MIT
// The crowd's kernel: from matrices to spheres. The arithmetic is that of refit_bones.h.
#pragma once

#include "crowd_primitives.h"

namespace spherechain::cuda {

// Lanes past the last instance do as the last one does, and write nothing out.
SPHERECHAIN_HD std::uint32_t instance_of(const GroupView& v, const Place& at, std::uint32_t lane) {
  const std::uint32_t instance = at.block * kLanes + lane;
  return instance < v.instance_count ? instance : v.instance_count - 1;
}

SPHERECHAIN_HD std::uint32_t instances_in(const GroupView& v, const Place& at) {
  const std::uint32_t most = block_instances(v), left = v.instance_count - at.block * most;
  return left < most ? left : most;
}

SPHERECHAIN_HD void start_dealing(const Shared& shared, const Place& at) {
  if (at.thread < 3) {
    shared.dealt[at.thread] = 0;
  }
}

// Step 1: each warp takes some instances, so that their figures are read in the order they lie in.
SPHERECHAIN_HD void load_matrices(const GroupView& v, const Shared& shared, const Place& at) {
  if (v.wide_matrices) {
    const std::uint32_t last = instances_in(v, at) - 1;
    const float* const first = v.matrices + std::size_t{at.block} * kLanes * v.instance_stride;
    for (std::uint32_t i = at.lane(); i < 3 * v.used_bone_count; i += kLanes) {
      const float* const row = first + (v.used_bones[i / 3] * v.bone_stride + i % 3 * v.steps.row);
      Float4* const to = shared.matrices + i * kPitch;
      SPHERECHAIN_UNROLL
      for (std::uint32_t turn = 0; turn * at.warps() < kLanes; ++turn) {
        const std::uint32_t place = turn * at.warps() + at.warp();
        if (place < kLanes) {
          copy_past_cache(to + place, row + std::size_t{place < last ? place : last} * v.instance_stride);
        }
      }
    }
  } else {
    for (std::uint32_t i = at.lane(); i < 12 * v.used_bone_count; i += kLanes) {
      const std::uint32_t figure =
          v.used_bones[i / 12] * v.bone_stride + i / 4 % 3 * v.steps.row + i % 4 * v.steps.column;
      for (std::uint32_t to = at.warp(); to < kLanes; to += at.warps()) {
        const float* from = v.matrices + std::size_t{instance_of(v, at, to)} * v.instance_stride;
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

SPHERECHAIN_HD void write_sphere(Sphere* to, const Float4& s, bool is_wide) {
  if (is_wide) {
    *reinterpret_cast<Float4*>(to) = s;
  } else {
    *to = {s.x, s.y, s.z, s.w};
  }
}

// Step 3, where they are asked for: a warp an instance.
SPHERECHAIN_HD void write_spheres(const GroupView& v, const Shared& shared, const Place& at) {
  for (std::uint32_t from = at.warp(); from < instances_in(v, at); from += at.warps()) {
    Sphere* const to = v.refitted + std::size_t{at.block * kLanes + from} * v.sphere_count;
    for (std::uint32_t i = at.lane(); i < v.sphere_count; i += kLanes) {
      write_sphere(to + i, shared.spheres[i * kPitch + from], v.wide_refitted);
    }
  }
}

}  // namespace spherechain::cuda

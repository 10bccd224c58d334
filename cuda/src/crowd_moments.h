// SPDX-License-Identifier: MIT
// The crowd's kernel: from matrices to spheres by moments. The arithmetic is that of RefitBonesJob under
// RefitRule::kMoments.
#pragma once

#include "crowd_refit.h"

namespace spherechain::cuda {

SPHERECHAIN_HD float move_origin(const GroupView& v, const Float4& row) {
  return fused(row.z, v.origin.z, fused(row.y, v.origin.y, fused(row.x, v.origin.x, row.w)));
}

// Step 2: where the reference bone has the origin.
SPHERECHAIN_HD void find_reference(const GroupView& v, const Shared& shared, const Place& at) {
  if (at.warp() == 0) {
    for (std::uint32_t i = 0; i < 3; ++i) {
      shared.reference[i * kPitch + at.lane()] =
          move_origin(v, shared.matrices[(3 * v.reference + i) * kPitch + at.lane()]);
    }
  }
}

// NaN stays.
SPHERECHAIN_HD float without_least(float x) { return fabsf(x) < kLeastMatrixFigure ? 0.0F : x; }

// Step 3: translations become those of the origin's image, seen from the reference bone's. A warp a bone.
SPHERECHAIN_HD void center_matrices(const GroupView& v, const Shared& shared, const Place& at) {
  for (std::uint32_t bone = at.warp(); bone < v.used_bone_count; bone += at.warps()) {
    SPHERECHAIN_UNROLL
    for (std::uint32_t i = 0; i < 3; ++i) {
      Float4& row = shared.matrices[(3 * bone + i) * kPitch + at.lane()];
      const float w = move_origin(v, row) - shared.reference[i * kPitch + at.lane()];
      row = {without_least(row.x), without_least(row.y), without_least(row.z), without_least(w)};
    }
  }
}

struct Matrix {
  float at[3][4];
};

SPHERECHAIN_HD Matrix matrix_at(const Shared& shared, std::uint32_t lane, std::uint32_t place) {
  const auto* bytes = reinterpret_cast<const unsigned char*>(shared.matrices + lane);
  const auto* rows = reinterpret_cast<const Float4*>(bytes + (place & kMatrixMask));
  const Float4 x = rows[0], y = rows[kPitch], z = rows[2 * kPitch];
  return {{{x.x, x.y, x.z, x.w}, {y.x, y.y, y.z, y.w}, {z.x, z.y, z.z, z.w}}};
}

struct Gram {
  float at[4][4];
};

SPHERECHAIN_HD float gram_at(const Matrix& a, const Matrix& b, std::size_t row, std::size_t column) {
  return fused(a.at[2][row], b.at[2][column], fused(a.at[1][row], b.at[1][column], a.at[0][row] * b.at[0][column]));
}

SPHERECHAIN_HD Gram gram_of(const Matrix& a, const Matrix& b) {
  Gram out;
  SPHERECHAIN_UNROLL
  for (std::size_t column = 0; column < 4; ++column) {
    SPHERECHAIN_UNROLL
    for (std::size_t row = 0; row < 4; ++row) {
      out.at[row][column] = gram_at(a, b, row, column);
    }
  }
  return out;
}

// Of a bone with itself: symmetric, to the bit.
SPHERECHAIN_HD Gram gram_of(const Matrix& a) {
  Gram out;
  SPHERECHAIN_UNROLL
  for (std::size_t column = 0; column < 4; ++column) {
    SPHERECHAIN_UNROLL
    for (std::size_t row = 0; row <= column; ++row) {
      float figure = gram_at(a, a, row, column);
      make_once(figure);
      out.at[row][column] = out.at[column][row] = figure;
    }
  }
  return out;
}

struct MomentSums {
  float at[4][4];
};
struct CenterSums {
  float at[3][4];
};

// Of -0, which adds nothing, not even a sign.
template <std::size_t kRows>
SPHERECHAIN_HD void clear(float (&sums)[kRows][4]) {
  SPHERECHAIN_UNROLL
  for (float(&row)[4] : sums) {
    SPHERECHAIN_UNROLL
    for (float& sum : row) {
      sum = -0.0F;
    }
  }
}

// A bone's own.
SPHERECHAIN_HD void add_own_moment(const float (&m)[10], const Gram& gram, MomentSums& sums) {
  const float moment[4][4] = {
      {m[0], m[1], m[2], m[3]}, {m[1], m[4], m[5], m[6]}, {m[2], m[5], m[7], m[8]}, {m[3], m[6], m[8], m[9]}};
  SPHERECHAIN_UNROLL
  for (std::size_t row = 0; row < 4; ++row) {
    SPHERECHAIN_UNROLL
    for (std::size_t column = 0; column < 4; ++column) {
      sums.at[row][column] = fused(moment[row][column], gram.at[row][column], sums.at[row][column]);
    }
  }
}

SPHERECHAIN_HD void add_own_moment(const Float4* quads, const Gram& gram, MomentSums& sums) {
  const Float4 a = quads[0], b = quads[1], c = quads[2];
  add_own_moment({a.x, a.y, a.z, a.w, b.x, b.y, b.z, b.w, c.x, c.y}, gram, sums);
}

// Of two bones, by columns.
SPHERECHAIN_HD void add_pair_moment(const Float4* columns, const Gram& gram, MomentSums& sums) {
  SPHERECHAIN_UNROLL
  for (std::size_t column = 0; column < 4; ++column) {
    const Float4 m = columns[column];
    sums.at[0][column] = fused(m.x, gram.at[0][column], sums.at[0][column]);
    sums.at[1][column] = fused(m.y, gram.at[1][column], sums.at[1][column]);
    sums.at[2][column] = fused(m.z, gram.at[2][column], sums.at[2][column]);
    sums.at[3][column] = fused(m.w, gram.at[3][column], sums.at[3][column]);
  }
}

SPHERECHAIN_HD float tree(const MomentSums& sums) {
  float halves[2][4];
  SPHERECHAIN_UNROLL
  for (std::size_t column = 0; column < 4; ++column) {
    halves[0][column] = sums.at[0][column] + sums.at[2][column];
    halves[1][column] = sums.at[1][column] + sums.at[3][column];
  }
  const auto quarter = [&](std::size_t column) { return halves[0][column] + halves[1][column]; };
  return (quarter(0) + quarter(2)) + (quarter(1) + quarter(3));
}

// In units of that at rest: about 1 but where bones are scaled.
SPHERECHAIN_HD float spread_of(float square) {
  return square >= kLeastRoot && square <= kMostRoot ? usual_root(square) : any_root(square < 0 ? 0.0F : square);
}

SPHERECHAIN_HD void add_center(const Matrix& matrix, const Float4& term, CenterSums& sums) {
  const float terms[] = {term.x, term.y, term.z, term.w};
  SPHERECHAIN_UNROLL
  for (std::size_t row = 0; row < 3; ++row) {
    SPHERECHAIN_UNROLL
    for (std::size_t column = 0; column < 4; ++column) {
      sums.at[row][column] = fused(matrix.at[row][column], terms[column], sums.at[row][column]);
    }
  }
}

SPHERECHAIN_HD float center_of(const Shared& shared, std::uint32_t lane, const CenterSums& sums, std::size_t row) {
  const float(&own)[4] = sums.at[row];
  return ((own[0] + own[2]) + (own[1] + own[3])) + shared.reference[row * kPitch + lane];
}

SPHERECHAIN_HD void store_sphere(const Shared& shared, std::uint32_t lane, std::uint32_t sphere, const CenterSums& sums,
                                 float radius) {
  shared.spheres[sphere * kPitch + lane] = {center_of(shared, lane, sums, 0), center_of(shared, lane, sums, 1),
                                            center_of(shared, lane, sums, 2), radius};
}

// All Gram matrices stay in registers, and sphere after sphere takes what it needs of them.
SPHERECHAIN_HD void refit_two_bones(const GroupView& v, const Shared& shared, std::uint32_t lane,
                                    const MomentRun& run) {
  const RunSphere* spheres = v.run_spheres + run.first_sphere;
  const Matrix a = matrix_at(shared, lane, v.run_bones[run.first_bone]);
  const Matrix b = matrix_at(shared, lane, v.run_bones[run.first_bone + 1]);
  const Float4* terms = v.center_terms + run.first_center;
  SPHERECHAIN_ONE_BY_ONE
  for (std::uint32_t s = 0; s < run.sphere_count; ++s, terms += 2) {
    CenterSums sums;
    clear(sums.at);
    add_center(a, terms[0], sums);
    add_center(b, terms[1], sums);
    store_sphere(shared, lane, spheres[s].sphere, sums, 0);
  }
  const Gram own_a = gram_of(a), own_b = gram_of(b), both = gram_of(a, b);
  const Float4* quads = v.moments + run.first_moment;
  SPHERECHAIN_ONE_BY_ONE
  for (std::uint32_t s = 0; s < run.sphere_count; ++s, quads += kTwoBoneQuads) {
    MomentSums sums;
    clear(sums.at);
    const Float4 m = quads[0], n = quads[1], o = quads[2], p = quads[3], q = quads[4];
    add_own_moment({m.x, m.y, m.z, m.w, n.x, n.y, n.z, n.w, o.x, o.y}, own_a, sums);
    add_pair_moment(quads + 5, both, sums);
    add_own_moment({o.z, o.w, p.x, p.y, p.z, p.w, q.x, q.y, q.z, q.w}, own_b, sums);
    const RunSphere sphere = spheres[s];
    shared.spheres[sphere.sphere * kPitch + lane].w = sphere.wanted * spread_of(tree(sums));
  }
}

// A bone's matrix stays in registers while it is paired with those after it.
template <bool kEqual>
SPHERECHAIN_HD void add_pairs(const GroupView& v, const Shared& shared, std::uint32_t lane, const MomentRun& run,
                              MomentSums (&sums)[kRunSpheres]) {
  const std::uint32_t* steps = v.moment_steps + run.first_step;
  const Float4* quads = v.moments + run.first_moment;
  std::uint32_t step = 0;
  do {
    step = *steps++;
    const Matrix a = matrix_at(shared, lane, step);
    const Gram own = gram_of(a);
    SPHERECHAIN_UNROLL
    for (std::uint32_t s = 0; s < kRunSpheres; ++s) {
      if (kEqual || (step >> s & 1U) != 0) {
        add_own_moment(quads, own, sums[s]);
        quads += kOwnQuads;
      }
    }
    while ((step & kLastOfBone) == 0) {
      step = *steps++;
      const Gram both = gram_of(a, matrix_at(shared, lane, step));
      SPHERECHAIN_UNROLL
      for (std::uint32_t s = 0; s < kRunSpheres; ++s) {
        if (kEqual || (step >> s & 1U) != 0) {
          add_pair_moment(quads, both, sums[s]);
          quads += kPairQuads;
        }
      }
    }
  } while ((step & kLastOfRun) == 0);
}

template <bool kEqual>
SPHERECHAIN_HD void add_bones(const GroupView& v, const Shared& shared, std::uint32_t lane, const MomentRun& run,
                              CenterSums (&sums)[kRunSpheres]) {
  const std::uint32_t* bones = v.run_bones + run.first_bone;
  const Float4* terms = v.center_terms + run.first_center;
  SPHERECHAIN_ONE_BY_ONE
  for (std::uint32_t i = 0; i < run.bone_count; ++i) {
    const std::uint32_t bone = bones[i];
    const Matrix matrix = matrix_at(shared, lane, bone);
    SPHERECHAIN_UNROLL
    for (std::uint32_t s = 0; s < kRunSpheres; ++s) {
      if (kEqual || (bone >> s & 1U) != 0) {
        add_center(matrix, *terms++, sums[s]);
      }
    }
  }
}

template <bool kEqual>
SPHERECHAIN_HD void refit_run(const GroupView& v, const Shared& shared, std::uint32_t lane, const MomentRun& run) {
  float spreads[kRunSpheres];
  {
    MomentSums sums[kRunSpheres];
    clear(sums[0].at);
    clear(sums[1].at);
    add_pairs<kEqual>(v, shared, lane, run, sums);
    spreads[0] = spread_of(tree(sums[0]));
    spreads[1] = spread_of(tree(sums[1]));
  }
  CenterSums centers[kRunSpheres];
  clear(centers[0].at);
  clear(centers[1].at);
  add_bones<kEqual>(v, shared, lane, run, centers);
  const RunSphere* spheres = v.run_spheres + run.first_sphere;
  SPHERECHAIN_UNROLL
  for (std::uint32_t s = 0; s < kRunSpheres; ++s) {
    if (kEqual || s < run.sphere_count) {
      store_sphere(shared, lane, spheres[s].sphere, centers[s], spheres[s].wanted * spreads[s]);
    }
  }
}

// Step 4: a warp a run of spheres, the dearest first.
SPHERECHAIN_HD void refit_runs(const GroupView& v, const Shared& shared, const Place& at) {
  std::uint32_t place = deal(&shared.dealt[0], at, 0);
  for (std::uint32_t round = 1; place < v.run_count; ++round) {
    const MomentRun& run = v.runs[place];
    place = deal(&shared.dealt[0], at, round);
    if (run.kind == kTwoBones) {
      refit_two_bones(v, shared, at.lane(), run);
    } else if (run.kind == kEqualBones) {
      refit_run<true>(v, shared, at.lane(), run);
    } else {
      refit_run<false>(v, shared, at.lane(), run);
    }
  }
}

}  // namespace spherechain::cuda

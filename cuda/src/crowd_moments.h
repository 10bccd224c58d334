// SPDX-License-Identifier: MIT
// The crowd's kernel: from matrices to spheres by moments. The arithmetic is that of RefitBonesJob under
// RefitRule::kMoments.
#pragma once

#include "crowd_refit.h"

namespace spherechain::cuda {

SPHERECHAIN_HD float move_origin(const GroupView& v, const Float4& row) {
  return fused(row.z, v.origin.z, fused(row.y, v.origin.y, fused(row.x, v.origin.x, row.w)));
}

// Step 2: a warp a bone. Translations become those of the origin's image, seen from the reference bone's; of that bone
// there is a matrix more, the last, which stays as it is.
SPHERECHAIN_HD void center_matrices(const GroupView& v, const Shared& shared, const Place& at) {
  const std::uint32_t last = v.used_bone_count - 1;
  float reference[3];
  SPHERECHAIN_UNROLL
  for (std::uint32_t i = 0; i < 3; ++i) {
    reference[i] = move_origin(v, shared.matrices[(3 * last + i) * kPitch + at.lane()]);
    if (at.warp() == 0) {
      shared.reference[i * kPitch + at.lane()] = reference[i];
    }
  }
  for (std::uint32_t bone = at.warp(); bone < last; bone += at.warps()) {
    SPHERECHAIN_UNROLL
    for (std::uint32_t i = 0; i < 3; ++i) {
      Float4& row = shared.matrices[(3 * bone + i) * kPitch + at.lane()];
      row.w = move_origin(v, row) - reference[i];
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
      out.at[row][column] = out.at[column][row] = gram_at(a, a, row, column);
    }
  }
  return out;
}

// Of -0 to begin with, which adds nothing to what is added first, not even a sign.
struct MomentSums {
  float at[4][4];
};

// `columns`: of a moment.
SPHERECHAIN_HD void add_moment(const Float4* columns, const Gram& gram, MomentSums& sums) {
  SPHERECHAIN_UNROLL
  for (std::size_t column = 0; column < 4; ++column) {
    const Float4 m = columns[column];
    sums.at[0][column] = fused(m.x, gram.at[0][column], sums.at[0][column]);
    sums.at[1][column] = fused(m.y, gram.at[1][column], sums.at[1][column]);
    sums.at[2][column] = fused(m.z, gram.at[2][column], sums.at[2][column]);
    sums.at[3][column] = fused(m.w, gram.at[3][column], sums.at[3][column]);
  }
}

// Returns where the next pair's moments are.
template <bool kEqual>
SPHERECHAIN_HD const Float4* add_moments(const Float4* moments, std::uint32_t step, const Gram& gram,
                                         MomentSums (&sums)[kRunSpheres]) {
  SPHERECHAIN_UNROLL
  for (std::uint32_t s = 0; s < kRunSpheres; ++s) {
    if (kEqual || (step >> s & 1U) != 0) {
      add_moment(moments, gram, sums[s]);
      moments += 4;
    }
  }
  return moments;
}

// A bone's matrix stays in registers while it is paired with those after it.
template <bool kEqual>
SPHERECHAIN_HD void add_pairs(const GroupView& v, const Shared& shared, std::uint32_t lane, const MomentRun& run,
                              MomentSums (&sums)[kRunSpheres]) {
  const std::uint32_t* steps = v.moment_steps + run.first_step;
  const Float4* moments = v.moments + run.first_moment;
  std::uint32_t step = *steps;
  for (std::uint32_t bone = 0; bone < run.bone_count; ++bone) {
    const Matrix a = matrix_at(shared, lane, step);
    std::uint32_t next = *++steps;
    moments = add_moments<kEqual>(moments, step, gram_of(a), sums);
    while ((step & kLastStep) == 0) {
      step = next;
      next = *++steps;
      moments = add_moments<kEqual>(moments, step, gram_of(a, matrix_at(shared, lane, step)), sums);
    }
    step = next;
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

struct CenterSums {
  float at[3][4];
};

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

template <bool kEqual>
SPHERECHAIN_HD void add_centers(const GroupView& v, const Shared& shared, std::uint32_t lane, const MomentRun& run,
                                CenterSums (&sums)[kRunSpheres]) {
  const std::uint32_t* bones = v.run_bones + run.first_bone;
  const Float4* terms = v.center_terms + run.first_center;
  for (std::uint32_t bone = 0; bone < run.bone_count; ++bone) {
    const Matrix matrix = matrix_at(shared, lane, bones[bone]);
    SPHERECHAIN_UNROLL
    for (std::uint32_t s = 0; s < kRunSpheres; ++s) {
      if (kEqual || (bones[bone] >> s & 1U) != 0) {
        add_center(matrix, *terms++, sums[s]);
      }
    }
  }
}

template <bool kEqual>
SPHERECHAIN_HD void refit_run(const GroupView& v, const Shared& shared, std::uint32_t lane, const MomentRun& run) {
  float radii[kRunSpheres];
  {
    MomentSums sums[kRunSpheres];
    for (MomentSums& own : sums) {
      for (float(&row)[4] : own.at) {
        for (float& sum : row) {
          sum = -0.0F;
        }
      }
    }
    add_pairs<kEqual>(v, shared, lane, run, sums);
    for (std::uint32_t s = 0; s < kRunSpheres; ++s) {
      radii[s] = run.wanted[s] * spread_of(tree(sums[s]));
    }
  }
  CenterSums centers[kRunSpheres];
  for (CenterSums& own : centers) {
    for (float(&row)[4] : own.at) {
      for (float& sum : row) {
        sum = -0.0F;
      }
    }
  }
  add_centers<kEqual>(v, shared, lane, run, centers);
  for (std::uint32_t s = 0; s < kRunSpheres; ++s) {
    if (kEqual || s < run.sphere_count) {
      float center[3];
      for (std::uint32_t row = 0; row < 3; ++row) {
        const float(&sums)[4] = centers[s].at[row];
        center[row] = ((sums[0] + sums[2]) + (sums[1] + sums[3])) + shared.reference[row * kPitch + lane];
      }
      shared.spheres[run.spheres[s] * kPitch + lane] = {center[0], center[1], center[2], radii[s]};
    }
  }
}

// Step 3: a warp a run of spheres, the dearest first.
SPHERECHAIN_HD void refit_runs(const GroupView& v, const Shared& shared, const Place& at) {
  std::uint32_t place = deal(&shared.dealt[0], at, 0);
  for (std::uint32_t round = 1; place < v.run_count; ++round) {
    const MomentRun& run = v.runs[place];
    place = deal(&shared.dealt[0], at, round);
    if (run.are_equal != 0) {
      refit_run<true>(v, shared, at.lane(), run);
    } else {
      refit_run<false>(v, shared, at.lane(), run);
    }
  }
}

}  // namespace spherechain::cuda

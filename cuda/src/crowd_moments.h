// SPDX-License-Identifier: MIT
// The kernel for bones: from centred matrices to spheres, by moments. The arithmetic is sc_refit()'s.
#pragma once

#include "crowd_bones.h"

namespace spherechain::cuda {

struct Gram {
  float at[4][4];
};

SPHERECHAIN_HD float gram_at(const Matrix& a, const Matrix& b, std::size_t row, std::size_t column) {
  return fused(a.at[2][row], b.at[2][column], fused(a.at[1][row], b.at[1][column], a.at[0][row] * b.at[0][column]));
}

// Calls visit(row, column) for some columns of a moment; of a bone's own without the rows below the diagonal.
template <std::size_t kFirst, std::size_t kStep, typename Visit>
SPHERECHAIN_HD void for_each_figure(bool is_self, const Visit& visit) {
  SPHERECHAIN_UNROLL
  for (std::size_t column = kFirst; column < 4; column += kStep) {
    SPHERECHAIN_UNROLL
    for (std::size_t row = 0; row < rows_of_moment(is_self, column); ++row) {
      visit(row, column);
    }
  }
}

// For a bone with itself, the figures below the diagonal are left out. Their moments are 0, so no radius changes: the
// sign of a sum of zeros does not matter, and where a figure below the diagonal is not finite, its twin above is not
// either.
SPHERECHAIN_HD Gram gram_of(const Matrix& a, const Matrix& b, bool is_self) {
  Gram out;
  for_each_figure<0, 1>(is_self, [&](std::size_t row, std::size_t column) {
    out.at[row][column] = gram_at(a, b, row, column);
    if (is_self) {
      make_once(out.at[row][column]);
    }
  });
  return out;
}

// From -0, which as a summand changes nothing, not even a sign.
template <std::size_t kRows>
struct Sums {
  float at[kRows][4];

  SPHERECHAIN_HD Sums() {
    SPHERECHAIN_UNROLL
    for (float(&row)[4] : at) {
      SPHERECHAIN_UNROLL
      for (float& sum : row) {
        sum = -0.0F;
      }
    }
  }
};
using MomentSums = Sums<4>;
using CenterSums = Sums<3>;

SPHERECHAIN_HD float sum_column(const MomentSums& sums, std::size_t column) {
  return (sums.at[0][column] + sums.at[2][column]) + (sums.at[1][column] + sums.at[3][column]);
}

SPHERECHAIN_HD float tree(const MomentSums& sums) {
  return (sum_column(sums, 0) + sum_column(sums, 2)) + (sum_column(sums, 1) + sum_column(sums, 3));
}

SPHERECHAIN_HD_RARE float odd_spread(float square) {
  return !(fabsf(square) <= FLT_MAX) ? NAN : sqrtf(square <= 0 ? 0.0F : square);
}

// The spread relative to rest: about 1 unless bones are scaled.
SPHERECHAIN_HD float spread_of(float square) {
  return square >= kRootMin && square <= kRootMax ? usual_root(square) : odd_spread(square);
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

SPHERECHAIN_HD void store_sphere(const Shared& shared, std::uint32_t lane, std::uint32_t sphere, const CenterSums& sums,
                                 float radius) {
  const auto center = [&](std::size_t row) {
    const float(&s)[4] = sums.at[row];
    return ((s[0] + s[2]) + (s[1] + s[3])) + shared.reference[row * kPitch + lane];
  };
  shared.spheres[sphere * kPitch + lane] = {center(0), center(1), center(2), radius};
}

// Reads figures one after another, by fours.
class Figures {
 public:
  SPHERECHAIN_HD explicit Figures(const Float4* quads) : quads_(quads) {}

  SPHERECHAIN_HD float next() {
    const std::size_t i = read_++ % 4;
    if (i == 0) {
      quad_ = *quads_++;
    }
    return i == 0 ? quad_.x : i == 1 ? quad_.y : i == 2 ? quad_.z : quad_.w;
  }

 private:
  const Float4* quads_;
  Float4 quad_ = {};
  std::size_t read_ = 0;
};

SPHERECHAIN_HD void add_moment(const Float4* quads, const Gram& gram, bool is_self, MomentSums& sums) {
  Figures moment(quads);
  for_each_figure<0, 1>(is_self, [&](std::size_t row, std::size_t column) {
    sums.at[row][column] = fused(moment.next(), gram.at[row][column], sums.at[row][column]);
  });
}

// Calls visit(pair, its two bones, row, column) for the figures that few_bone_quads() counts, in their order.
template <std::size_t kBones, std::size_t kFirst, std::size_t kStep, typename Visit>
SPHERECHAIN_HD void for_each_few_figure(const Visit& visit) {
  std::size_t pair = 0;
  SPHERECHAIN_UNROLL
  for (std::size_t k = 0; k < kBones; ++k) {
    SPHERECHAIN_UNROLL
    for (std::size_t l = k; l < kBones; ++l, ++pair) {
      for_each_figure<kFirst, kStep>(k == l,
                                     [&](std::size_t row, std::size_t column) { visit(pair, k, l, row, column); });
    }
  }
}

template <std::size_t kBones>
SPHERECHAIN_HD void load_matrices_of(const Shared& shared, std::uint32_t lane, const std::uint32_t* bones,
                                     Matrix (&matrices)[kBones]) {
  SPHERECHAIN_UNROLL
  for (std::size_t k = 0; k < kBones; ++k) {
    matrices[k] = matrix_at(shared, lane, bones[k]);
  }
}

// Holds some columns of the Gram matrices of few bones in registers and goes through the spheres. Calls take(sphere,
// the sums that these columns add to its mean square).
template <std::size_t kBones, std::size_t kFirst, std::size_t kStep, typename Take>
SPHERECHAIN_HD void add_columns(const Shared& shared, std::uint32_t lane, const std::uint32_t* bones,
                                const Float4* quads, std::uint32_t sphere_count, const Take& take) {
  Gram grams[pairs_of_bones(kBones)];
  {
    Matrix matrices[kBones];
    load_matrices_of(shared, lane, bones, matrices);
    for_each_few_figure<kBones, kFirst, kStep>(
        [&](std::size_t pair, std::size_t k, std::size_t l, std::size_t row, std::size_t column) {
          float& figure = grams[pair].at[row][column] = gram_at(matrices[k], matrices[l], row, column);
          make_once(figure);
        });
  }
  SPHERECHAIN_ONE_BY_ONE
  for (std::uint32_t s = 0; s < sphere_count; ++s, quads += few_bone_quads(kBones, kFirst, kStep)) {
    MomentSums sums;
    Figures moment(quads);
    for_each_few_figure<kBones, kFirst, kStep>(
        [&](std::size_t pair, std::size_t, std::size_t, std::size_t row, std::size_t column) {
          float& sum = sums.at[row][column];
          sum = fused(moment.next(), grams[pair].at[row][column], sum);
        });
    take(s, sums);
  }
}

template <std::size_t kBones>
SPHERECHAIN_HD void add_few_centers(const Shared& shared, std::uint32_t lane, const std::uint32_t* bones,
                                    const Float4* terms, const RunSphere* spheres, std::uint32_t sphere_count) {
  Matrix matrices[kBones];
  load_matrices_of(shared, lane, bones, matrices);
  SPHERECHAIN_ONE_BY_ONE
  for (std::uint32_t s = 0; s < sphere_count; ++s, terms += kBones) {
    CenterSums sums;
    SPHERECHAIN_UNROLL
    for (std::size_t k = 0; k < kBones; ++k) {
      add_center(matrices[k], terms[k], sums);
    }
    store_sphere(shared, lane, spheres[s].sphere, sums, 0);
  }
}

// Spheres of the same two bones, or of the same three. The Gram matrices of three bones fill the registers with half of
// their columns at a time.
template <std::size_t kBones>
SPHERECHAIN_HD void refit_few_bones(const GroupView& v, const Shared& shared, std::uint32_t lane,
                                    const MomentRun& run) {
  const RunSphere* spheres = v.run_spheres + run.first_sphere;
  const std::uint32_t count = run.sphere_count;
  const auto radius_at = [&](std::uint32_t s) -> float& { return shared.spheres[spheres[s].sphere * kPitch + lane].w; };
  const std::uint32_t* bones = v.run_bones + run.first_bone;
  add_few_centers<kBones>(shared, lane, bones, v.center_terms + run.first_center, spheres, count);
  const Float4* quads = v.moments + run.first_moment;
  if (kBones == 2) {
    add_columns<kBones, 0, 1>(shared, lane, bones, quads, count, [&](std::uint32_t s, const MomentSums& sums) {
      radius_at(s) = spheres[s].wanted * spread_of(tree(sums));
    });
  } else {
    add_columns<kBones, 0, 2>(shared, lane, bones, quads, count, [&](std::uint32_t s, const MomentSums& sums) {
      radius_at(s) = sum_column(sums, 0) + sum_column(sums, 2);
    });
    quads += count * few_bone_quads(kBones, 0, 2);
    add_columns<kBones, 1, 2>(shared, lane, bones, quads, count, [&](std::uint32_t s, const MomentSums& sums) {
      float& radius = radius_at(s);
      radius = spheres[s].wanted * spread_of(radius + (sum_column(sums, 1) + sum_column(sums, 3)));
    });
  }
}

// A bone's matrix stays in registers while it is paired with those after it.
SPHERECHAIN_HD void add_pairs(const GroupView& v, const Shared& shared, std::uint32_t lane, const MomentRun& run,
                              MomentSums (&sums)[kRunSpheres]) {
  const std::uint32_t* steps = v.moment_steps + run.first_step;
  const Float4* quads = v.moments + run.first_moment;
  std::uint32_t step = 0;
  const auto add = [&](const Gram& gram, bool is_self) {
    SPHERECHAIN_UNROLL
    for (std::uint32_t s = 0; s < kRunSpheres; ++s) {
      if ((step >> s & 1U) != 0) {
        add_moment(quads, gram, is_self, sums[s]);
        quads += is_self ? few_bone_quads(1, 0, 1) : kPairQuads;
      }
    }
  };
  do {
    step = *steps++;
    const Matrix a = matrix_at(shared, lane, step);
    add(gram_of(a, a, true), true);
    while ((step & kLastOfBone) == 0) {
      step = *steps++;
      add(gram_of(a, matrix_at(shared, lane, step), false), false);
    }
  } while ((step & kLastOfRun) == 0);
}

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
      if ((bone >> s & 1U) != 0) {
        add_center(matrix, *terms++, sums[s]);
      }
    }
  }
}

SPHERECHAIN_HD void refit_run(const GroupView& v, const Shared& shared, std::uint32_t lane, const MomentRun& run) {
  float spreads[kRunSpheres];
  {
    MomentSums sums[kRunSpheres];
    add_pairs(v, shared, lane, run, sums);
    spreads[0] = spread_of(tree(sums[0]));
    spreads[1] = spread_of(tree(sums[1]));
  }
  CenterSums centers[kRunSpheres];
  add_bones(v, shared, lane, run, centers);
  const RunSphere* spheres = v.run_spheres + run.first_sphere;
  SPHERECHAIN_UNROLL
  for (std::uint32_t s = 0; s < kRunSpheres; ++s) {
    if (s < run.sphere_count) {
      store_sphere(shared, lane, spheres[s].sphere, centers[s], spheres[s].wanted * spreads[s]);
    }
  }
}

// Step 4, a warp a run.
SPHERECHAIN_HD void refit_runs(const GroupView& v, const Shared& shared, const Place& at) {
  std::uint32_t place = deal(&shared.dealt[0], at, 0);
  for (std::uint32_t round = 1; place < v.run_count; ++round) {
    const MomentRun& run = v.runs[place];
    place = deal(&shared.dealt[0], at, round);
    if (run.kind == kTwoBones) {
      refit_few_bones<2>(v, shared, at.lane(), run);
    } else if (run.kind == kThreeBones) {
      refit_few_bones<3>(v, shared, at.lane(), run);
    } else {
      refit_run(v, shared, at.lane(), run);
    }
  }
}

// Step 5, where refitted spheres are asked for: a warp an instance.
SPHERECHAIN_HD void write_spheres(const GroupView& v, const Shared& shared, const Place& at) {
  for (std::uint32_t from = at.warp(); from < instances_in(v, at); from += at.warps()) {
    Sphere* const to = v.refitted + std::size_t{at.block * kLanes + from} * v.sphere_count;
    for (std::uint32_t i = at.lane(); i < v.sphere_count; i += kLanes) {
      *reinterpret_cast<Float4*>(to + i) = shared.spheres[i * kPitch + from];
    }
  }
}

}  // namespace spherechain::cuda

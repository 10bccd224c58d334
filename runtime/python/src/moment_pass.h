// SPDX-License-Identifier: MIT
// Refit from bones as a function that can be differentiated: the formulas of docs/arithmetic.md, in float or double.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "runtime/src/asset/asset_view.h"

namespace spherechain::python {

// Serves one thread. The asset must have moments.
template <typename T>
class MomentPass {
 public:
  MomentPass(const AssetView& asset, Radius radius)
      : asset_(asset),
        tables_(asset.moment_tables()),
        radius_(radius),
        relative_(kFigures * asset.bone_count()),
        relative_gradient_(relative_.size()) {}

  void set_pose(const T* bones, std::size_t bone_stride) {
    const T* const reference = bones + tables_.reference * bone_stride;
    for (std::size_t m = 0; m < 3; ++m) {
      reference_[m] = moved_origin(reference + 4 * m);
    }
    for (std::size_t b = 0; b < asset_.bone_count(); ++b) {
      for (std::size_t m = 0; m < 3; ++m) {
        const T* const row = bones + b * bone_stride + 4 * m;
        T* const out = &relative_[kFigures * b + 4 * m];
        std::copy(row, row + 3, out);
        out[3] = moved_origin(row) - reference_[m];
      }
    }
  }

  // x, y, z, radius of each sphere.
  void spheres(T* out) const {
    for_spheres([&](const Terms& at) {
      T* const sphere = out + 4 * std::size_t{at.sphere};
      for (std::size_t m = 0; m < 3; ++m) {
        T sum = reference_[m];
        for (std::size_t k = 0; k < at.bone_count; ++k) {
          const T* const row = &relative_[kFigures * at.bones[k] + 4 * m];
          const CenterTerm& u = at.centers[k];
          sum += row[0] * T{u.x} + row[1] * T{u.y} + row[2] * T{u.z} + row[3] * T{u.w};
        }
        sphere[m] = sum;
      }
      sphere[3] = at.wanted * std::sqrt(std::max(T{0}, square_and_gradient(at, nullptr)));
    });
  }

  // From the gradient of a function of the spheres, four numbers a sphere, to its gradient by the matrices, added to
  // `out`: 12 numbers a bone, side by side.
  void pull_back(const T* spheres, T* out) {
    std::fill(relative_gradient_.begin(), relative_gradient_.end(), T{0});
    T reference_gradient[3] = {};
    T own[kMaxMomentBones * kFigures];
    for_spheres([&](const Terms& at) {
      const T* const given = spheres + 4 * std::size_t{at.sphere};
      if (given[0] == 0 && given[1] == 0 && given[2] == 0 && given[3] == 0) {
        return;
      }
      const T square = given[3] == 0 ? T{0} : square_and_gradient(at, own);
      // The radius is wanted * sqrt(square); where it is 0 it has no slope, and none is taken.
      const T slope = square > 0 ? given[3] * at.wanted / (2 * std::sqrt(square)) : T{0};
      for (std::size_t k = 0; k < at.bone_count; ++k) {
        T* const to = &relative_gradient_[kFigures * at.bones[k]];
        const T u[4] = {T{at.centers[k].x}, T{at.centers[k].y}, T{at.centers[k].z}, T{at.centers[k].w}};
        for (std::size_t i = 0; i < kFigures; ++i) {
          to[i] += given[i / 4] * u[i % 4];
        }
        for (std::size_t i = 0; slope != 0 && i < kFigures; ++i) {
          to[i] += slope * own[kFigures * k + i];
        }
      }
      for (std::size_t m = 0; m < 3; ++m) {
        reference_gradient[m] += given[m];
      }
    });
    for (std::size_t b = 0; b < asset_.bone_count(); ++b) {
      for (std::size_t m = 0; m < 3; ++m) {
        const T* const from = &relative_gradient_[kFigures * b + 4 * m];
        T* const to = out + kFigures * b + 4 * m;
        for (std::size_t i = 0; i < 3; ++i) {
          to[i] += from[i];
        }
        add_moved_origin(from[3], to);
        reference_gradient[m] -= from[3];
      }
    }
    for (std::size_t m = 0; m < 3; ++m) {
      add_moved_origin(reference_gradient[m], out + kFigures * tables_.reference + 4 * m);
    }
  }

 private:
  static constexpr std::size_t kFigures = 12;

  // The terms of one sphere.
  struct Terms {
    std::uint32_t sphere;
    std::size_t bone_count;
    const std::uint16_t* bones;
    const CenterTerm* centers;
    const Moment* moments;
    T wanted;  // the radius at rest
  };

  template <typename Use>
  void for_spheres(const Use& use) const {
    Terms at{0, 0, tables_.bones.data, tables_.centers.data, tables_.moments.data, T{0}};
    for (std::size_t i = 0; i < tables_.spheres.size; ++i) {
      at.sphere = tables_.spheres[i];
      at.bone_count = tables_.bone_counts[i];
      const RestSphere& rest = asset_.spheres()[at.sphere];
      at.wanted = T{radius_ == SC_RADIUS_FIT ? rest.radius : rest.detect_radius};
      use(at);
      at.bones += at.bone_count;
      at.centers += at.bone_count;
      at.moments += at.bone_count * (at.bone_count + 1) / 2;
    }
  }

  // The sum over pairs of bones of moment times Gram matrix, which is C_k^T M C_l summed over the rows of C. Writes its
  // gradient by the sphere's own bones' figures, where asked for.
  T square_and_gradient(const Terms& at, T* gradient) const {
    if (gradient != nullptr) {
      std::fill(gradient, gradient + kFigures * at.bone_count, T{0});
    }
    T square = 0;
    const Moment* moment = at.moments;
    for (std::size_t k = 0; k < at.bone_count; ++k) {
      for (std::size_t l = k; l < at.bone_count; ++l, ++moment) {
        const T *const left = &relative_[kFigures * at.bones[k]], *const right = &relative_[kFigures * at.bones[l]];
        for (std::size_t m = 0; m < kFigures; m += 4) {
          for (std::size_t r = 0; r < 4; ++r) {
            const float* const v = moment->values + 4 * r;
            const T sum = T{v[0]} * right[m] + T{v[1]} * right[m + 1] + T{v[2]} * right[m + 2] + T{v[3]} * right[m + 3];
            square += left[m + r] * sum;
            if (gradient != nullptr) {
              gradient[kFigures * k + m + r] += sum;
              for (std::size_t c = 0; c < 4; ++c) {
                gradient[kFigures * l + m + c] += T{v[c]} * left[m + r];
              }
            }
          }
        }
      }
    }
    return square;
  }

  T moved_origin(const T* row) const {
    return row[0] * T{tables_.origin.x} + row[1] * T{tables_.origin.y} + row[2] * T{tables_.origin.z} + row[3];
  }
  void add_moved_origin(T gradient, T* row) const {
    row[0] += gradient * T{tables_.origin.x};
    row[1] += gradient * T{tables_.origin.y};
    row[2] += gradient * T{tables_.origin.z};
    row[3] += gradient;
  }

  const AssetView& asset_;
  const MomentTables& tables_;
  Radius radius_;
  std::vector<T> relative_, relative_gradient_;  // C_k, 12 numbers a bone
  T reference_[3] = {};                          // where the reference bone takes the origin
};

}  // namespace spherechain::python

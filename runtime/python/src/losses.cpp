// SPDX-License-Identifier: MIT
// Spheres, how much they overlap, points on the skin, and gradients of all these by the bones' matrices, which come in
// the asset's order. T is float, or double for checks; in double each pair of spheres is tested.
#include <type_traits>

#include "binding.h"
#include "model.h"
#include "moment_pass.h"
#include "parallel.h"
#include "runtime/src/pairs/detect_job.h"
#include "runtime/src/refit/refit_job.h"

namespace spherechain::python {
namespace {

void require_moments(const LoadedModel& model) {
  if (model.view().refit_rule() != RefitRule::kMoments || model.info().bone_count == 0) {
    require({SC_NOT_IN_ASSET, SC_FIELD_BONES});
  }
}

// These place the spheres of one pose after another.
auto sphere_worker(const LoadedModel& model, Radius radius, const Poses<float>& poses) {
  return [&, radius](std::size_t i, float* out) {
    RefitJob job;
    job.asset = &model.asset();
    job.pose = pose_of(poses, model.info().bone_count, i);
    job.radius = radius;
    job.spheres = reinterpret_cast<Sphere*>(out);
    job.sphere_capacity = model.info().sphere_count;
    require(job.run());
  };
}

auto sphere_worker(const LoadedModel& model, Radius radius, const Poses<double>& poses) {
  require_moments(model);
  return [&, pass = MomentPass<double>(model.view(), radius)](std::size_t i, double* out) mutable {
    pass.set_pose(poses.pose(i), poses.bone_stride);
    pass.spheres(out);
  };
}

template <typename T>
Array<T> spheres(const LoadedModel& model, const Array<T>& bones, Radius radius, std::size_t threads) {
  const Poses<T> poses = poses_of(model.info().bone_count, bones);
  const std::size_t n = model.info().sphere_count;
  Array<T> out = Array<T>({poses.count, n, 4});
  T* const to = out.data();
  for_each_pose(poses.count, threads, [&] {
    return [to, n, place = sphere_worker(model, radius, poses)](std::size_t i) mutable { place(i, to + 4 * n * i); };
  });
  return out;
}

// The pairs of spheres that touch, of one thread. In double all pairs that are not ignored.
template <typename T>
class PairFinder {
 public:
  PairFinder(const LoadedModel& model, Radius radius) {
    const std::size_t n = model.info().sphere_count;
    if constexpr (std::is_same_v<T, float>) {
      job_.asset = &model.asset();
      job_.sphere_count = n;
      job_.radius = radius;
      job_.table = model.detect_table(radius);
      pairs_.resize(256);
    } else {
      for (std::uint32_t a = 0; a < n; ++a) {
        for (std::uint32_t b = a + 1; b < n; ++b) {
          if (model.pair_scales(radius)[a * n + b] > 0) {
            pairs_.push_back({a, b});
          }
        }
      }
    }
  }

  // Valid until the next call.
  Span<const Pair> find(const T* spheres) {
    if constexpr (std::is_same_v<T, float>) {
      job_.spheres = reinterpret_cast<const Sphere*>(spheres);
      Status status{SC_OVERFLOW, SC_FIELD_PAIRS};
      for (int turn = 0; turn < 2 && status == SC_OVERFLOW; ++turn) {
        pairs_.resize(std::max(pairs_.size(), job_.pair_count));
        job_.pairs = pairs_.data();
        job_.pair_capacity = pairs_.size();
        status = job_.run();
      }
      require(status);
      return {pairs_.data(), job_.pair_count};
    }
    return {pairs_.data(), pairs_.size()};
  }

 private:
  DetectJob job_;
  std::vector<Pair> pairs_;
};

// An array (poses, spheres, 4).
template <typename T>
const T* spheres_of(const LoadedModel& model, const Array<T>& array, std::size_t count, const char* name) {
  return checked(array, {count, model.info().sphere_count, 4}, name);
}

// An array (pairs, 2) for each pose.
Object pairs(const LoadedModel& model, const Array<float>& spheres, Radius radius, std::size_t threads) {
  const std::size_t n = model.info().sphere_count;
  const float* const from = spheres_of(model, spheres, length(spheres), "spheres");
  std::vector<std::vector<Pair>> found(length(spheres));
  for_each_pose(found.size(), threads, [&] {
    return [&, finder = PairFinder<float>(model, radius)](std::size_t i) mutable {
      const Span<const Pair> own = finder.find(from + 4 * n * i);
      found[i].assign(own.begin(), own.end());
    };
  });
  return list_of(found.size(), [&](std::size_t i) {
    Array<std::uint32_t> out({found[i].size(), 2});
    for (std::size_t k = 0; k < found[i].size(); ++k) {
      out.data()[2 * k] = found[i][k].a;
      out.data()[2 * k + 1] = found[i][k].b;
    }
    return out;
  });
}

// (reach - distance)^2 with its gradient. The reach is the sum of the radii times `scale`.
template <typename T>
T pair_term(const T* a, const T* b, T scale, T* gradient_a, T* gradient_b) {
  const T x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
  const T squared = x * x + y * y + z * z, reach = scale * (a[3] + b[3]);
  if (!(squared < reach * reach)) {
    return 0;
  }
  const T distance = std::sqrt(squared), overlap = reach - distance;
  // Centres in one place have no direction to part: any would do, none is taken.
  const T slope = distance > 0 ? -2 * overlap / distance : T{0}, parts[3] = {slope * x, slope * y, slope * z};
  for (std::size_t i = 0; i < 3; ++i) {
    gradient_a[i] += parts[i];
    gradient_b[i] -= parts[i];
  }
  gradient_a[3] += 2 * overlap * scale;
  gradient_b[3] += 2 * overlap * scale;
  return overlap * overlap;
}

// The sum over the pairs that touch, of one thread: above 0 exactly where pairs are reported, and its gradient is
// continuous.
template <typename T>
class PairEnergy {
 public:
  PairEnergy(const LoadedModel& model, Radius radius)
      : scales_(model.pair_scales(radius)), n_(model.info().sphere_count), finder_(model, radius) {}

  T run(const T* spheres, T* gradient) {
    std::fill(gradient, gradient + 4 * n_, T{0});
    double sum = 0;
    for (const Pair& pair : finder_.find(spheres)) {
      const std::size_t a = 4 * std::size_t{pair.a}, b = 4 * std::size_t{pair.b};
      sum += double{pair_term(spheres + a, spheres + b, T{scales_[pair.a * n_ + pair.b]}, gradient + a, gradient + b)};
    }
    return static_cast<T>(sum);
  }

 private:
  const std::vector<float>& scales_;
  std::size_t n_;
  PairFinder<T> finder_;
};

template <typename T>
Object pair_energy(const LoadedModel& model, const Array<T>& spheres, Radius radius, std::size_t threads) {
  const std::size_t count = length(spheres), n = model.info().sphere_count;
  const T* const from = spheres_of(model, spheres, count, "spheres");
  Array<T> energy = Array<T>({count}), gradient = Array<T>({count, n, 4});
  T *const energies = energy.data(), *const gradients = gradient.data();
  for_each_pose(count, threads, [&] {
    return [&, pairs = PairEnergy<T>(model, radius)](std::size_t i) mutable {
      energies[i] = pairs.run(from + 4 * n * i, gradients + 4 * n * i);
    };
  });
  return tuple_of(energy, gradient);
}

// The same of the spheres that the bones move, with the gradient by the bones' matrices.
template <typename T>
Object sphere_energy(const LoadedModel& model, const Array<T>& bones, Radius radius, std::size_t threads) {
  require_moments(model);
  const std::size_t size = 12 * model.info().bone_count, n = model.info().sphere_count;
  const Poses<T> poses = poses_of(model.info().bone_count, bones);
  Array<T> energy = Array<T>({poses.count}), gradient = Array<T>({poses.count, model.info().bone_count, 3, 4});
  T *const energies = energy.data(), *const gradients = gradient.data();
  for_each_pose(poses.count, threads, [&] {
    return [&, place = sphere_worker(model, radius, poses), pairs = PairEnergy<T>(model, radius),
            pass = MomentPass<T>(model.view(), radius), spheres = std::vector<T>(4 * n),
            slopes = std::vector<T>(4 * n)](std::size_t i) mutable {
      place(i, spheres.data());
      energies[i] = pairs.run(spheres.data(), slopes.data());
      std::fill(gradients + size * i, gradients + size * (i + 1), T{0});
      if (energies[i] > 0) {
        pass.set_pose(poses.pose(i), poses.bone_stride);
        pass.pull_back(slopes.data(), gradients + size * i);
      }
    };
  });
  return tuple_of(energy, gradient);
}

// For any function of the spheres: from its gradient by them to that by the bones' matrices.
template <typename T>
Array<T> spheres_vjp(const LoadedModel& model, const Array<T>& bones, const Array<T>& slopes, Radius radius,
                     std::size_t threads) {
  require_moments(model);
  const std::size_t bone_count = model.info().bone_count, n = model.info().sphere_count;
  const Poses<T> poses = poses_of(bone_count, bones);
  const T* const from = spheres_of(model, slopes, poses.count, "gradient");
  Array<T> gradient = Array<T>({poses.count, bone_count, 3, 4});
  T* const to = gradient.data();
  for_each_pose(poses.count, threads, [&] {
    return [&, pass = MomentPass<T>(model.view(), radius)](std::size_t i) mutable {
      std::fill(to + 12 * bone_count * i, to + 12 * bone_count * (i + 1), T{0});
      pass.set_pose(poses.pose(i), poses.bone_stride);
      pass.pull_back(from + 4 * n * i, to + 12 * bone_count * i);
    };
  });
  return gradient;
}

// Points on the skin: of each its triangle in the source and the weights of its corners.
class SkinPoints {
 public:
  // A point is the sum over bones of matrix times (x, y, z, w).
  struct Term {
    std::size_t bone;
    double at[4];
  };

  SkinPoints(const LoadedModel& model, const Array<std::uint32_t>& triangles, const Array<float>& weights)
      : surface_(model.surface()),
        count_(length(triangles)),
        triangles_(checked(triangles, {count_}, "triangles")),
        weights_(checked(weights, {count_, 3}, "weights")) {
    for (std::size_t p = 0; p < count_; ++p) {
      if (triangles_[p] >= surface_.place_of_source.size || surface_.place_of_source[triangles_[p]] == kNoPlace) {
        throw std::invalid_argument("triangle " + std::to_string(triangles_[p]) + " is not in the asset's skin");
      }
    }
  }
  std::size_t count() const { return count_; }

  // Calls use(term) for each term of a point.
  template <typename Use>
  void for_terms(std::size_t point, const float* morph_weights, const Use& use) const {
    const std::uint32_t place = surface_.place_of_source[triangles_[point]];
    const Cluster& cluster =
        *(std::upper_bound(surface_.clusters.begin(), surface_.clusters.end(), place,
                           [](std::uint32_t p, const Cluster& c) { return p < c.first_triangle; }) -
          1);
    const std::size_t slots = slot_count(cluster);
    double corners[3][4];
    std::size_t slot[3];
    for (std::size_t c = 0; c < 3; ++c) {
      slot[c] = surface_.corners[3 * std::size_t{place} + c];
      place_corner(cluster, slot[c], slots, morph_weights, corners[c]);
    }
    for (std::size_t k = 0; k < cluster.bone_count; ++k) {
      Term term{surface_.cluster_bones[cluster.first_bone + k], {}};
      for (std::size_t c = 0; c < 3; ++c) {
        const float weight = surface_.slot_weights[cluster.first_weight + k * slots + slot[c]];
        const double share = double{weights_[3 * point + c]} * double{weight};
        for (std::size_t x = 0; x < 4; ++x) {
          term.at[x] += share * corners[c][x];
        }
      }
      use(term);
    }
  }

 private:
  void place_corner(const Cluster& cluster, std::size_t slot, std::size_t slots, const float* weights,
                    double (&out)[4]) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      out[axis] = double{surface_.slot_positions[3 * std::size_t{cluster.first_slot} + axis * slots + slot]};
    }
    out[3] = 1;
    for (std::size_t i = 0; weights != nullptr && i < cluster.morph_count; ++i) {
      const SlotMorph& morph = surface_.slot_morphs[cluster.first_morph + i];
      if (morph.slot == slot) {
        const double weight{weights[morph.target]};
        out[0] += weight * double{morph.delta.x};
        out[1] += weight * double{morph.delta.y};
        out[2] += weight * double{morph.delta.z};
      }
    }
  }

  Surface surface_;
  std::size_t count_;
  const std::uint32_t* triangles_;
  const float* weights_;
};

using OptionalRows = std::optional<Array<float>>;

template <typename T>
Array<T> points(const LoadedModel& model, const Array<T>& bones, const Array<std::uint32_t>& triangles,
                const Array<float>& weights, const OptionalRows& morph_weights, std::size_t threads) {
  const Poses<T> poses = poses_of(model.info().bone_count, bones);
  const SkinPoints skin(model, triangles, weights);
  const float* const morphs = morphs_of(model, morph_weights, poses.count);
  Array<T> out = Array<T>({poses.count, skin.count(), 3});
  T* const to = out.data();
  for_each_pose(poses.count, threads, [&] {
    return [&](std::size_t i) {
      for (std::size_t p = 0; p < skin.count(); ++p) {
        double sum[3] = {};
        skin.for_terms(p, morphs == nullptr ? nullptr : morphs + i * model.info().morph_count, [&](const auto& term) {
          const T* row = poses.pose(i) + term.bone * poses.bone_stride;
          for (double& figure : sum) {
            for (std::size_t x = 0; x < 4; ++x) {
              figure += double{*row++} * term.at[x];
            }
          }
        });
        std::copy(sum, sum + 3, to + 3 * (i * skin.count() + p));
      }
    };
  });
  return out;
}

// The gradient by the matrices of the sum of slope . point, added up in out[row of the point].
Array<float> points_vjp(const LoadedModel& model, std::size_t count, const Array<std::uint32_t>& rows,
                        const Array<std::uint32_t>& triangles, const Array<float>& weights, const Array<float>& slopes,
                        const OptionalRows& morph_weights) {
  const std::size_t bone_count = model.info().bone_count;
  const SkinPoints skin(model, triangles, weights);
  const std::uint32_t* const row_of = checked(rows, {skin.count()}, "rows");
  const float* const slope = checked(slopes, {skin.count(), 3}, "slopes");
  const float* const morphs = morphs_of(model, morph_weights, count);
  Array<float> out = Array<float>({count, bone_count, 3, 4});
  float* const to = out.data();
  std::fill(to, to + count * bone_count * 12, 0.0F);
  for (std::size_t p = 0; p < skin.count(); ++p) {
    const std::size_t row = row_of[p];
    require(row < count, "rows");
    skin.for_terms(p, morphs == nullptr ? nullptr : morphs + row * model.info().morph_count, [&](const auto& term) {
      for (std::size_t m = 0; m < 12; ++m) {
        to[12 * (row * bone_count + term.bone) + m] += slope[3 * p + m / 4] * static_cast<float>(term.at[m % 4]);
      }
    });
  }
  return out;
}

Array<float> pair_scales(const LoadedModel& model, Radius radius) {
  const std::size_t n = model.info().sphere_count;
  Array<float> out = Array<float>({n, n});
  std::copy(model.pair_scales(radius).begin(), model.pair_scales(radius).end(), out.data());
  return out;
}

}  // namespace

const std::vector<PyMethodDef> loss_methods{
    {"spheres", call_by_type<&spheres<float>, &spheres<double>>, METH_VARARGS, nullptr},
    {"pair_energy", call_by_type<&pair_energy<float>, &pair_energy<double>>, METH_VARARGS, nullptr},
    {"sphere_energy", call_by_type<&sphere_energy<float>, &sphere_energy<double>>, METH_VARARGS, nullptr},
    {"spheres_vjp", call_by_type<&spheres_vjp<float>, &spheres_vjp<double>>, METH_VARARGS, nullptr},
    {"points", call_by_type<&points<float>, &points<double>>, METH_VARARGS, nullptr},
    {"pairs", Call<&pairs>::run, METH_VARARGS, nullptr},
    {"pair_scales", Call<&pair_scales>::run, METH_VARARGS, nullptr},
    {"points_vjp", Call<&points_vjp>::run, METH_VARARGS, nullptr}};

}  // namespace spherechain::python

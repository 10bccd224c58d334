// SPDX-License-Identifier: MIT
#include "energy.h"

#include <type_traits>

#include "moment_pass.h"
#include "pairs.h"
#include "parallel.h"
#include "refit/refit_job.h"

namespace spherechain::python {
namespace {

// The energy of one thread's poses.
template <typename T>
class PairEnergy {
 public:
  PairEnergy(const LoadedAsset& asset, Radius radius)
      : asset_(asset), rest_pairs_(asset.view().rest_pairs(radius)), finder_(asset, radius), radius_(radius) {}

  // Adds to the gradient.
  T run(const T* spheres, T* gradient) {
    double energy = 0;
    const auto add = [&](std::size_t a, std::size_t b) {
      energy += double{term(spheres + 4 * a, spheres + 4 * b, scale_of(a, b), gradient + 4 * a, gradient + 4 * b)};
    };
    if constexpr (std::is_same_v<T, float>) {
      for (const Pair& pair : finder_.find(reinterpret_cast<const Sphere*>(spheres))) {
        add(pair.a, pair.b);
      }
    } else {
      const Span<const std::uint64_t> ignored = asset_.view().ignored();
      for (std::size_t b = 1, bit = 0; b < asset_.info().sphere_count; ++b) {
        for (std::size_t a = 0; a < b; ++a, ++bit) {
          if ((ignored[bit / 64] >> bit % 64 & 1) == 0) {
            add(a, b);
          }
        }
      }
    }
    return static_cast<T>(energy);
  }

 private:
  T scale_of(std::size_t a, std::size_t b) const {
    const RestPair* const found = std::lower_bound(rest_pairs_.begin(), rest_pairs_.end(), std::pair(a, b),
                                                   [](const RestPair& pair, const auto& key) {
                                                     return std::pair(std::size_t{pair.a}, std::size_t{pair.b}) < key;
                                                   });
    return found != rest_pairs_.end() && found->a == a && found->b == b ? T{found->rest_scale} : T{1};
  }

  static T term(const T* a, const T* b, T scale, T* gradient_a, T* gradient_b) {
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

  const LoadedAsset& asset_;
  Span<const RestPair> rest_pairs_;
  PairFinder finder_;
  Radius radius_;
};

void require_moments(const LoadedAsset& asset) {
  if (asset.view().refit_rule() != RefitRule::kMoments || asset.info().bone_count == 0) {
    require({SC_NOT_IN_ASSET, SC_FIELD_BONES});
  }
}

}  // namespace

void refit(const LoadedAsset& asset, Radius radius, const Poses<float>& poses, std::size_t i, Sphere* spheres) {
  RefitJob job;
  job.asset = &asset.asset();
  job.pose = pose_of(asset, poses, i);
  job.radius = radius;
  job.spheres = spheres;
  job.sphere_capacity = asset.info().sphere_count;
  require(job.run());
}

template <typename T>
void pair_energy(const LoadedAsset& asset, Radius radius, const T* spheres, std::size_t count, std::size_t threads,
                 T* energy, T* gradient) {
  const std::size_t size = 4 * asset.info().sphere_count;
  for_each_pose(count, threads, [&] {
    return [&, pairs = PairEnergy<T>(asset, radius)](std::size_t i) mutable {
      std::fill(gradient + i * size, gradient + (i + 1) * size, T{0});
      energy[i] = pairs.run(spheres + i * size, gradient + i * size);
    };
  });
}

template <typename T>
void sphere_energy(const LoadedAsset& asset, Radius radius, const Poses<T>& poses, std::size_t threads, T* energy,
                   T* gradient) {
  require_moments(asset);
  const std::size_t size = 12 * asset.info().bone_count, sphere_size = 4 * asset.info().sphere_count;
  for_each_pose(poses.count, threads, [&] {
    return [&, pairs = PairEnergy<T>(asset, radius), pass = MomentPass<T>(asset.view(), radius),
            spheres = std::vector<T>(sphere_size), slopes = std::vector<T>(sphere_size)](std::size_t i) mutable {
      if constexpr (std::is_same_v<T, float>) {
        refit(asset, radius, poses, i, reinterpret_cast<Sphere*>(spheres.data()));
      } else {
        pass.set_pose(poses.pose(i), poses.bone_stride);
        pass.spheres(spheres.data());
      }
      std::fill(slopes.begin(), slopes.end(), T{0});
      std::fill(gradient + i * size, gradient + (i + 1) * size, T{0});
      energy[i] = pairs.run(spheres.data(), slopes.data());
      if (energy[i] > 0) {
        if constexpr (std::is_same_v<T, float>) {
          pass.set_pose(poses.pose(i), poses.bone_stride);
        }
        pass.pull_back(slopes.data(), gradient + i * size);
      }
    };
  });
}

template <typename T>
void pull_back_spheres(const LoadedAsset& asset, Radius radius, const Poses<T>& poses, const T* spheres,
                       std::size_t threads, T* gradient) {
  require_moments(asset);
  const std::size_t size = 12 * asset.info().bone_count, sphere_size = 4 * asset.info().sphere_count;
  for_each_pose(poses.count, threads, [&] {
    return [&, pass = MomentPass<T>(asset.view(), radius)](std::size_t i) mutable {
      std::fill(gradient + i * size, gradient + (i + 1) * size, T{0});
      pass.set_pose(poses.pose(i), poses.bone_stride);
      pass.pull_back(spheres + i * sphere_size, gradient + i * size);
    };
  });
}

#define SPHERECHAIN_FOR(T)                                                                              \
  template void pair_energy<T>(const LoadedAsset&, Radius, const T*, std::size_t, std::size_t, T*, T*); \
  template void sphere_energy<T>(const LoadedAsset&, Radius, const Poses<T>&, std::size_t, T*, T*);     \
  template void pull_back_spheres<T>(const LoadedAsset&, Radius, const Poses<T>&, const T*, std::size_t, T*);
SPHERECHAIN_FOR(float)
SPHERECHAIN_FOR(double)
#undef SPHERECHAIN_FOR

}  // namespace spherechain::python

// SPDX-License-Identifier: MIT
// How much a character's spheres overlap, as a smooth figure that can be lowered by its gradient.
#pragma once

#include "loaded_asset.h"
#include "poses.h"

namespace spherechain::python {

// E = the sum over the pairs that touch of (t - d)^2, with d the distance of the two centres and t the sum of the
// radii; of a rest pair times its rest_scale. So E is above 0 exactly where pairs are reported, and its gradient is
// continuous. T is float or double; in float pairs are those of sc_detect(), in double each pair is tested.

// `spheres` and `gradient`: four numbers a sphere, sphere by sphere, pose by pose. Null gradient: not asked for.
template <typename T>
void pair_energy(const LoadedAsset& asset, Radius radius, const T* spheres, std::size_t count, std::size_t threads,
                 T* energy, T* gradient);

// The same of the spheres that the bones move, by the bones' matrices: 12 numbers a bone.
template <typename T>
void sphere_energy(const LoadedAsset& asset, Radius radius, const Poses<T>& poses, std::size_t threads, T* energy,
                   T* gradient);

// For any function of the spheres: from its gradient by them to that by the bones' matrices.
template <typename T>
void pull_back_spheres(const LoadedAsset& asset, Radius radius, const Poses<T>& poses, const T* spheres,
                       std::size_t threads, T* gradient);

// The spheres of pose i.
void refit(const LoadedAsset& asset, Radius radius, const Poses<float>& poses, std::size_t i, Sphere* spheres);

}  // namespace spherechain::python

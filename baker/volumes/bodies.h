// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/play/asset_file.h"
#include "baker/volumes/colliders.h"

namespace spherechain::baker {

// The asset's body parts as bodies without volumes, parents first.
Colliders find_bodies(const OpenAsset& asset);

// For each of the asset's body parts, the index of its body.
std::vector<int> body_of_parts(const OpenAsset& asset, const Colliders& colliders);

// Where the bodies stand at rest.
std::vector<Eigen::Isometry3d> at_rest(const Colliders& colliders);

// The skin's vertices in metres: at rest, and where the source's vertices stand in a pose.
std::vector<Vec3> skin_positions(const OpenAsset& asset);
std::vector<Vec3> skin_positions(const OpenAsset& asset, const std::vector<Vec3>& source);

// A point of the skin that stands for some of its area.
struct SkinSample {
  Vec3 point, normal;
  double area;
  int body;  // that it belongs to
};

// Samples the skin's vertices evenly, about `count` points a body.
std::vector<SkinSample> sample_skin(const OpenAsset& asset, const Colliders& colliders,
                                    const std::vector<Vec3>& positions, int count);

// Adds to `ignored` each body and the one that it hangs on, and those whose volumes overlap at rest.
void ignore_by_rest(Colliders& colliders);

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "play/asset_file.h"
#include "volumes/colliders.h"

namespace spherechain::baker {

// A point of the skin at rest that stands for some of its area, in metres.
struct SkinSample {
  Vec3 point, normal;
  double area;
  int body;  // that it belongs to
};

// The asset's body parts as bodies without volumes, parents first.
Colliders find_bodies(const OpenAsset& asset);

// The rest pose's skin, evenly: about `count` points a body.
std::vector<SkinSample> sample_skin(const OpenAsset& asset, const Colliders& colliders, int count);

// Each sphere of the asset, at its detect radius, to the body that most of its triangles belong to.
void take_spheres(const OpenAsset& asset, Colliders& colliders);

// Adds to `ignored` each body and the one that it hangs on, and those whose volumes overlap at rest.
void ignore_by_rest(Colliders& colliders);

}  // namespace spherechain::baker

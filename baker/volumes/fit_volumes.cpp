// SPDX-License-Identifier: GPL-3.0-or-later
#include "volumes/fit_volumes.h"

#include "volumes/bodies.h"

namespace spherechain::baker {

Colliders fit_volumes(const OpenAsset& asset, VolumeShape, int) {
  Colliders out = find_bodies(asset);
  take_spheres(asset, out);
  ignore_by_rest(out);
  return out;
}

}  // namespace spherechain::baker

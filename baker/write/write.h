// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "baker/bind/bind.h"
#include "baker/bind/bind_bones.h"
#include "baker/bind/bind_moments.h"
#include "baker/bind/body_parts.h"
#include "baker/chains/chains.h"
#include "baker/clusters/clusters.h"
#include "baker/layers/layers.h"
#include "baker/rig/rig.h"

namespace spherechain::baker {

// Everything an asset is made of.
struct AssetSource {
  const Character& character;
  const Regions& regions;
  const Spheres& spheres;
  const Chains& chains;
  const Binding& binding;
  const std::vector<Joint>& joints;
  const BoneBinding& bones;
  const MomentBinding& moments;
  const BodyParts& parts;
  const Clusters& clusters;
  const Layers& layers;
  std::string settings;  // canonical JSON
};

// The bytes of a .sphc file: the same for the same input. Throws Error(kInternal) should the runtime not open them.
std::vector<std::uint8_t> serialize(const AssetSource& source);

}  // namespace spherechain::baker

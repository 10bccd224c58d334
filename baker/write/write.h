// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "baker/bind/bind.h"
#include "baker/bind/bind_bones.h"
#include "baker/bind/bind_moments.h"
#include "baker/bind/body_parts.h"
#include "baker/chains/chains.h"
#include "baker/clusters/clusters.h"
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
  std::string settings;  // canonical JSON
};

// The bytes of a .sphc file: the same for the same input. Throws Error(kInternal) should the runtime not open them.
std::vector<std::uint8_t> serialize(const AssetSource& source);

// True if bytes go straight to what `path` names: a pipe, a device, or what the program was started with under the name
// of a descriptor (/dev/stdout), which a rename would take away from everybody.
bool is_written_directly(const std::filesystem::path& path);

// The file that writing to `path` makes or replaces: where links lead, there or not; what is written directly is
// itself. Throws Error(kFile) for links that the system does not follow.
std::filesystem::path written_file(const std::filesystem::path& path);

// Else writes next to that file and renames, so that it is either whole or untouched, and links to it stay. Throws
// Error(kFile).
void write_atomically(const std::filesystem::path& path, std::string_view bytes);

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
// The part of an asset that cluster bounds and exact contacts read, packed without loss.
#pragma once

#include <vector>

#include "baker/bind/bind_bones.h"
#include "baker/bind/body_parts.h"
#include "baker/clusters/clusters.h"
#include "baker/layers/layers.h"
#include "sphere_chains_generated.h"

namespace spherechain::baker {

flatbuffers::Offset<schema::Skin> create_skin(flatbuffers::FlatBufferBuilder& builder, const Character& character,
                                              const BoneBinding& bones, const Clusters& clusters,
                                              const BodyParts& parts, const Layers& layers, std::size_t sphere_count);

}  // namespace spherechain::baker

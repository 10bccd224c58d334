// SPDX-License-Identifier: GPL-3.0-or-later
// The part of an asset that leaf bounds and exact contacts read.
#pragma once

#include "clusters/clusters.h"
#include "sphere_chains_generated.h"
#include "spherechain/surface.h"

namespace spherechain::baker {

flatbuffers::Offset<schema::Surface> create_surface(flatbuffers::FlatBufferBuilder& builder, const Character& character,
                                                    const BoneBinding& bones, const Clusters& clusters,
                                                    const std::vector<TrianglePair>& rest_contacts);

}  // namespace spherechain::baker

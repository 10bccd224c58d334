// SPDX-License-Identifier: GPL-3.0-or-later
// Writes the bones of an asset, and the tables for the refit from bones.
#pragma once

#include <vector>

#include "baker/bind/bind_bones.h"
#include "baker/bind/bind_moments.h"
#include "sphere_chains_generated.h"

namespace spherechain::baker {

std::vector<flatbuffers::Offset<schema::Bone>> create_bones(flatbuffers::FlatBufferBuilder& builder,
                                                            const BoneBinding& bones);

// Null if there are no batches.
flatbuffers::Offset<schema::Moments> create_moments(flatbuffers::FlatBufferBuilder& builder,
                                                    const MomentBinding& moments);

}  // namespace spherechain::baker

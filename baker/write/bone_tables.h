// SPDX-License-Identifier: GPL-3.0-or-later
// The parts of an asset that refit from bones and from packed pivots reads.
#pragma once

#include <cstdint>
#include <vector>

#include "bind/bind_bones.h"
#include "bind/bind_moments.h"
#include "sphere_chains_generated.h"

namespace spherechain::baker {

struct PackedPivots {
  std::vector<std::uint32_t> vertices;  // of the source: ascending, each once
  std::vector<schema::Pivot> pivots;    // their corners numbered in those
};
PackedPivots pack_pivots(const std::vector<schema::Pivot>& pivots);

// None where nothing moves the source.
flatbuffers::Offset<schema::BoneRefit> create_bone_refit(flatbuffers::FlatBufferBuilder& builder,
                                                         const BoneBinding& bones, const MomentBinding& moments);

}  // namespace spherechain::baker

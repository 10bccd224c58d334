// SPDX-License-Identifier: GPL-3.0-or-later
// The baker's values as the schema has them.
#pragma once

#include <array>
#include <vector>

#include "baker/mesh/mesh.h"
#include "sphere_chains_generated.h"

namespace spherechain::baker {

template <std::size_t N>
flatbuffers::span<const float, N> span_of(const std::array<float, N>& lanes) {
  return flatbuffers::span<const float, N>(lanes.data(), N);
}

inline schema::Vec3 to_schema(const Vec3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

// Lanes that start at a multiple of their own size never straddle two cache lines.
template <typename Struct>
auto aligned_vector(flatbuffers::FlatBufferBuilder& builder, const std::vector<Struct>& values) {
  builder.ForceVectorAlignment(values.size(), sizeof(Struct), 8 * sizeof(float));
  return builder.CreateVectorOfStructs(values);
}

}  // namespace spherechain::baker

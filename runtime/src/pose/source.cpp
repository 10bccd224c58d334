// SPDX-License-Identifier: MIT
// Are these the vertices that the asset was baked from?
#include <cstring>

#include "runtime/src/base/status.h"
#include "runtime/src/pose/pose.h"

using namespace spherechain;

extern "C" {

uint64_t sc_hash_positions(const float* positions, size_t count, size_t stride) noexcept {
  constexpr std::uint64_t kOffsetBasis = 14695981039346656037ULL;
  constexpr std::uint64_t kPrime = 1099511628211ULL;
  std::uint64_t hash = kOffsetBasis;
  for (std::size_t i = 0; i < count && positions != nullptr; ++i) {
    const float* const position = vertex_at(positions, i, stride == 0 ? kPackedVertex : stride);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float value = position[axis] == 0.0F ? 0.0F : position[axis];
      std::uint32_t bits = 0;
      std::memcpy(&bits, &value, sizeof bits);
      for (unsigned shift = 0; shift < 32; shift += 8) {
        hash = (hash ^ ((bits >> shift) & 0xFFU)) * kPrime;
      }
    }
  }
  return hash;
}

sc_status sc_check_source(const sc_asset* asset, size_t buffer, const float* positions, size_t count,
                          size_t stride) noexcept {
  if (!is_open(asset)) {
    return refuse(asset == nullptr ? SC_NULL : SC_NOT_OPEN, SC_FIELD_ASSET);
  }
  const AssetView& view = view_of(*asset);
  if (buffer != SC_WHOLE_SOURCE && buffer >= view.source_buffers().size) {
    return refuse(SC_BAD_VALUE, SC_FIELD_INDEX);
  }
  const bool is_whole = buffer == SC_WHOLE_SOURCE;
  const std::size_t wanted = is_whole ? view.vertex_count() : view.source_buffers()[buffer].vertex_count;
  Pose pose{};
  pose.vertices = positions;
  pose.vertex_count = count;
  pose.vertex_stride = stride;
  const Status status = check_vertices(pose, wanted);
  if (status != SC_OK) {
    return status;
  }
  const std::uint64_t hash = is_whole ? view.info().source_rest_hash : view.source_buffers()[buffer].hash;
  return sc_hash_positions(positions, wanted, stride) == hash ? done() : refuse(SC_WRONG_SOURCE, SC_FIELD_VERTICES);
}

}  // extern "C"

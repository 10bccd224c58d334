// SPDX-License-Identifier: MIT
// Is this the vertex buffer the asset was baked from?
#include <cstring>

#include "arithmetic.h"
#include "memory.h"
#include "spherechain/asset.h"
#include "stride.h"

namespace spherechain {

std::uint64_t hash_positions(const float* positions, std::size_t count, std::size_t stride) noexcept {
  constexpr std::uint64_t kOffsetBasis = 14695981039346656037ULL;
  constexpr std::uint64_t kPrime = 1099511628211ULL;
  std::uint64_t hash = kOffsetBasis;
  for (std::size_t i = 0; i < count; ++i) {
    const float* position = vertex_at(positions, i, stride);
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

namespace {

Status check(const float* positions, std::size_t count, std::size_t stride, std::size_t wanted, std::uint64_t hash) {
  if (any_misaligned(positions)) {
    return Status::kMisaligned;
  }
  if (!is_valid_stride(stride)) {
    return Status::kBadStride;
  }
  if (count < wanted) {
    return Status::kTooFewVertices;
  }
  return hash_positions(positions, wanted, stride) == hash ? Status::kOk : Status::kWrongSource;
}

}  // namespace

Status check_source(const Asset& asset, const float* positions, std::size_t count, std::size_t stride) noexcept {
  if (positions == nullptr) {
    return Status::kNullArgument;
  }
  if (!asset.is_open()) {
    return Status::kNotOpen;
  }
  const AssetInfo info = asset.info();
  return check(positions, count, stride, info.source_vertex_count, info.source_rest_hash);
}

Status check_source_part(const Asset& asset, std::size_t part, const float* positions, std::size_t count,
                         std::size_t stride) noexcept {
  if (positions == nullptr) {
    return Status::kNullArgument;
  }
  if (!asset.is_open()) {
    return Status::kNotOpen;
  }
  if (part >= asset.source_parts().size) {
    return Status::kBadArgument;
  }
  const SourcePart& wanted = asset.source_parts()[part];
  return check(positions, count, stride, wanted.vertex_count, wanted.hash);
}

}  // namespace spherechain

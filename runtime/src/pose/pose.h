// SPDX-License-Identifier: MIT
// A caller's pose, checked and resolved: what all jobs have in common.
#pragma once

#include <cstddef>

#include "asset/asset_view.h"
#include "asset/memory.h"
#include "spherechain/pose.h"

namespace spherechain {

// Bytes of one matrix; 0 for a layout that does not exist.
constexpr std::size_t size_of(MatrixLayout layout) noexcept {
  return layout == SC_ROWS_3X4 || layout == SC_COLUMNS_3X4   ? 48
         : layout == SC_ROWS_4X4 || layout == SC_COLUMNS_4X4 ? 64
                                                             : 0;
}

// A pose's matrices, side by side or not: element (r, c) of bone b is data[b * stride + r * row + c * column].
struct BoneMatrices {
  const float* data = nullptr;
  std::size_t stride = 0, row = 0, column = 0;  // floats
};

inline std::size_t bone_stride(const Pose& pose) {  // bytes
  return pose.bone_stride == 0 ? size_of(pose.bone_layout) : pose.bone_stride;
}
inline BoneMatrices matrices_of(const Pose& pose) {
  BoneMatrices out;
  out.data = pose.bones;
  out.stride = bone_stride(pose) / sizeof(float);
  const bool by_rows = pose.bone_layout == SC_ROWS_3X4 || pose.bone_layout == SC_ROWS_4X4;
  out.row = by_rows ? 4 : 1;
  out.column = by_rows ? 1 : pose.bone_layout == SC_COLUMNS_4X4 ? 4 : 3;
  return out;
}
inline std::size_t vertex_stride(const Pose& pose) { return pose.vertex_stride == 0 ? 12 : pose.vertex_stride; }

// Whether the pose's bones, or its vertices, are what a job of this open asset needs.
Status check_bones(const AssetView& asset, const Pose& pose);
Status check_vertices(const AssetView& asset, const Pose& pose);

// What is read of a checked pose.
MemoryRange range_of_bones(const AssetView& asset, const Pose& pose);
MemoryRange range_of_vertices(const AssetView& asset, const Pose& pose);
MemoryRange range_of_morph_weights(const AssetView& asset, const Pose& pose);

constexpr bool is_radius(Radius radius) { return radius == SC_RADIUS_FIT || radius == SC_RADIUS_DETECT; }

}  // namespace spherechain

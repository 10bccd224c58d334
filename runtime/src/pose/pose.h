// SPDX-License-Identifier: MIT
// A caller's pose, checked and resolved: what all jobs have in common.
#pragma once

#include <cstddef>

#include "runtime/src/asset/asset_view.h"
#include "runtime/src/base/memory.h"
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
  const bool by_rows = pose.bone_layout == SC_ROWS_3X4 || pose.bone_layout == SC_ROWS_4X4;
  const std::size_t column = by_rows ? 1 : pose.bone_layout == SC_COLUMNS_4X4 ? 4 : 3;
  return {pose.bones, bone_stride(pose) / sizeof(float), by_rows ? std::size_t{4} : 1, column};
}

inline constexpr std::size_t kPackedVertex = 3 * sizeof(float);
inline std::size_t vertex_stride(const Pose& pose) {  // bytes
  return pose.vertex_stride == 0 ? kPackedVertex : pose.vertex_stride;
}
inline const float* vertex_at(const float* positions, std::size_t index, std::size_t stride) {
  return positions + index * (stride / sizeof(float));
}

// Whether matrices can be read: their pointer, layout and stride, not their number.
Status check_matrices(const Pose& pose);
// Whether the pose's bones and morph weights are what a job of this open asset needs.
Status check_bones(const AssetView& asset, const Pose& pose);
// Whether every bone's matrix is the same, the model's own, as it is in the bind pose. SC_OTHER_BIND: the message names
// the first bone whose matrix moves the character otherwise, by more than a thousandth of its height.
Status check_rest_pose(const Asset& asset, const Pose& pose, char* message, std::size_t message_size);

// Whether the pose has `wanted` vertices, or the asset's.
Status check_vertices(const Pose& pose, std::size_t wanted);
inline Status check_vertices(const AssetView& asset, const Pose& pose) {
  return check_vertices(pose, asset.vertex_count());
}

// Whether the pose has what a job on the skin needs: vertices, bones or both.
Status check_skin_pose(const AssetView& asset, const Pose& pose);

// How much larger the character is in a checked pose than at rest: by the matrix of its root, the first part that hangs
// on none. 1 without bones, and where only rounding differs.
double scale_of(const AssetView& asset, const Pose& pose);

// The memory that is read of a checked pose.
MemoryRange range_of_bones(const AssetView& asset, const Pose& pose);
MemoryRange range_of_vertices(const AssetView& asset, const Pose& pose);
MemoryRange range_of_morph_weights(const AssetView& asset, const Pose& pose);

constexpr bool is_radius(Radius radius) { return radius == SC_RADIUS_FIT || radius == SC_RADIUS_DETECT; }

}  // namespace spherechain

// SPDX-License-Identifier: MIT
// Bone matrices of a batch, rows of 3 by 4, wherever they lie.
#pragma once

#include "loaded_asset.h"

namespace spherechain::python {

// Strides in numbers; a matrix' rows lie side by side.
template <typename T>
struct Poses {
  const T* data;
  std::size_t count, pose_stride, bone_stride;

  const T* pose(std::size_t i) const { return data + i * pose_stride; }
};

inline sc_pose pose_of(const LoadedAsset& asset, const Poses<float>& poses, std::size_t i) {
  sc_pose pose;
  pose.bones = poses.pose(i);
  pose.bone_count = asset.info().bone_count;
  pose.bone_layout = SC_ROWS_3X4;
  pose.bone_stride = poses.bone_stride * sizeof(float);
  return pose;
}

}  // namespace spherechain::python

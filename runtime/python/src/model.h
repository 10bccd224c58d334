// SPDX-License-Identifier: MIT
// A model with the bodies that are kept from call to call, and arrays about it. Sizes are checked here, so that nothing
// reads out of bounds; spherechain/_model.py checks what people pass, and says it in their words.
#pragma once

#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "convert.h"
#include "runtime/src/skin/skin_table.h"
#include "spherechain/spherechain.h"

namespace spherechain::python {

// These throw std::invalid_argument, which Python sees as ValueError: "pose.bones: too small".
void require(const Status& status);
void require(bool is_so, const char* name);

// An array in C order of exactly this shape.
template <typename T>
T* checked(const Array<T>& array, std::initializer_list<std::size_t> shape, const char* name) {
  bool is_so = array.axes() == shape.size() && array.is_c_order();
  std::size_t axis = 0;
  for (const std::size_t size : shape) {
    is_so = is_so && array.size(axis++) == size;
  }
  require(is_so, name);
  return array.data();
}

template <typename T>
std::size_t length(const Array<T>& array) {
  return array.axes() > 0 ? array.size(0) : 0;
}

using Joint = std::pair<std::string, std::optional<Array<float>>>;  // its name, and its inverse bind matrix, 3 by 4

// Threads may call everything at once.
class LoadedModel {
 public:
  // Throws std::invalid_argument with the sentence of sc_create_model().
  LoadedModel(const Bytes& asset, const std::optional<std::vector<Joint>>& joints);

  const Model& model() const { return model_; }
  const Asset& asset() const { return model_.asset(); }
  const AssetView& view() const { return view_of(asset()); }
  const AssetInfo& info() const { return info_; }
  std::size_t joint_count() const { return joint_count_; }  // of a palette
  const std::uint32_t* joint_of_bone() const;               // null: palettes come in the asset's order
  const std::uint64_t* detect_table(Radius radius) const;   // null: there is none
  Surface surface() const;

  // For each two spheres by what the sum of their radii is multiplied: 0 where they are ignored, a rest pair's
  // rest_scale, else 1. Row by row; symmetric.
  const std::vector<float>& pair_scales(Radius radius) const;

  // A body with room for all penetrations of this model, alone or with another. Bodies for steps, or for other models,
  // are made anew; the others are kept.
  Body take_body(const LoadedModel& other, bool finds_steps, std::size_t max_triangles) const;
  void give_back(Body body) const;

 private:
  Model model_;
  AssetInfo info_{};
  std::size_t joint_count_ = 0;
  mutable std::mutex mutex_;
  mutable std::vector<Body> spare_;
  mutable std::vector<float> pair_scales_[2];
};

// Matrices of a batch, rows of 3 by 4 that lie side by side. Strides in numbers.
template <typename T>
struct Poses {
  const T* data;
  std::size_t count, pose_stride, bone_stride;

  const T* pose(std::size_t i) const { return data + i * pose_stride; }
};

// Takes an array (poses, bones, 3, 4).
template <typename T>
Poses<T> poses_of(std::size_t bone_count, const Array<T>& bones) {
  constexpr Py_ssize_t kSize = sizeof(T);
  require(
      bones.axes() == 4 && bones.size(2) == 3 && bones.size(3) == 4 && bones.size(1) > 0 && bones.size(1) == bone_count,
      "bones");
  const bool lies_well = bones.stride(3) == kSize && bones.stride(2) == 4 * kSize && bones.stride(1) >= 12 * kSize &&
                         bones.stride(1) % kSize == 0 && bones.stride(0) >= 0 && bones.stride(0) % kSize == 0;
  require(lies_well || bones.size(0) == 0, "bones");
  return {bones.data(), length(bones), static_cast<std::size_t>(bones.stride(0)) / kSize,
          static_cast<std::size_t>(bones.stride(1)) / kSize};
}

inline Pose pose_of(const Poses<float>& poses, std::size_t bone_count, std::size_t i) {
  Pose pose;
  pose.bones = poses.pose(i);
  pose.bone_count = bone_count;
  pose.bone_layout = SC_ROWS_3X4;
  pose.bone_stride = poses.bone_stride * sizeof(float);
  return pose;
}

// Null where None.
inline const float* morphs_of(const LoadedModel& model, const std::optional<Array<float>>& weights, std::size_t count) {
  return weights ? checked(*weights, {count, model.info().morph_count}, "morph_weights") : nullptr;
}

// Where the skin is in each pose: by matrices, or by vertices.
struct SkinPoses {
  Array<float> kept;
  Poses<float> bones{};                                       // data null: none
  const float *vertices = nullptr, *morph_weights = nullptr;  // null: none; pose by pose
  std::size_t count = 0;
};

// `given` is (bones, vertices, morph_weights), each an array or None; or it is None: there are no poses.
SkinPoses skin_poses_of(const LoadedModel& model, PyObject* given);
Pose pose_of(const LoadedModel& model, const SkinPoses& poses, std::size_t i);

// The limits that sc_rule has from its second field on.
std::vector<float> default_rule();
Rule rule_of(const std::vector<float>& limits);

// The methods of Model, but those of module.cpp.
extern const std::vector<PyMethodDef> question_methods, loss_methods;
void add_response(PyObject* module);

}  // namespace spherechain::python

// SPDX-License-Identifier: MIT
// A model with the bodies that are kept from call to call, and arrays about it. Sizes are checked here, so that nothing
// reads out of bounds; spherechain/_model.py checks what people pass, and says it in their words.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "runtime/src/skin/skin_table.h"
#include "spherechain/spherechain.h"

namespace spherechain::python {

namespace py = pybind11;

template <typename T>
using Array = py::array_t<T>;  // of any strides

// These throw std::invalid_argument, which Python sees as ValueError: "pose.bones: too small".
void require(const Status& status);
void require(bool is_so, const char* name);

// An array in C order of exactly this shape.
template <typename T>
T* checked(const Array<T>& array, std::initializer_list<std::size_t> shape, const char* name) {
  bool is_so = static_cast<std::size_t>(array.ndim()) == shape.size() && (array.flags() & py::array::c_style) != 0;
  py::ssize_t axis = 0;
  for (const std::size_t size : shape) {
    is_so = is_so && static_cast<std::size_t>(array.shape(axis++)) == size;
  }
  require(is_so, name);
  return const_cast<T*>(array.data());
}

template <typename T>
Array<T> make(std::initializer_list<std::size_t> shape) {
  return Array<T>(std::vector<py::ssize_t>(shape.begin(), shape.end()));
}

template <typename T>
std::size_t length(const Array<T>& array) {
  return array.ndim() > 0 ? static_cast<std::size_t>(array.shape(0)) : 0;
}

using Joint = std::pair<std::string, std::optional<Array<float>>>;  // its name, and its inverse bind matrix, 3 by 4

// Threads may call everything at once.
class LoadedModel {
 public:
  // Throws std::invalid_argument with the sentence of sc_create_model().
  LoadedModel(const std::string& bytes, const std::optional<std::vector<Joint>>& joints);

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
  constexpr py::ssize_t kSize = sizeof(T);
  require(bones.ndim() == 4 && bones.shape(2) == 3 && bones.shape(3) == 4 && bones.shape(1) > 0 &&
              static_cast<std::size_t>(bones.shape(1)) == bone_count,
          "bones");
  const bool lies_well = bones.strides(3) == kSize && bones.strides(2) == 4 * kSize && bones.strides(1) >= 12 * kSize &&
                         bones.strides(1) % kSize == 0 && bones.strides(0) >= 0 && bones.strides(0) % kSize == 0;
  require(lies_well || bones.size() == 0, "bones");
  return {bones.data(), length(bones), static_cast<std::size_t>(bones.strides(0)) / kSize,
          static_cast<std::size_t>(bones.strides(1)) / kSize};
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
SkinPoses skin_poses_of(const LoadedModel& model, const py::object& given);
Pose pose_of(const LoadedModel& model, const SkinPoses& poses, std::size_t i);

// The limits that sc_rule has from its second field on.
std::vector<float> default_rule();
Rule rule_of(const std::vector<float>& limits);

void define_questions(py::class_<LoadedModel>& model);
void define_losses(py::class_<LoadedModel>& model);
void define_response(py::module_& module);

}  // namespace spherechain::python

// SPDX-License-Identifier: MIT
#include "model.h"

#include <algorithm>
#include <array>
#include <new>
#include <stdexcept>

#include "runtime/src/bodies/model.h"
#include "runtime/src/clusters/set_up.h"

namespace spherechain::python {

void require(const Status& status) {
  if (status.code == SC_NO_MEMORY) {
    throw std::bad_alloc();
  }
  if (status != SC_OK) {
    throw std::invalid_argument(std::string(sc_field_name(status.field)) + ": " + sc_code_text(status.code));
  }
}

void require(bool is_so, const char* name) {
  if (!is_so) {
    throw std::invalid_argument(std::string(name) + ": another shape, order or number than the model has");
  }
}

LoadedModel::LoadedModel(const Bytes& asset, const std::optional<std::vector<Joint>>& joints) {
  std::vector<Bone> bones(1);  // not empty: null joints are none
  for (std::size_t i = 0; joints && i < joints->size(); ++i) {
    const auto& [name, inverse_bind] = (*joints)[i];
    bones.insert(bones.end() - 1, {name.c_str(), inverse_bind ? checked(*inverse_bind, {3, 4}, "joints") : nullptr});
  }
  model_ = Model(asset.data.data(), asset.data.size(), joints ? bones.data() : nullptr, bones.size() - 1, SC_ROWS_3X4);
  if (!model_) {
    throw std::invalid_argument(model_.message());
  }
  info_ = model_.info();
  joint_count_ = joints ? joints->size() : info_.bone_count;
}

const std::uint32_t* LoadedModel::joint_of_bone() const { return model_.handle()->joint_of_bone; }

const std::uint64_t* LoadedModel::detect_table(Radius radius) const {
  return radius == SC_RADIUS_DETECT ? model_.handle()->detect_table : nullptr;
}

Surface LoadedModel::surface() const {
  Surface surface;
  require(has_skin(view()) ? read_skin_table(view(), model_.handle()->skin_table, surface)
                           : Status{SC_NOT_IN_ASSET, SC_FIELD_ASSET});
  return surface;
}

const std::vector<float>& LoadedModel::pair_scales(Radius radius) const {
  const std::lock_guard lock(mutex_);
  const std::size_t n = info_.sphere_count;
  std::vector<float>& scales = pair_scales_[radius == SC_RADIUS_FIT ? 1 : 0];
  if (!scales.empty()) {
    return scales;
  }
  scales.resize(n * n);
  const auto set = [&](std::size_t a, std::size_t b, float scale) { scales[a * n + b] = scales[b * n + a] = scale; };
  for (std::size_t b = 1, bit = 0; b < n; ++b) {
    for (std::size_t a = 0; a < b; ++a, ++bit) {
      set(a, b, (view().ignored()[bit / 64] >> bit % 64 & 1) == 0 ? 1.0F : 0.0F);
    }
  }
  for (const RestPair& pair : view().rest_pairs(radius)) {
    set(pair.a, pair.b, pair.rest_scale * scales[pair.a * n + pair.b]);
  }
  return scales;
}

Body LoadedModel::take_body(const LoadedModel& other, bool finds_steps, std::size_t max_triangles) const {
  if (&other == this && !finds_steps && max_triangles == 0) {
    const std::lock_guard lock(mutex_);
    if (!spare_.empty()) {
      Body body = std::move(spare_.back());
      spare_.pop_back();
      return body;
    }
  }
  BodyDef def;
  def.max_triangles = max_triangles;
  def.max_penetrations =
      std::max<std::size_t>(1, info_.part_count * std::max(info_.part_count, other.info_.part_count));
  def.largest_other = other.model_.handle();
  def.finds_steps = finds_steps ? 1 : 0;
  Body body(model_, def);
  require(body.status());
  return body;
}

void LoadedModel::give_back(Body body) const {
  const std::lock_guard lock(mutex_);
  spare_.push_back(std::move(body));
}

SkinPoses skin_poses_of(const LoadedModel& model, PyObject* given) {
  SkinPoses out;
  if (given == Py_None) {
    return out;
  }
  const auto [bones, vertices, morph_weights] = From<std::array<std::optional<Array<float>>, 3>>::get(given);
  require(bones || vertices, "bones");
  out.kept = bones ? *bones : *vertices;
  out.count = length(out.kept);
  if (bones) {
    out.bones = poses_of(model.joint_count(), out.kept);
  } else {
    out.vertices = checked(out.kept, {out.count, model.info().vertex_count, 3}, "vertices");
  }
  out.morph_weights = morphs_of(model, morph_weights, out.count);
  return out;
}

Pose pose_of(const LoadedModel& model, const SkinPoses& poses, std::size_t i) {
  const AssetInfo& info = model.info();
  Pose pose;
  if (poses.vertices == nullptr) {
    pose = pose_of(poses.bones, model.joint_count(), i);
  } else {
    pose.vertices = poses.vertices + 3 * i * info.vertex_count;
    pose.vertex_count = info.vertex_count;
  }
  if (poses.morph_weights != nullptr) {
    pose.morph_weights = poses.morph_weights + i * info.morph_count;
    pose.morph_weight_count = info.morph_count;
  }
  return pose;
}

std::vector<float> default_rule() {
  const Rule rule = sc_default_rule();
  return {&rule.touch_depth, &rule.inside + 1};
}

Rule rule_of(const std::vector<float>& limits) {
  Rule rule = sc_default_rule();
  require(limits.size() == default_rule().size(), "rule");
  std::copy(limits.begin(), limits.end(), &rule.touch_depth);
  return rule;
}

}  // namespace spherechain::python

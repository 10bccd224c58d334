// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/fbx_joint.h"

#include <algorithm>

namespace spherechain::baker {
namespace {

Vec3 vector_of(const FbxObject& model, const std::string& name, const std::array<double, 3>& otherwise = {}) {
  return Vec3(model.value(name, otherwise).data());
}

Eigen::Index index_of(std::size_t axis) { return static_cast<Eigen::Index>(axis); }

}  // namespace

JointAngles::JointAngles(const FbxObject& model) {
  const std::array<int, 3> order = rotation_order(model);
  axes_ = {order[2], order[1], order[0]};
  constexpr EulerAxes kXyz{2, 1, 0};
  const auto turn = [&](const char* name) { return rotation_by(kXyz, vector_of(model, name).reverse()); };
  before_ = turn("PreRotation");
  // Scales that mirror are read as positive ones and half a turn.
  const Vec3 scale = vector_of(model, "Lcl Scaling", {1, 1, 1}), pivot = vector_of(model, "ScalingPivot");
  Vec3 signs = scale.unaryExpr([](double s) { return s < 0 ? -1.0 : 1.0; });
  signs *= signs.prod();
  after_ = turn("PostRotation").conjugate() * Eigen::Quaterniond(Eigen::Matrix3d(signs.asDiagonal()));
  arm_ = signs.cwiseProduct(vector_of(model, "ScalingOffset") + pivot - scale.cwiseProduct(pivot) -
                            vector_of(model, "RotationPivot"));
}

Eigen::Quaterniond JointAngles::rotation(const Vec3& degrees) const {
  return before_ * rotation_by(axes_, ordered(degrees)) * after_;
}

Vec3 JointAngles::degrees(const Eigen::Quaterniond& rotation, const Vec3& near) const {
  const Vec3 angles = angles_near(before_.conjugate() * rotation * after_.conjugate(), axes_, ordered(near));
  Vec3 out;
  for (std::size_t k = 0; k < 3; ++k) out[axes_[k]] = angles[index_of(k)];
  return out;
}

AnimatedProperty::AnimatedProperty(const FbxFile& fbx, const FbxAnimation& animation, const FbxObject& model,
                                   const std::string& name, const std::string& file)
    : model_(model), name_(name), track_(animation.track_of(model, name)), still_(vector_of(model, name)) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (const FbxObject* const curve = track_.curves[axis]) {
      before_.emplace_back(fbx.tree, *curve->record, file + ": a curve of the joint '" + std::string(model.name) + "'");
    } else {
      before_.emplace_back(fbx.tree);
    }
    double& still = still_[index_of(axis)];
    if (track_.has_curves()) still = track_.node->value(std::string("d|") + "XYZ" [axis], { still })[0];
  }
  after_ = before_;
}

Vec3 AnimatedProperty::at(std::int64_t tick, const Vec3& still) const {
  Vec3 out = still;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!before_[axis].is_empty()) out[index_of(axis)] = before_[axis].at(tick);
  }
  return out;
}

std::set<std::int64_t> AnimatedProperty::ticks() const {
  std::set<std::int64_t> out;
  for (const FbxCurve& curve : before_) {
    for (const std::int64_t tick : curve.ticks()) out.insert(tick);
  }
  return out;
}

bool AnimatedProperty::is_key_of_all(std::int64_t tick) const {
  return std::all_of(before_.begin(), before_.end(),
                     [&](const FbxCurve& curve) { return curve.is_empty() || curve.has(tick); });
}

void AnimatedProperty::set(std::int64_t tick, const Vec3& value, bool changes) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!changes && before_[axis].has(tick))
      after_[axis].make_linear(tick);
    else
      after_[axis].set(tick, value[index_of(axis)]);
  }
}

void AnimatedProperty::lead(std::int64_t first, std::int64_t last) {
  const std::set<std::int64_t> all = ticks();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const FbxCurve& curve = before_[axis];
    // The keys beside; of a curve without keys those of the others, for it is still up to there.
    const auto beside = [&](bool is_left) -> std::optional<std::int64_t> {
      if (!curve.is_empty()) return is_left ? curve.before(first) : curve.after(last);
      const auto found = is_left ? all.lower_bound(first) : all.upper_bound(last);
      if (found == (is_left ? all.begin() : all.end())) return {};
      return is_left ? *std::prev(found) : *found;
    };
    const std::optional<std::int64_t> left = beside(true), right = beside(false);
    for (const std::int64_t tick : all) {
      const bool is_left = left && tick >= *left && tick < first, is_right = right && tick <= *right && tick > last;
      if ((is_left || is_right) && !curve.has(tick)) after_[axis].set(tick, at(tick)[index_of(axis)]);
    }
    if (left && curve.has(*left)) after_[axis].make_linear(*left);
  }
}

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/fbx_curves.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <string>

namespace spherechain::baker {
namespace {

// The axes without a curve have a value; the others have none.
using Constants = std::array<std::optional<double>, 3>;

// An angle about each axis, which turn in this order.
Eigen::Quaterniond turn_by(const std::array<int, 3>& order, const Eigen::Vector3d& angles) {
  Eigen::Quaterniond out = Eigen::Quaterniond::Identity();
  for (const int axis : order) out = Eigen::AngleAxisd(angles[axis], Eigen::Vector3d::Unit(axis)) * out;
  return out;
}

// The angles about x, y and z of a turn for which those without a curve are 0.
Eigen::Vector3d angles_of(const std::array<int, 3>& order, const Eigen::Quaterniond& turn, const Constants& constants) {
  const Eigen::Matrix3d m = turn.toRotationMatrix();
  const auto [first, second, third] = order;
  const double sign = (first + 1) % 3 == second ? 1 : -1;
  const auto miss = [&](const Eigen::Vector3d& angles) {
    double sum = 0;
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      sum += constants[static_cast<std::size_t>(axis)] ? std::abs(std::sin(angles[axis] / 2)) : 0;
    return sum;
  };
  Eigen::Vector3d a;
  const double sine = std::clamp(-sign * m(third, first), -1.0, 1.0);
  constexpr double kLocked = 1 - 1e-7;
  if (std::abs(sine) > kLocked) {  // the first and the last turn about one axis
    Eigen::Vector3d other;
    a[second] = other[second] = std::asin(sine);
    a[first] = other[third] = 0;
    a[third] = std::atan2(-sign * m(first, second), m(second, second));
    const Eigen::Matrix3d rest = Eigen::AngleAxisd(-a[second], Eigen::Vector3d::Unit(second)).toRotationMatrix() * m;
    other[first] = std::atan2(rest((first + 2) % 3, (first + 1) % 3), rest((first + 1) % 3, (first + 1) % 3));
    return miss(a) <= miss(other) ? a : other;
  }
  a[second] = std::asin(sine);
  a[first] = std::atan2(sign * m(third, second), m(third, third));
  a[third] = std::atan2(sign * m(second, first), m(first, first));
  Eigen::Vector3d other = a;  // the same turn by other angles
  other[first] += std::numbers::pi;
  other[second] = std::numbers::pi - a[second];
  other[third] += std::numbers::pi;
  return miss(a) <= miss(other) ? a : other;
}

void complete(aiNodeAnim& keys, const std::string& property, const FbxObject& model, const Constants& constants) {
  const auto put = [&](aiVectorKey* key, unsigned count) {
    for (unsigned k = 0; k < count; ++k) {
      for (unsigned axis = 0; axis < 3; ++axis)
        if (constants[axis]) key[k].mValue[axis] = static_cast<ai_real>(*constants[axis]);
    }
  };
  if (property == "Lcl Translation") return put(keys.mPositionKeys, keys.mNumPositionKeys);
  if (property == "Lcl Scaling") return put(keys.mScalingKeys, keys.mNumScalingKeys);
  const std::array<int, 3> order = rotation_order(model);
  for (unsigned k = 0; k < keys.mNumRotationKeys; ++k) {
    aiQuaternion& q = keys.mRotationKeys[k].mValue;
    Eigen::Vector3d angles = angles_of(order, Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized(), constants);
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      if (const auto& degrees = constants[static_cast<std::size_t>(axis)])
        angles[axis] = *degrees * std::numbers::pi / 180;
    }
    const Eigen::Quaterniond turn = turn_by(order, angles);
    q = aiQuaternion(static_cast<ai_real>(turn.w()), static_cast<ai_real>(turn.x()), static_cast<ai_real>(turn.y()),
                     static_cast<ai_real>(turn.z()));
  }
}

}  // namespace

void complete_curves(aiScene& scene, const FbxFile& file) {
  std::map<std::int64_t, const FbxObject*> models, curve_nodes, stacks;
  for (const FbxObject& object : file.objects) {
    if (object.kind == FbxKind::kModel) models.emplace(object.id, &object);
    if (object.kind == FbxKind::kCurveNode) curve_nodes.emplace(object.id, &object);
    if (object.kind == FbxKind::kStack) stacks.emplace(object.id, &object);
  }
  std::map<std::int64_t, std::set<std::string>> curves;  // "d|X" ... of each curve node
  std::multimap<std::int64_t, std::int64_t> above;       // curve node -> layer -> stack
  for (const FbxLink& link : file.links) {
    if (!link.property.empty())
      curves[link.parent].insert(link.property);
    else
      above.emplace(link.child, link.parent);
  }
  const auto stack_of = [&](std::int64_t node) -> std::string {
    const auto layers = above.equal_range(node);
    for (auto layer = layers.first; layer != layers.second; ++layer) {
      const auto found = above.equal_range(layer->second);
      for (auto stack = found.first; stack != found.second; ++stack)
        if (stacks.count(stack->second) > 0) return std::string(stacks.at(stack->second)->name);
    }
    return {};
  };
  const std::map<std::string, std::string> suffixes{{"Lcl Translation", "_$AssimpFbx$_Translation"},
                                                    {"Lcl Rotation", "_$AssimpFbx$_Rotation"},
                                                    {"Lcl Scaling", "_$AssimpFbx$_Scaling"}};
  struct Incomplete {
    std::string property;
    const FbxObject* model;
    Constants constants;
  };
  std::map<std::pair<std::string, std::string>, Incomplete> incomplete;  // by the scene's names of stack and node
  for (const FbxLink& link : file.links) {
    const auto model = models.find(link.parent), node = curve_nodes.find(link.child);
    const auto suffix = suffixes.find(link.property);
    if (model == models.end() || node == curve_nodes.end() || suffix == suffixes.end()) continue;
    Constants constants;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::string name = std::string("d|") + "XYZ"[axis];
      const auto &own = node->second->values, &rest = model->second->values;
      if (curves[link.child].count(name) > 0) continue;
      if (own.count(name) > 0)
        constants[axis] = own.at(name)[0];
      else if (rest.count(link.property) > 0)
        constants[axis] = rest.at(link.property)[axis];
    }
    incomplete.insert({{stack_of(link.child), std::string(model->second->name) + suffix->second},
                       {link.property, model->second, constants}});
  }
  for (unsigned a = 0; a < scene.mNumAnimations; ++a) {
    const aiAnimation& animation = *scene.mAnimations[a];
    for (unsigned c = 0; c < animation.mNumChannels; ++c) {
      const auto found = incomplete.find({animation.mName.C_Str(), animation.mChannels[c]->mNodeName.C_Str()});
      if (found == incomplete.end()) continue;
      const Constants& constants = found->second.constants;
      if (std::any_of(constants.begin(), constants.end(), [](const auto& value) { return value.has_value(); }))
        complete(*animation.mChannels[c], found->second.property, *found->second.model, constants);
    }
  }
}

}  // namespace spherechain::baker

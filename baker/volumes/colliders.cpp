// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/volumes/colliders.h"

#include <algorithm>

#include "baker/mesh/decompose.h"

namespace spherechain::baker {
namespace {

bool any_overlap(const ColliderBody& a, const Eigen::Isometry3d& a_at, const ColliderBody& b,
                 const Eigen::Isometry3d& b_at) {
  return std::any_of(a.volumes.begin(), a.volumes.end(), [&](const Volume& one) {
    return std::any_of(b.volumes.begin(), b.volumes.end(),
                       [&](const Volume& other) { return overlap(one, a_at, other, b_at); });
  });
}

}  // namespace

Eigen::Quaterniond to_z_up(const Colliders& colliders) {
  Eigen::Matrix3d axes;
  axes << colliders.forward, colliders.left, colliders.up;
  return Eigen::Quaterniond(Eigen::Matrix3d(axes.transpose()));
}

Eigen::Isometry3d rest_in_parent(const Colliders& colliders, std::size_t body) {
  const ColliderBody& one = colliders.bodies[body];
  if (one.parent < 0) return one.rest;
  return colliders.bodies[static_cast<std::size_t>(one.parent)].rest.inverse(Eigen::Isometry) * one.rest;
}

Eigen::Isometry3d rigid_part(const Affine& of) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  out.linear() = turn_in(of.linear());  // of a mirrored bone: as near as it gets
  out.translation() = of.translation();
  return out;
}

std::vector<Eigen::Isometry3d> posed(const Colliders& colliders, const std::vector<Affine>& bones) {
  std::vector<Eigen::Isometry3d> out;
  for (const ColliderBody& body : colliders.bodies) {
    if (body.bone_index < 0 || static_cast<std::size_t>(body.bone_index) >= bones.size()) {
      out.push_back(body.rest);
      continue;
    }
    Affine bone = bones[static_cast<std::size_t>(body.bone_index)];
    bone.translation() *= colliders.metres_per_unit;
    out.push_back(rigid_part(bone * Affine(body.rest)));
  }
  return out;
}

std::vector<std::pair<int, int>> overlapping(const Colliders& colliders, const std::vector<Eigen::Isometry3d>& at) {
  std::vector<std::pair<int, int>> out;
  auto skipped = colliders.ignored.begin();
  const int count = static_cast<int>(colliders.bodies.size());
  for (int a = 0; a < count; ++a) {
    for (int b = a + 1; b < count; ++b) {
      if (skipped != colliders.ignored.end() && skipped->a == a && skipped->b == b) {
        ++skipped;
        continue;
      }
      const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
      if (any_overlap(colliders.bodies[i], at[i], colliders.bodies[j], at[j])) out.emplace_back(a, b);
    }
  }
  return out;
}

}  // namespace spherechain::baker

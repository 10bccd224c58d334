// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/play/bone_joints.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "baker/play/asset_file.h"

namespace spherechain::baker {
namespace {

// For each of the asset's bones the nearest one above it; -1: no bone.
std::vector<int> bone_parents(const AnimatedAsset& animated) {
  const OpenAsset& asset = animated.asset();
  const SourceRig& rig = animated.character().rig;
  std::vector<int> out(asset->bone_count(), -1);
  if (rig.bones.empty()) {
    for (std::size_t b = 0; b < std::min(out.size(), asset->joint_count()); ++b) {
      if (std::string(asset->joint(b).name) == asset->bone(b).name) out[b] = asset->joint(b).parent;
    }
    return out;
  }
  std::vector<int> bone_of(rig.nodes.size(), -1);
  for (std::size_t b = rig.bones.size(); b-- > 0;) bone_of[rig.bones[b].node] = static_cast<int>(b);
  std::vector<int> above(rig.nodes.size(), -1);  // a node's nearest bone above
  for (std::size_t n = 0; n < rig.nodes.size(); ++n) {
    if (rig.nodes[n].parent < 0) continue;
    const auto parent = static_cast<std::size_t>(rig.nodes[n].parent);
    above[n] = bone_of[parent] >= 0 ? bone_of[parent] : above[parent];
  }
  for (std::size_t b = 0; b < std::min(out.size(), rig.bones.size()); ++b) {
    // A node that several skins bind differently has several bones: the others hang on the first.
    const int first = bone_of[rig.bones[b].node];
    out[b] = first < static_cast<int>(b) ? first : above[rig.bones[b].node];
  }
  return out;
}

// How many are above each; a parent may come after its children.
std::vector<std::size_t> depths_of(const std::vector<int>& parents) {
  std::vector<std::size_t> depths(parents.size(), 0), way;
  std::vector<bool> is_known(parents.size(), false);
  for (std::size_t b = 0; b < parents.size(); ++b) {
    for (int up = static_cast<int>(b); up >= 0 && !is_known[static_cast<std::size_t>(up)];
         up = parents[static_cast<std::size_t>(up)]) {
      way.push_back(static_cast<std::size_t>(up));
    }
    for (; !way.empty(); way.pop_back()) {
      const int parent = parents[way.back()];
      depths[way.back()] = parent < 0 ? 0 : depths[static_cast<std::size_t>(parent)] + 1;
      is_known[way.back()] = true;
    }
  }
  return depths;
}

Affine affine_of(const float* rows) {
  Affine out;
  for (Eigen::Index i = 0; i < 12; ++i) out(i / 4, i % 4) = double{rows[i]};
  return out;
}

sc_transform transform_of(const Affine& local) {
  Node node;
  node.local = local;
  decompose(node);
  const auto to_float = [](const Vec3& v) {
    return spherechain::Vec3{static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
  };
  const Eigen::Quaterniond& q = node.rotation;
  return {to_float(node.translation),
          {static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z()), static_cast<float>(q.w())},
          to_float(node.scale)};
}

bool is_sheared(const Affine& local) {
  const Eigen::Matrix3d gram = local.linear().transpose() * local.linear();
  const Vec3 sizes = gram.diagonal().cwiseSqrt();
  const auto share = [&](Eigen::Index i, Eigen::Index j) { return std::abs(gram(i, j)) / (sizes[i] * sizes[j]); };
  return !(std::max({share(0, 1), share(1, 2), share(2, 0)}) < 1e-4);
}

}  // namespace

BoneJoints::BoneJoints(const AnimatedAsset& animated) {
  const OpenAsset& asset = animated.asset();
  const std::vector<int> parents = bone_parents(animated);
  const std::vector<std::size_t> depths = depths_of(parents);
  for (std::size_t b = 0; b < parents.size(); ++b) {
    binds_.push_back(asset->bone(b).is_rest ? Affine::Identity() : affine_of(asset->bone(b).inverse_bind).inverse());
    order_.push_back(b);
  }
  std::stable_sort(order_.begin(), order_.end(), [&](auto l, auto r) { return depths[l] < depths[r]; });
  joint_of_bone_.resize(order_.size());
  for (std::size_t i = 0; i < order_.size(); ++i) joint_of_bone_[order_[i]] = static_cast<std::uint32_t>(i);
  for (const std::size_t b : order_) {
    parents_.push_back(parents[b] < 0 ? SC_NO_JOINT : joint_of_bone_[static_cast<std::size_t>(parents[b])]);
  }
}

std::vector<sc_transform> BoneJoints::joints_of(const Deformation& deformation) const {
  std::vector<sc_transform> out;
  for (std::size_t i = 0; i < order_.size(); ++i) {
    const std::uint32_t parent = parents_[i];
    const Affine own = world(deformation, order_[i]),
                 local = parent == SC_NO_JOINT ? own : Affine(world(deformation, order_[parent]).inverse() * own);
    if (is_sheared(local)) return {};
    out.push_back(transform_of(local));
  }
  return out;
}

std::vector<Affine> BoneJoints::bones_of(const std::vector<sc_transform>& joints) const {
  std::vector<Affine> world, out(order_.size());
  for (std::size_t i = 0; i < order_.size(); ++i) {
    const auto& [t, q, s] = joints[i];
    const Affine local = Eigen::Translation3d(t.x, t.y, t.z) * Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized() *
                         Eigen::AlignedScaling3d(s.x, s.y, s.z);
    world.push_back(parents_[i] == SC_NO_JOINT ? local : Affine(world[parents_[i]] * local));
    out[order_[i]] = world[i] * binds_[order_[i]].inverse();
  }
  return out;
}

}  // namespace spherechain::baker

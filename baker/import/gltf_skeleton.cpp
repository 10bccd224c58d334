// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/gltf_skeleton.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "baker/import/one_space.h"

namespace spherechain::baker {
namespace {

// Tolerance for equal transforms. Exporters invert their matrices in single precision.
constexpr double kSame = 1e-5;

bool invertible(const Affine& a) {
  const double size = a.linear().cwiseAbs().maxCoeff();
  return size > 0 && std::abs(a.linear().determinant()) > 1e-12 * size * size * size;
}

bool same(const Affine& a, const Affine& b, double extent) {
  const double scale = a.linear().cwiseAbs().maxCoeff();
  return (a.linear() - b.linear()).cwiseAbs().maxCoeff() <= kSame * scale &&
         (a.translation() - b.translation()).cwiseAbs().maxCoeff() <= kSame * scale * extent;
}

// Column by column, as the format stores matrices.
Affine affine(const GltfFile& file, const double* m, const std::string& where) {
  constexpr double kTolerance = 1e-3;
  if (std::abs(m[3]) + std::abs(m[7]) + std::abs(m[11]) + std::abs(m[15] - 1) > kTolerance) {
    file.fail(where + " is not an affine transform (its last row is not 0 0 0 1)");
  }
  Affine out;
  for (Eigen::Index column = 0; column < 4; ++column) {
    for (Eigen::Index row = 0; row < 3; ++row) out.matrix()(row, column) = m[4 * column + row];
  }
  return out;
}

Node read_node(const GltfFile& file, const tinygltf::Node& in, const std::string& where) {
  Node node;
  node.name = in.name;
  if (in.extras.Has("humanoid")) node.humanoid_bone = in.extras.Get("humanoid").Get<std::string>();
  if (!in.matrix.empty()) {
    node.local = affine(file, in.matrix.data(), where + ".matrix");
    decompose(node);
    return node;
  }
  if (!in.translation.empty()) node.translation = Vec3(in.translation.data());
  if (!in.scale.empty()) node.scale = Vec3(in.scale.data());
  if (!in.rotation.empty()) {
    const Eigen::Quaterniond q(in.rotation[3], in.rotation[0], in.rotation[1], in.rotation[2]);
    if (q.norm() > 0) node.rotation = q.normalized();
  }
  node.local.linear() = node.rotation.toRotationMatrix() * node.scale.asDiagonal();
  node.local.translation() = node.translation;
  return node;
}

// The file's node indices, parents before children, children in order after their parent.
std::vector<int> parents_first(const GltfFile& file, std::vector<int>& parent) {
  const std::vector<tinygltf::Node>& nodes = file.model.nodes;
  parent.assign(nodes.size(), -1);
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    for (const int child : nodes[n].children) {
      if (parent[at(child)] >= 0) file.fail("nodes[" + std::to_string(child) + "] has two parents");
      parent[at(child)] = static_cast<int>(n);
    }
  }
  std::vector<int> order, open;
  for (std::size_t root = nodes.size(); root-- > 0;) {
    if (parent[root] < 0) open.push_back(static_cast<int>(root));
  }
  while (!open.empty()) {
    const int n = open.back();
    open.pop_back();
    order.push_back(n);
    const std::vector<int>& children = nodes[at(n)].children;
    open.insert(open.end(), children.rbegin(), children.rend());
  }
  if (order.size() < nodes.size()) {  // what no root leads to goes in circles
    std::vector<bool> reached(nodes.size(), false);
    for (const int n : order) reached[at(n)] = true;
    const auto lost = std::find(reached.begin(), reached.end(), false) - reached.begin();
    file.fail("nodes[" + std::to_string(lost) + "] is its own ancestor");
  }
  return order;
}

}  // namespace

GltfNodes read_nodes(const GltfFile& file) {
  const tinygltf::Model& model = file.model;
  GltfNodes out;
  std::vector<int> parent;
  const std::vector<int> order = parents_first(file, parent);
  out.of_file.assign(model.nodes.size(), kNoIndex);
  for (const int n : order) {
    const std::string where = "nodes[" + std::to_string(n) + "]";
    Node node = read_node(file, model.nodes[at(n)], where);
    node.in_file = n;
    Affine world = node.local;
    if (parent[at(n)] >= 0) {
      node.parent = static_cast<int>(out.of_file[at(parent[at(n)])]);
      world = out.world[at(node.parent)] * node.local;
    }
    if (!world.matrix().allFinite()) file.fail(where + " has a transform too large for numbers");
    out.of_file[at(n)] = static_cast<Index>(out.nodes.size());
    out.nodes.push_back(std::move(node));
    out.world.push_back(world);
  }
  // Without a scene all is shown.
  out.in_scene.assign(model.nodes.size(), model.scenes.empty());
  if (!model.scenes.empty()) {
    for (const int n : model.scenes[at(std::max(model.defaultScene, 0))].nodes) out.in_scene[at(n)] = true;
    for (const int n : order) {
      if (parent[at(n)] >= 0 && out.in_scene[at(parent[at(n)])]) out.in_scene[at(n)] = true;
    }
  }
  return out;
}

GltfSkeleton::GltfSkeleton(const GltfFile& file, const GltfNodes& nodes, const std::vector<UsedSkin>& used)
    : file_(file), nodes_(nodes), bones_of_node_(nodes.nodes.size()), joint_above_(nodes.nodes.size(), kNoIndex) {
  if (used.empty()) return;
  skins_.resize(file.model.skins.size());
  for (const UsedSkin& s : used) skins_[at(s.index)] = read_skin(at(s.index));

  const GltfSkin& lead = *skins_[at(used.front().index)];
  world_to_rest_ = rest_to_world(used.front()).inverse();
  Eigen::AlignedBox3d joints;
  std::vector<Index> lead_joint(nodes.nodes.size(), kNoIndex);  // node -> joint of the leading skin
  for (Index j = 0; j < lead.joints.size(); ++j) {
    if (!invertible(lead.inverse_bind[j])) continue;
    lead_joint[lead.joints[j]] = j;
    joints.extend(Vec3(lead.inverse_bind[j].inverse().translation()));
  }
  extent_ = joints.isEmpty() ? 0 : joints.diagonal().norm();

  for (const UsedSkin& s : used) {
    find_to_rest(s, lead, lead_joint);
    GltfSkin& skin = *skins_[at(s.index)];
    const Affine from_rest = skin.to_rest.inverse();
    for (std::size_t j = 0; j < skin.joints.size(); ++j) {
      skin.bones.push_back(bone(skin.joints[j], skin.inverse_bind[j] * from_rest));
      joint_above_[skin.joints[j]] = skin.joints[j];
    }
  }
  for (Index n = 0; n < nodes.nodes.size(); ++n) {
    const int parent = nodes.nodes[n].parent;
    if (joint_above_[n] == kNoIndex && parent >= 0) joint_above_[n] = joint_above_[at(parent)];
  }
}

GltfSkin GltfSkeleton::read_skin(std::size_t index) const {
  const tinygltf::Skin& in = file_.model.skins[index];
  const std::string where = "skins[" + std::to_string(index) + "].inverseBindMatrices";
  GltfSkin skin;
  for (const int joint : in.joints) skin.joints.push_back(nodes_.of_file[at(joint)]);
  skin.inverse_bind.assign(skin.joints.size(), Affine::Identity());
  if (in.inverseBindMatrices < 0) return skin;
  const std::vector<double> matrices =
      file_.numbers(in.inverseBindMatrices, TINYGLTF_TYPE_MAT4, {TINYGLTF_COMPONENT_TYPE_FLOAT});
  if (matrices.size() < 16 * skin.joints.size()) {
    file_.fail(where + " has " + std::to_string(matrices.size() / 16) + " matrices for " +
               std::to_string(skin.joints.size()) + " joints");
  }
  for (std::size_t j = 0; j < skin.joints.size(); ++j) {
    skin.inverse_bind[j] = affine(file_, &matrices[16 * j], where + "[" + std::to_string(j) + "]");
  }
  return skin;
}

// The map that a skin's joints have when the nodes are at rest.
Affine GltfSkeleton::rest_to_world(const UsedSkin& used) const {
  const GltfSkin& skin = *skins_[at(used.index)];
  std::vector<std::size_t> order(skin.joints.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return skin.joints[a] < skin.joints[b]; });
  std::vector<Affine> maps;
  std::vector<double> weights;
  for (const std::size_t j : order) {
    if (!invertible(nodes_.world[skin.joints[j]]) || !invertible(skin.inverse_bind[j])) continue;
    const Affine map = nodes_.world[skin.joints[j]] * skin.inverse_bind[j];
    if (!map.matrix().allFinite()) continue;
    maps.push_back(map);
    weights.push_back(used.weights[j]);
  }
  if (maps.empty())
    file_.fail("skins[" + std::to_string(used.index) + "] has no joint with a size, both at rest and when bound");
  return maps[typical_map(maps, weights)];
}

// A joint that two skins share is at one place for both when they are bound. Without one, all skins may be in one
// space; or else at rest must do.
void GltfSkeleton::find_to_rest(const UsedSkin& used, const GltfSkin& lead, const std::vector<Index>& lead_joint) {
  GltfSkin& skin = *skins_[at(used.index)];
  std::optional<Affine> to_rest;
  for (std::size_t j = 0; j < skin.joints.size() && !to_rest; ++j) {
    const Index shared = lead_joint[skin.joints[j]];
    if (shared == kNoIndex || !invertible(skin.inverse_bind[j])) continue;
    to_rest = lead.inverse_bind[shared].inverse() * skin.inverse_bind[j];
  }
  if (!to_rest) {
    std::vector<BoundJoint> bound;
    for (std::size_t k = 0, number = 0; k < skins_.size(); ++k) {
      for (std::size_t j = 0; skins_[k] && j < skins_[k]->joints.size(); ++j)
        bound.push_back({skins_[k]->joints[j], number, skins_[k]->inverse_bind[j].inverse()});
      if (skins_[k]) ++number;
    }
    if (were_bound_in_one_space(nodes_.nodes, bound))
      to_rest = Affine::Identity();
    else
      to_rest = world_to_rest_ * rest_to_world(used);
  }
  // Exactly nothing where it is nothing but rounding: then the rest pose is the file's own vertex buffer.
  skin.to_rest = same(Affine::Identity(), *to_rest, extent_) ? Affine::Identity() : *to_rest;
}

Index GltfSkeleton::bone(Index node, const Affine& inverse_bind) {
  for (const Index b : bones_of_node_[node]) {
    if (same(bones_[b].inverse_bind, inverse_bind, extent_)) return b;
  }
  bones_of_node_[node].push_back(static_cast<Index>(bones_.size()));
  bones_.push_back({node, inverse_bind});
  return bones_of_node_[node].back();
}

GltfSkeleton::Rigid GltfSkeleton::rigid(Index node) {
  Rigid out{world_to_rest_ * nodes_.world[node], {}};
  if (const Index joint = joint_above(node); joint != kNoIndex) {
    const Affine& inverse_bind = bones_[bones_of_node_[joint].front()].inverse_bind;
    if (invertible(inverse_bind) && invertible(nodes_.world[joint])) {
      out.to_rest = inverse_bind.inverse() * nodes_.world[joint].inverse() * nodes_.world[node];
    }
  }
  if (invertible(out.to_rest)) out.bone = bone(node, out.to_rest.inverse());
  return out;
}

}  // namespace spherechain::baker

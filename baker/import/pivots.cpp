// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/pivots.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace spherechain::baker {
namespace {

using Weighted = std::pair<Vec3, double>;  // sum of weights times positions, sum of weights

void add_weighted(Weighted& sum, const Vec3& position, double weight) {
  sum.first += weight * position;
  sum.second += weight;
}

// Whether all joints are bound near one place, or a quarter of them at one, and most of the skin that these move is
// elsewhere. The others may be twists, which some exporters bind well.
bool are_bound_elsewhere(const SourceRig& rig, const std::vector<Vec3>& positions) {
  std::vector<Weighted> moved(rig.bones.size(), {Vec3::Zero(), 0});
  Eigen::AlignedBox3d skin;
  for (std::size_t v = 0; v < rig.weights.size(); ++v) {
    skin.extend(positions[v]);
    for (std::size_t k = 0; k < kMaxInfluences; ++k) {
      const double weight = rig.weights[v].weight[k];
      if (weight > 0) add_weighted(moved[rig.weights[v].joint[k]], positions[v], weight);
    }
  }
  std::vector<std::pair<Vec3, double>> joints;  // their places, and how far from these their skin is
  for (std::size_t b = 0; b < rig.bones.size(); ++b) {
    const Affine& bind = rig.bones[b].inverse_bind;
    if (!(moved[b].second > 0) || !(std::abs(bind.linear().determinant()) > 0)) continue;
    const Vec3 joint = rig.pivots.empty() ? bind.inverse().translation() : rig.pivots[rig.bones[b].node];
    joints.emplace_back(joint, (joint - moved[b].first / moved[b].second).norm());
  }
  constexpr double kNear = 0.15, kAtOne = 1e-4, kAway = 0.2;  // of the skin's size
  constexpr std::size_t kJointsMin = 3;
  const double size = skin.diagonal().norm();
  const auto are_away = [&](std::size_t count, double distances) {
    return count >= kJointsMin && distances > kAway * size * static_cast<double>(count);
  };
  Eigen::AlignedBox3d box;
  double all = 0;
  std::map<std::array<double, 3>, std::pair<std::size_t, double>> at_one;  // how many, and the sum of their distances
  for (const auto& [joint, distance] : joints) {
    box.extend(joint);
    all += distance;
    const Vec3 cell = (joint / (kAtOne * size)).array().round();
    auto& [count, distances] = at_one[{cell.x(), cell.y(), cell.z()}];
    ++count;
    distances += distance;
  }
  if (!box.isEmpty() && box.diagonal().norm() < 2 * kNear * size && are_away(joints.size(), all)) return true;
  return std::any_of(at_one.begin(), at_one.end(), [&](const auto& place) {
    const auto& [count, distances] = place.second;
    return 4 * count >= joints.size() && are_away(count, distances);
  });
}

}  // namespace

std::vector<Affine> places_at_rest(const SourceRig& rig) {
  std::vector<Affine> places(rig.nodes.size());
  std::vector<const Bone*> bone_of(rig.nodes.size(), nullptr);
  for (const Bone& bone : rig.bones) {
    if (bone_of[bone.node] == nullptr && std::abs(bone.inverse_bind.linear().determinant()) > 0)
      bone_of[bone.node] = &bone;
  }
  for (std::size_t n = 0; n < rig.nodes.size(); ++n) {
    const Node& node = rig.nodes[n];
    if (bone_of[n] != nullptr)
      places[n] = bone_of[n]->inverse_bind.inverse();
    else
      places[n] = (node.parent < 0 ? rig.to_rest : places[static_cast<std::size_t>(node.parent)]) * node.local;
  }
  return places;
}

std::vector<Vec3> pivots_of(const SourceRig& rig, const std::vector<Vec3>& positions) {
  if (rig.bones.empty() || rig.weights.size() != positions.size() || !are_bound_elsewhere(rig, positions)) return {};
  const std::size_t n = rig.nodes.size();
  const Weighted none{Vec3::Zero(), 0};
  std::vector<Weighted> own(n, none);
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const VertexWeights& weights = rig.weights[v];
    for (std::size_t k = 0; k < kMaxInfluences; ++k) {
      if (weights.weight[k] > 0) add_weighted(own[rig.bones[weights.joint[k]].node], positions[v], weights.weight[k]);
    }
  }
  std::vector<int> above(n, -1);  // the nearest that moves skin
  for (std::size_t i = 0; i < n; ++i) {
    const int parent = rig.nodes[i].parent;
    if (parent >= 0)
      above[i] = own[static_cast<std::size_t>(parent)].second > 0 ? parent : above[static_cast<std::size_t>(parent)];
  }
  std::vector<Weighted> shared(n, none);  // with the joint above
  for (std::size_t v = 0; v < positions.size(); ++v) {
    std::map<int, double> of_node;
    for (std::size_t k = 0; k < kMaxInfluences; ++k) {
      const double weight = rig.weights[v].weight[k];
      if (weight > 0) of_node[static_cast<int>(rig.bones[rig.weights[v].joint[k]].node)] += weight;
    }
    for (const auto& [node, weight] : of_node) {
      const auto upper = of_node.find(above[static_cast<std::size_t>(node)]);
      if (upper != of_node.end())
        add_weighted(shared[static_cast<std::size_t>(node)], positions[v], weight * upper->second);
    }
  }
  std::vector<Vec3> pivots(n, Vec3::Zero());
  std::vector<Weighted> below(n, none);
  for (std::size_t i = n; i-- > 0;) {  // children come after their parents
    const bool is_root = above[i] < 0;
    if (shared[i].second > 0)
      pivots[i] = shared[i].first / shared[i].second;
    else if (own[i].second > 0 && !(is_root && below[i].second > 0))
      pivots[i] = own[i].first / own[i].second;
    else if (below[i].second > 0)
      pivots[i] = below[i].first / below[i].second;
    else
      continue;
    if (rig.nodes[i].parent >= 0) add_weighted(below[static_cast<std::size_t>(rig.nodes[i].parent)], pivots[i], 1);
  }
  for (std::size_t i = 0; i < n; ++i) {  // ends that carry nothing
    const bool has_none = !(own[i].second > 0) && !(below[i].second > 0);
    if (has_none && rig.nodes[i].parent >= 0) pivots[i] = pivots[static_cast<std::size_t>(rig.nodes[i].parent)];
  }
  return pivots;
}

}  // namespace spherechain::baker

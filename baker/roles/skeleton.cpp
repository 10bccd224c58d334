// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/roles/skeleton.h"

#include <algorithm>

#include "baker/import/pivots.h"
#include "baker/roles/roles.h"

namespace spherechain::baker {

int Skeleton::common_ancestor(int a, int b) const {
  while (a != b && a >= 0 && b >= 0) (depth[a] >= depth[b] ? a : b) = parent[depth[a] >= depth[b] ? a : b];
  return a == b ? a : -1;
}

std::vector<int> Skeleton::path(int from, int to) const {
  const int top = common_ancestor(from, to);
  std::vector<int> nodes, down;
  for (int n = from; n != top; n = parent[n]) nodes.push_back(n);
  if (top >= 0) nodes.push_back(top);
  for (int n = to; n != top; n = parent[n]) down.push_back(n);
  nodes.insert(nodes.end(), down.rbegin(), down.rend());
  return nodes;
}

double Skeleton::bone(int node) const {
  return parent[node] < 0 ? 0 : (position[node] - position[parent[node]]).norm();
}

double Skeleton::length(const std::vector<int>& path) const {
  double sum = 0;
  for (std::size_t i = 1; i < path.size(); ++i) sum += (position[path[i]] - position[path[i - 1]]).norm();
  return sum;
}

std::vector<Vec3> rest_positions(const SourceRig& rig) {
  if (!rig.pivots.empty()) return rig.pivots;
  std::vector<Vec3> positions;
  for (const Affine& place : places_at_rest(rig)) positions.push_back(place.translation());
  return positions;
}

void Skeleton::measure() {
  const std::size_t n = parent.size();
  depth.assign(n, 0);
  for (std::size_t i = 0; i < n; ++i) {  // children come after their parents
    if (parent[i] >= 0) depth[i] = depth[parent[i]] + 1;
  }
  reach.assign(n, 0);
  tip = position;
  for (std::size_t i = n; i-- > 0;) {
    const int above = parent[i];
    if (above < 0 || !alive[i]) continue;
    const double way = reach[i] + bone(static_cast<int>(i));
    if (way > reach[above]) {
      reach[above] = way;
      tip[above] = tip[i];
    }
  }
  Vec3 mean = Vec3::Zero();
  double living = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (!alive[i]) continue;
    mean += position[i];
    ++living;
  }
  size = 0;
  for (std::size_t i = 0; i < n && living > 0; ++i) {
    if (alive[i]) size = std::max(size, (position[i] - mean / living).norm());
  }
}

namespace {

// A node without skin above the whole skeleton says only where the scene has it. Far away it would stretch the shape.
void bring_near(Skeleton& s) {
  const auto n = static_cast<std::size_t>(s.count());
  std::vector<int> living(n, 0), below(n, -1);
  for (std::size_t i = 0; i < n; ++i) {
    if (!s.alive[i] || s.parent[i] < 0) continue;
    const auto parent = static_cast<std::size_t>(s.parent[i]);
    ++living[parent];
    below[parent] = static_cast<int>(i);
  }
  std::vector<std::size_t> above;
  Eigen::AlignedBox3d box;
  std::vector<bool> is_above(n, false);
  for (std::size_t i = 0; i < n; ++i) {
    const bool at_top = s.parent[i] < 0 || is_above[static_cast<std::size_t>(s.parent[i])];
    is_above[i] = at_top && s.weight[i] == 0 && living[i] == 1;
    if (is_above[i])
      above.push_back(i);
    else if (s.alive[i])
      box.extend(s.position[i]);
  }
  if (std::all_of(s.weight.begin(), s.weight.end(), [](double weight) { return weight == 0; })) return;
  constexpr double kFar = 0.25;  // of the skeleton's size
  const double far = kFar * box.diagonal().norm();
  for (std::size_t k = above.size(); k-- > 0;) {
    const std::size_t i = above[k];
    if (box.exteriorDistance(s.position[i]) > far) s.position[i] = s.position[static_cast<std::size_t>(below[i])];
  }
}

}  // namespace

Skeleton make_skeleton(const SourceRig& rig, const std::vector<Vec3>& positions) {
  Skeleton s;
  const std::size_t n = rig.nodes.size();
  s.children.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    s.names.push_back(rig.nodes[i].name);
    s.parent.push_back(rig.nodes[i].parent);
    if (s.parent[i] >= 0) s.children[s.parent[i]].push_back(static_cast<int>(i));
  }
  s.position = rest_positions(rig);
  s.is_mirrored = rig.to_rest.linear().determinant() < 0;
  s.weight.assign(n, 0);
  s.skin.assign(n, Vec3::Zero());
  for (std::size_t v = 0; v < std::min(rig.weights.size(), positions.size()); ++v) {
    for (std::size_t k = 0; k < kMaxInfluences; ++k) {
      const double w = rig.weights[v].weight[k];
      if (w <= 0) continue;
      const Index node = rig.bones[rig.weights[v].joint[k]].node;
      s.weight[node] += w;
      s.skin[node] += w * positions[v];
    }
  }
  const bool skinned = std::any_of(s.weight.begin(), s.weight.end(), [](double w) { return w > 0; });
  s.alive.assign(n, !skinned && rig.bones.empty());
  for (const Bone& bone : rig.bones) s.alive[bone.node] = s.alive[bone.node] || !skinned;
  s.joint.assign(n, -1);
  for (std::size_t i = n; i-- > 0;) {  // children come after their parents
    if (s.weight[i] > 0) {
      s.skin[i] /= s.weight[i];
      s.alive[i] = true;
    } else {
      s.skin[i] = s.position[i];
    }
    if (s.parent[i] >= 0 && s.alive[i]) s.alive[s.parent[i]] = true;
  }
  bring_near(s);
  s.measure();
  return s;
}

}  // namespace spherechain::baker

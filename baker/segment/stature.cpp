// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/segment/stature.h"

#include <algorithm>
#include <limits>

#include "baker/import/source_rig.h"
#include "baker/segment/part_tree.h"

namespace spherechain::baker {
namespace {

// How far along `axis` the skin goes that wanted nodes move; all skin, if they move none.
double top(const Mesh& skin, const std::vector<int>& nodes, const Vec3& axis, const auto& is_wanted) {
  constexpr double kNone = std::numeric_limits<double>::lowest();
  double of_all = kNone, of_wanted = kNone;
  for (Index t = 0; t < nodes.size(); ++t) {
    const bool wanted = nodes[t] >= 0 && is_wanted(static_cast<std::size_t>(nodes[t]));
    for (const Index v : skin.triangles[t]) {
      const double at = skin.positions[v].dot(axis);
      of_all = std::max(of_all, at);
      if (wanted) of_wanted = std::max(of_wanted, at);
    }
  }
  return of_wanted > kNone ? of_wanted : of_all;
}

constexpr double kAxis = 0.999;  // cosine of the angle to an axis

Vec3 nearest_axis(const Vec3& v) {
  Eigen::Index axis = 0;
  v.cwiseAbs().maxCoeff(&axis);
  return v[axis] < 0 ? Vec3(-Vec3::Unit(axis)) : Vec3(Vec3::Unit(axis));
}

// Whether the nodes above the skeleton turn it by more than a change of axes.
bool is_turned_from_above(const SourceRig& rig, int joint) {
  std::vector<bool> has_bone(rig.nodes.size(), false);
  for (const Bone& bone : rig.bones) has_bone[bone.node] = true;
  const auto parent = [&](int node) { return rig.nodes[static_cast<std::size_t>(node)].parent; };
  int above = parent(joint);
  while (above >= 0 && has_bone[static_cast<std::size_t>(above)]) above = parent(above);
  if (above < 0) return false;
  const Eigen::Matrix3d turn = world_of(rig.nodes)[static_cast<std::size_t>(above)].linear();
  for (Eigen::Index column = 0; column < 3; ++column) {
    if (!(turn.col(column).normalized().cwiseAbs().maxCoeff() > kAxis)) return true;
  }
  return false;
}

// From the middle of the ankles to the head.
Vec3 along_body(const Roles& roles, const std::vector<Vec3>& joints) {
  const auto at = [&](int node) { return joints[static_cast<std::size_t>(node)]; };
  Vec3 feet = Vec3::Zero();
  double legs = 0;
  for (const RoleLimb& limb : roles.limbs) {
    if (!limb.name.ends_with("leg")) continue;
    feet += at(limb.extremity < 0 ? limb.nodes.back() : limb.nodes[static_cast<std::size_t>(limb.extremity)]);
    ++legs;
  }
  const Vec3 way = at(roles.neck_head.back()) - (legs > 0 ? Vec3(feet / legs) : at(roles.trunk.front()));
  return way.norm() > 0 ? way.normalized() : Vec3(Vec3::Zero());
}

}  // namespace

Vec3 way_up(const Character& character, const Roles& roles) {
  const Vec3 up = character.up_hint.normalized();
  if (roles.kind != BodyKind::kBiped || roles.trunk.empty() || roles.neck_head.empty()) return up;
  const std::vector<Vec3> joints = rest_positions(character.rig);
  const Vec3 pelvis = joints[static_cast<std::size_t>(roles.trunk.front())],
             trunk = joints[static_cast<std::size_t>(roles.neck_head.back())] - pelvis,
             body = along_body(roles, joints);
  if (!(trunk.norm() > 0) || body.isZero()) return up;
  // A scene's up that is no axis of the mesh stands a straight mesh at an angle. Nodes that turn the skeleton and leave
  // the scene's up an axis turn the mesh itself.
  const bool stands_straight = up.cwiseAbs().maxCoeff() < kAxis;
  if (stands_straight || is_turned_from_above(character.rig, roles.trunk.front())) {
    const double same = stands_straight ? 0.94 : 0.996;  // 20 degrees, 5 degrees
    const Vec3 axis = nearest_axis(body);
    return body.dot(axis) > same ? axis : body;
  }
  constexpr double kUpright = 0.5;
  return trunk.normalized().dot(up) > kUpright ? up : nearest_axis(trunk);
}

double stature(const Character& character, const Roles& roles) {
  const Vec3 up = way_up(character, roles);
  const std::vector<int> nodes = heaviest_nodes(character);
  const std::vector<Node>& rig = character.rig.nodes;
  std::vector<bool> in_head;
  for (std::size_t n = 0; n < rig.size(); ++n) {
    const bool below =
        rig[n].parent >= 0 && in_head[static_cast<std::size_t>(rig[n].parent)] && roles.of_node[n].role != "attachment";
    in_head.push_back(below || roles.of_node[n].role == "head");
  }
  const auto is_head = [&](std::size_t n) { return in_head[n]; };
  const auto is_leg = [&](std::size_t n) {
    const int limb = roles.of_node[n].limb;
    return limb >= 0 && roles.limbs[static_cast<std::size_t>(limb)].name.ends_with("leg");
  };
  const double height = top(character.skin, nodes, up, is_head) + top(character.skin, nodes, -up, is_leg);
  // A head below the feet is in a pose that no character stands in.
  const auto all = [](std::size_t) { return true; };
  return height > 0 ? height : top(character.skin, nodes, up, all) + top(character.skin, nodes, -up, all);
}

}  // namespace spherechain::baker

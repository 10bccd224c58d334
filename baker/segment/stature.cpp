// SPDX-License-Identifier: GPL-3.0-or-later
#include "segment/stature.h"

#include <algorithm>
#include <limits>

#include "segment/part_tree.h"

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

}  // namespace

Vec3 way_up(const Character& character, const Roles& roles) {
  constexpr double kUpright = 0.5;
  const Vec3 up = character.up_hint.normalized();
  if (roles.kind != BodyKind::kBiped || roles.trunk.empty() || roles.neck_head.empty()) return up;
  const std::vector<Vec3> rest = rest_positions(character.rig);
  const Vec3 trunk =
      rest[static_cast<std::size_t>(roles.neck_head.back())] - rest[static_cast<std::size_t>(roles.trunk.front())];
  if (!(trunk.norm() > 0)) return up;
  Eigen::Index axis = 0;
  trunk.cwiseAbs().maxCoeff(&axis);
  const Vec3 own = trunk[axis] < 0 ? Vec3(-Vec3::Unit(axis)) : Vec3(Vec3::Unit(axis));
  // A scene may stand a character at any angle; a scene's up that is an axis of the mesh is the mesh's, too.
  constexpr double kAxis = 0.999;
  const bool is_odd = up.cwiseAbs().maxCoeff() < kAxis;
  const bool is_upright = trunk.normalized().dot(up) > kUpright;
  return is_upright && !(is_odd && trunk.dot(own) > trunk.dot(up)) ? up : own;
}

double stature(const Character& character, const Roles& roles) {
  const Vec3 up = way_up(character, roles);
  const std::vector<int> nodes = heaviest_nodes(character);
  const std::vector<Node>& rig = character.rig.nodes;
  std::vector<bool> in_head;
  for (std::size_t n = 0; n < rig.size(); ++n) {
    const bool below = rig[n].parent >= 0 && in_head[static_cast<std::size_t>(rig[n].parent)];
    in_head.push_back(below || roles.of_node[n].role == "head");
  }
  const auto is_head = [&](std::size_t n) { return in_head[n]; };
  const auto is_leg = [&](std::size_t n) {
    const int limb = roles.of_node[n].limb;
    return limb >= 0 && roles.limbs[static_cast<std::size_t>(limb)].name.ends_with("leg");
  };
  return top(character.skin, nodes, up, is_head) + top(character.skin, nodes, -up, is_leg);
}

}  // namespace spherechain::baker

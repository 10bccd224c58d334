// SPDX-License-Identifier: GPL-3.0-or-later
#include "named_rig.h"

#include <algorithm>
#include <numeric>
#include <sstream>

using namespace spherechain::baker;

namespace {

using Places = std::map<std::string, Vec3>;

const Places& places(Body body) {
  static const Places human{
      {"root", {0, 0, 0}},           {"pelvis", {0, 0.95, 0}},      {"spine", {0, 1.08, -0.01}},
      {"chest", {0, 1.28, -0.02}},   {"neck", {0, 1.5, -0.02}},     {"head", {0, 1.6, 0}},
      {"eye", {0.03, 1.66, 0.08}},   {"clavicle", {0.03, 1.42, 0}}, {"shoulder", {0.18, 1.42, -0.01}},
      {"elbow", {0.4, 1.25, -0.02}}, {"wrist", {0.6, 1.08, 0.02}},  {"finger", {0.66, 1.03, 0.04}},
      {"hip", {0.09, 0.9, 0}},       {"knee", {0.1, 0.5, 0.01}},    {"ankle", {0.11, 0.08, -0.02}},
      {"toe", {0.12, 0.02, 0.1}},    {"tail_1", {0, 0.95, -0.1}}};
  static const Places fox{{"root", {0, 0, 0}},       {"pelvis", {0, 43, -27}},  {"spine", {0, 54, -20}},
                          {"chest", {0, 54, 5}},     {"neck", {0, 55, 25}},     {"head", {0, 64, 36}},
                          {"clavicle", {5, 54, 17}}, {"shoulder", {7, 49, 18}}, {"elbow", {7, 26, 17}},
                          {"wrist", {7, 7, 18}},     {"finger", {7, 2, 22}},    {"hip", {7, 49, -30}},
                          {"knee", {7, 30, -27}},    {"ankle", {7, 16, -38}},   {"toe", {7, 1, -33}},
                          {"tail_1", {0, 50, -40}},  {"tail_2", {0, 43, -48}},  {"tail_3", {0, 28, -67}}};
  return body == Body::kHuman ? human : fox;
}

Vec3 place_of(std::string role, const Places& places, bool& known) {
  double side = 1;
  if (role.starts_with("left_")) role.erase(0, 5);
  if (role.starts_with("right_")) {
    role.erase(0, 6);
    side = -1;
  }
  const auto found = places.find(role);
  known = found != places.end();
  return known ? Vec3(side * found->second.x(), found->second.y(), found->second.z()) : Vec3::Zero();
}

// The rig of nodes at these places: translations only, one vertex on each node that moves skin.
NamedRig build(const std::vector<std::string>& names, const std::vector<int>& parents, const std::vector<Vec3>& where,
               const std::vector<bool>& skinned, std::vector<std::string> expected) {
  NamedRig out;
  out.expected = std::move(expected);
  for (std::size_t n = 0; n < names.size(); ++n) {
    Node node;
    node.name = names[n];
    node.parent = parents[n];
    node.translation = parents[n] < 0 ? where[n] : Vec3(where[n] - where[parents[n]]);
    node.local.translation() = node.translation;
    out.rig.nodes.push_back(node);
    if (!skinned[n]) continue;
    VertexWeights weights;
    weights.joint[0] = static_cast<Index>(out.rig.bones.size());
    weights.weight[0] = 1;
    Affine inverse_bind = Affine::Identity();
    inverse_bind.translation() = -where[n];
    out.rig.bones.push_back({static_cast<Index>(n), inverse_bind});
    out.rig.weights.push_back(weights);
    out.positions.push_back(where[n]);
  }
  return out;
}

std::vector<bool> skinned_nodes(const NamedRig& rig) {
  std::vector<bool> skinned(rig.rig.nodes.size(), false);
  for (const Bone& bone : rig.rig.bones) skinned[bone.node] = true;
  return skinned;
}

constexpr double kScale = 37;
const Vec3 kShift(5, -3, 11);
Eigen::Matrix3d turn() { return Eigen::AngleAxisd(1.1, Vec3(0.3, -0.5, 0.8).normalized()).toRotationMatrix(); }

}  // namespace

NamedRig named_rig(const std::string& tree, Body body) {
  std::vector<std::string> names, expected;
  std::vector<int> parents, open;
  std::vector<std::size_t> indents;
  std::vector<Vec3> where;
  std::vector<bool> skinned;
  std::map<std::string, int> seen;
  std::istringstream lines(tree);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t indent = line.find_first_not_of(' '), equals = line.rfind(" = ");
    if (indent == std::string::npos) continue;
    std::string role = line.substr(equals + 3);
    const bool moves_skin = role[0] != '!';
    if (!moves_skin) role.erase(0, 1);
    while (!indents.empty() && indents.back() >= indent) {
      indents.pop_back();
      open.pop_back();
    }
    const int parent = open.empty() ? -1 : open.back();
    bool known = false;
    Vec3 position = place_of(role, places(body), known);
    if (!known || seen[role]++ > 0) {
      // A little farther from the body's middle than its parent.
      const Vec3 from = parent < 0 ? Vec3::Zero() : where[parent];
      const Vec3 out = from - places(body).at("pelvis");
      position = from + 0.06 * (out.norm() > 0 ? out : places(body).at("pelvis"));
    }
    indents.push_back(indent);
    open.push_back(static_cast<int>(names.size()));
    names.push_back(line.substr(indent, equals - indent));
    expected.push_back(role);
    parents.push_back(parent);
    where.push_back(position);
    skinned.push_back(moves_skin);
  }
  return build(names, parents, where, skinned, expected);
}

Vec3 moved(const Vec3& position) { return kScale * (turn() * position) + kShift; }

NamedRig moved(const NamedRig& rig) {
  NamedRig out = rig;
  for (Vec3& p : out.positions) p = moved(p);
  for (Bone& bone : out.rig.bones) {
    const Vec3 at = moved(Vec3(bone.inverse_bind.inverse().translation()));
    bone.inverse_bind = Affine::Identity();
    bone.inverse_bind.translation() = -at;
  }
  out.rig.to_rest.linear() = kScale * turn();
  out.rig.to_rest.translation() = kShift;
  return out;
}

NamedRig shuffled(const NamedRig& rig, unsigned seed) {
  const std::vector<Vec3> where = rest_positions(rig.rig);
  const std::vector<bool> skinned = skinned_nodes(rig);
  std::mt19937 random(seed);
  std::vector<std::size_t> order;
  std::vector<int> new_of(rig.rig.nodes.size(), -1);
  while (order.size() < new_of.size()) {
    std::vector<std::size_t> ready;
    for (std::size_t n = 0; n < new_of.size(); ++n) {
      const int parent = rig.rig.nodes[n].parent;
      if (new_of[n] < 0 && (parent < 0 || new_of[parent] >= 0)) ready.push_back(n);
    }
    const std::size_t next = ready[random() % ready.size()];
    new_of[next] = static_cast<int>(order.size());
    order.push_back(next);
  }
  std::vector<std::string> names, expected;
  std::vector<int> parents;
  std::vector<Vec3> places;
  std::vector<bool> moves;
  for (const std::size_t n : order) {
    const Node& node = rig.rig.nodes[n];
    names.push_back(node.name);
    expected.push_back(rig.expected[n]);
    parents.push_back(node.parent < 0 ? -1 : new_of[node.parent]);
    places.push_back(where[n]);
    moves.push_back(skinned[n]);
  }
  return build(names, parents, places, moves, expected);
}

NamedRig nameless(NamedRig rig) {
  for (std::size_t n = 0; n < rig.rig.nodes.size(); ++n) rig.rig.nodes[n].name = "joint_" + std::to_string(n);
  return rig;
}

namespace {

struct Rebuilt {
  std::vector<std::string> names, expected;
  std::vector<int> parents;
  std::vector<Vec3> where;
  std::vector<bool> skinned;

  int add(const std::string& name, int parent, const Vec3& at, bool moves_skin, const std::string& role) {
    names.push_back(name);
    parents.push_back(parent);
    where.push_back(at);
    skinned.push_back(moves_skin);
    expected.push_back(role);
    return static_cast<int>(names.size()) - 1;
  }
};

NamedRig with_more(const NamedRig& rig, bool above, const Vec3& shift) {
  const std::vector<Vec3> where = rest_positions(rig.rig);
  const std::vector<bool> skinned = skinned_nodes(rig);
  Rebuilt out;
  std::vector<int> new_of;
  for (std::size_t n = 0; n < where.size(); ++n) {
    const Node& node = rig.rig.nodes[n];
    int parent = node.parent < 0 ? -1 : new_of[static_cast<std::size_t>(node.parent)];
    if (above && skinned[n] && parent >= 0)
      parent = out.add(node.name + "_offset", parent, where[n] + shift, false, "");
    new_of.push_back(out.add(node.name, parent, where[n], skinned[n], rig.expected[n]));
    if (!above && skinned[n]) out.add(node.name + "_b", new_of.back(), where[n], true, "");
  }
  return build(out.names, out.parents, out.where, out.skinned, out.expected);
}

}  // namespace

NamedRig with_offsets(const NamedRig& rig, const Vec3& shift) { return with_more(rig, true, shift); }
NamedRig with_twins(const NamedRig& rig) { return with_more(rig, false, Vec3::Zero()); }

// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/roles/roles.h"

#include <algorithm>
#include <array>

#include "baker/mesh/error.h"
#include "baker/roles/body.h"
#include "baker/roles/joint_parts.h"
#include "baker/roles/shape.h"

namespace spherechain::baker {
namespace {

constexpr double kLongNeck = 0.75;  // parts of the trunk's length from which neck and tail are limbs
constexpr double kLongTail = 0.25;

constexpr std::array<const char*, 5> kArmRoles{"clavicle", "shoulder", "elbow", "wrist", "finger"};
constexpr std::array<const char*, 5> kLegRoles{"", "hip", "knee", "ankle", "toe"};

const char* plain_role(Word word) {
  switch (word) {
    case Word::kEye:
      return "eye";
    case Word::kJaw:
      return "jaw";
    case Word::kHair:
      return "hair";
    case Word::kHeadPart:
      return "head_part";
    case Word::kAttachment:
      return "attachment";
    case Word::kControl:
      return "control";
    case Word::kRoot:
      return "root";
    default:
      return "other";
  }
}

// A humanoid mapping in the file goes before the node's name. A rigid mesh on a joint is an attachment, but where its
// name says that it is of the body: a head, hair.
std::vector<Hint> hints_from_names(const SourceRig& rig) {
  std::vector<std::string> names;
  for (const Node& node : rig.nodes) names.push_back(node.humanoid_bone.empty() ? node.name : node.humanoid_bone);
  std::vector<Hint> hints = read_names(names);
  for (std::size_t n = 0; n < hints.size(); ++n) {
    if (rig.nodes[n].is_attachment && !is_of_body(hints[n].word)) {
      hints[n].word = Word::kAttachment;
      hints[n].reason = "a rigid mesh on a joint";
    }
    const std::string& bone = rig.nodes[n].humanoid_bone;
    if (!bone.empty() && hints[n].word != Word::kNone) hints[n].reason = "the avatar's humanoid says " + bone;
  }
  return hints;
}

// Two pairs of limbs, and each is known down to its second bone.
bool is_complete(const Body& body) {
  return (body.kind == BodyKind::kBiped || body.kind == BodyKind::kQuadruped) &&
         std::all_of(body.paths.begin(), body.paths.end(),
                     [](const LimbPath& path) { return path.first(kUpper) >= 0 && path.first(kLower) >= 0; });
}

// Gives each limb of the shape the side that most of its names tell.
void spread_sides(const Skeleton& skeleton, const std::vector<Hint>& shape, std::vector<Hint>& hints) {
  const std::vector<LimbPath> paths = find_limb_paths(skeleton, shape);
  const std::vector<int> path_of = skeleton.inherited([&](int n) {
    for (std::size_t p = 0; p < paths.size(); ++p) {
      if (paths[p].roots.front() == n) return static_cast<int>(p);
    }
    return -1;
  });
  std::vector<int> left(paths.size(), 0);
  const auto of = [&](std::size_t n) -> int& { return left[static_cast<std::size_t>(path_of[n])]; };
  for (std::size_t n = 0; n < hints.size(); ++n) {
    if (path_of[n] >= 0 && hints[n].side != NamedSide::kNone) of(n) += hints[n].side == NamedSide::kLeft ? 1 : -1;
  }
  for (std::size_t n = 0; n < hints.size(); ++n) {
    if (path_of[n] < 0) continue;
    hints[n].side = of(n) == 0 ? NamedSide::kNone : of(n) > 0 ? NamedSide::kLeft : NamedSide::kRight;
  }
}

// Where names do not give a body, the rig's shape says what limbs are, and names say the rest: sides, head, tail, hair.
std::vector<Hint> hints_of(const Skeleton& skeleton, const std::vector<Hint>& names, BodyKind wanted) {
  if (is_complete(find_body(skeleton, names, wanted))) return names;
  const std::vector<Hint> shape = hints_from_shape(skeleton);
  const bool no_limbs = find_limb_paths(skeleton, names).empty();
  std::vector<Hint> both = names;
  for (std::size_t n = 0; n < names.size(); ++n) {
    const Word named = names[n].word;
    if (named != Word::kNone && (family_of(named) == Family::kNone || (no_limbs && shape[n].word == Word::kNone)))
      continue;
    both[n].word = shape[n].word;
    both[n].reason = shape[n].reason;
  }
  spread_sides(skeleton, shape, both);
  return no_limbs || is_complete(find_body(skeleton, both, wanted)) ? both : names;
}

// Throws Error(kFile) where the file names a node that does not exist.
std::vector<Hint> with_file(const SourceRig& rig, const RoleFile& file, std::vector<Hint> hints) {
  for (const auto& [name, role] : file.role_of) {
    bool known = false;
    for (std::size_t n = 0; n < rig.nodes.size(); ++n) {
      if (rig.nodes[n].name != name) continue;
      hints[n] = hint_of_role(role);
      known = true;
    }
    if (!known) throw Error(ExitCode::kFile, file.file + ": the rig has no node '" + name + "'");
  }
  return hints;
}

// Gives every node its role and the reason for it.
struct RoleWriter {
  const Skeleton& s;
  const std::vector<Hint>& hints;
  const Body& body;
  Roles roles;

  void set(int node, std::string role, int limb, std::string reason) {
    if (roles.of_node[node].role.empty()) roles.of_node[node] = {std::move(role), limb, std::move(reason)};
  }
  std::string because(int node, const std::string& place) const {
    return hints[node].reason.empty() ? place : hints[node].reason + "; " + place;
  }

  void add_limbs(const std::vector<int>& order, bool top) {
    for (std::size_t k = 0; k < order.size(); ++k) {
      const LimbPath& path = body.paths[order[k]];
      const bool is_left = path.side == NamedSide::kLeft;
      const bool arm = path.family == Family::kArm || (top && roles.kind != BodyKind::kOther);
      std::string kind = arm ? "arm" : "leg";
      if (roles.kind == BodyKind::kQuadruped) kind = top ? "foreleg" : "hindleg";
      const std::string side = is_left ? "left_" : "right_";
      RoleLimb limb{side + kind, is_left, order.size() > 2 && !arm ? k < order.size() / 2 : top, {}, -1, -1};
      if (order.size() > 2) limb.name += "_" + std::to_string(k / 2 + 1);
      const auto index = static_cast<int>(roles.limbs.size());
      const bool has_roles = order.size() <= 2;
      const int first = std::max(0, path.first(kUpper));
      std::array<bool, 5> seen{};
      for (std::size_t i = 0; i < path.nodes.size(); ++i) {
        const int node = path.nodes[i];
        const Rank rank = path.ranks[i];
        if (static_cast<int>(i) < first) {
          if (limb.girdle < 0) limb.girdle = node;
          const bool clavicle = arm && !seen[rank];
          set(node, clavicle ? side + "clavicle" : "other", -1,
              because(node, "joins the " + limb.name + " to the trunk"));
        } else {
          limb.nodes.push_back(node);
          if (rank == kExtremity && limb.extremity < 0) limb.extremity = static_cast<int>(limb.nodes.size()) - 1;
          if (!has_roles)
            set(node, "limb", index, because(node, "on the way down the " + limb.name) + body.side_notes[order[k]]);
          else if (seen[rank] && rank != kDigit)
            set(node, "twist", index, because(node, "goes on along the bone before it"));
          else
            set(node, side + (arm ? kArmRoles : kLegRoles)[rank], index,
                because(node, "on the way down the " + limb.name) + body.side_notes[order[k]]);
        }
        seen[rank] = true;
      }
      roles.limbs.push_back(std::move(limb));
      add_hangers(order[k], index, side + (arm ? "finger" : "toe"));
    }
  }

  // All else that hangs on a limb belongs to it.
  void add_hangers(int path, int index, const std::string& digit) {
    const RoleLimb& limb = roles.limbs[index];
    const int hand = limb.extremity < 0 ? -1 : limb.nodes[limb.extremity];
    const std::vector<int> in_hand = s.inherited([&](int n) { return n == hand ? 1 : -1; });
    std::vector<bool> is_in_prop(hints.size(), false);
    for (int n = 0; n < s.count(); ++n) {
      const int parent = s.parent[n];
      is_in_prop[n] = hints[n].word == Word::kAttachment || (parent >= 0 && is_in_prop[parent]);
      if (body.path_of[n] != path || !roles.of_node[n].role.empty() || s.joint[n] >= 0) continue;
      const bool in_girdle = roles.of_node[parent].limb < 0;
      std::string role = plain_role(hints[n].word);
      std::string reason = because(n, "hangs on " + s.names[parent]);
      if (role == "other" && !s.alive[n] && hints[n].word == Word::kNone)
        reason = "moves no skin";
      else if (role == "other" && hints[n].word != Word::kCloth && !in_girdle && !is_in_prop[n])
        role = in_hand[n] > 0 ? digit : "twist";
      set(n, role, in_girdle ? -1 : index, reason);
    }
  }

  void add_chain(const std::string& name, std::vector<int> nodes, bool top) {
    for (const int node : nodes) roles.of_node[node].limb = static_cast<int>(roles.limbs.size());
    roles.limbs.push_back({name, true, top, std::move(nodes), -1, -1});
  }

  void add_trunk() {
    const auto note = [&](int n, const std::string& place) { return because(n, place); };
    for (std::size_t i = 0; i < roles.trunk.size(); ++i) {
      const int n = roles.trunk[i];
      if (n == body.pelvis)
        set(n, "pelvis", -1,
            note(n, body.paths.empty() ? "one end of the longest chain" : "where the legs meet the trunk"));
      else if (n == body.chest)
        set(n, "chest", -1, note(n, "the last of the trunk before neck and arms"));
      else
        set(n, "spine", -1, note(n, "between pelvis and chest"));
    }
    for (const int n : roles.neck_head) {
      if (n == body.head)
        set(n, "head", -1, note(n, "the end of the way up from the chest"));
      else
        set(n, "neck", -1, note(n, "between chest and head"));
    }
    const double trunk = s.length(roles.trunk);
    if (roles.kind != BodyKind::kBiped && roles.neck_head.size() > 1 && s.length(roles.neck_head) > kLongNeck * trunk &&
        !body.paths.empty()) {
      add_chain("neck", roles.neck_head, true);
    }
    find_tail(trunk);
  }

  void find_tail(double trunk) {
    int top = find_in_middle(s, hints, body.path_of, Word::kTail);
    // Nodes that hang on the head are hair.
    if (top >= 0 && body.head >= 0 && s.common_ancestor(top, body.head) == body.head) top = -1;
    const bool by_shape = top < 0 && !body.paths.empty() && hints[body.paths[0].nodes[0]].reason == kByShape;
    if (by_shape && body.pelvis >= 0) {
      const std::vector<bool> over_chest = at_or_above(s, body.chest);
      for (const int child : s.children[body.pelvis]) {
        if (!s.alive[child] || body.path_of[child] >= 0 || !roles.of_node[child].role.empty() ||
            hints[child].word != Word::kNone || over_chest[child]) {
          continue;
        }
        if (top < 0 || s.reach[child] + s.bone(child) > s.reach[top] + s.bone(top)) top = child;
      }
    }
    if (top < 0 || !roles.of_node[top].role.empty()) return;
    const std::vector<int> nodes = main_path(s, hints, top, Family::kNone);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      set(nodes[i], "tail_" + std::to_string(i + 1), -1,
          because(nodes[i], "on the way from the pelvis to the tail's tip"));
    }
    if (s.length(nodes) + (s.skin[nodes.back()] - s.position[nodes.back()]).norm() > kLongTail * trunk) {
      add_chain("tail", nodes, false);
    }
  }

  void add_joint_parts(const std::vector<int>& in_head) {
    for (int n = 0; n < s.count(); ++n) {
      if (s.joint[n] < 0) continue;
      const int joint = s.joint[n];
      const int limb = roles.of_node[joint].limb;
      if (s.weight[n] > 0)
        set(n, limb >= 0 ? "twist" : in_head[n] > 0 ? "head_part" : "other", limb, "a part of " + s.names[joint]);
      else
        set(n, "other", limb, "moves no skin; belongs to " + s.names[joint]);
    }
  }

  // Remaining nodes get a role by their word, or else by the node above.
  void add_rest() {
    const std::vector<int> in_head = s.inherited([&](int n) { return n == body.head ? 1 : -1; });
    add_joint_parts(in_head);
    std::vector<bool> above(hints.size(), false);
    for (int n = roles.trunk.empty() ? -1 : roles.trunk.front(); n >= 0; n = s.parent[n]) above[n] = true;
    for (int n = 0; n < s.count(); ++n) {
      if (!roles.of_node[n].role.empty()) continue;
      const int parent = s.parent[n];
      std::string role = plain_role(hints[n].word);
      std::string reason = because(n, parent >= 0 ? "hangs on " + s.names[parent] : "stands alone");
      if (above[n]) {
        role = "root";
        reason = because(n, "above the pelvis");
      } else if (role == "other" && !s.alive[n]) {
        reason = "moves no skin";
      } else if (role == "other" && in_head[n] > 0) {
        role = "head_part";
      }
      set(n, role, parent >= 0 ? roles.of_node[parent].limb : -1, reason);
    }
  }
};

}  // namespace

const char* body_kind_name(BodyKind kind) {
  switch (kind) {
    case BodyKind::kBiped:
      return "biped";
    case BodyKind::kQuadruped:
      return "quadruped";
    case BodyKind::kOther:
      return "other";
    default:
      return "unknown";
  }
}

std::vector<std::string> limbs_by_shape(const Roles& roles) {
  std::vector<std::string> out;
  for (const RoleLimb& limb : roles.limbs) {
    const bool is_by_shape = std::any_of(limb.nodes.begin(), limb.nodes.end(), [&](int node) {
      return roles.of_node[static_cast<std::size_t>(node)].reason.find(kByShape) != std::string::npos;
    });
    if (is_by_shape) out.push_back(limb.name);
  }
  return out;
}

Roles find_roles(const SourceRig& rig, const std::vector<Vec3>& positions, const RoleFile& file, BodyKind wanted) {
  if (rig.robot.is_robot) {
    Roles links;
    links.of_node.assign(rig.nodes.size(), {"other", -1, "a robot's link"});
    return links;
  }
  const std::vector<Hint> names = hints_from_names(rig);
  Skeleton skeleton = make_skeleton(rig, positions);
  join_joint_parts(skeleton, with_file(rig, file, names));
  const std::vector<Hint> hints = with_file(rig, file, hints_of(skeleton, names, wanted));
  const Body body = find_body(skeleton, hints, wanted);
  RoleWriter writer{skeleton, hints, body, {}};
  Roles& roles = writer.roles;
  roles.kind = body.kind;
  roles.trunk = body.trunk;
  roles.neck_head = body.neck_head;
  roles.of_node.resize(rig.nodes.size());
  writer.add_limbs(body.upper, true);
  writer.add_limbs(body.lower, false);
  writer.add_trunk();
  writer.add_rest();
  for (std::size_t n = 0; n < hints.size(); ++n) {
    if (hints[n].given) roles.of_node[n].role = file.role_of.at(rig.nodes[n].name);
  }
  return roles;
}

}  // namespace spherechain::baker

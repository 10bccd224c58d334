// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/bind/part_names.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

#include "baker/roles/names.h"

namespace spherechain::baker {
namespace {

// The parts of a limb by role: of a biped; of a quadruped.
struct Segment {
  std::string_view role, biped, quadruped;
};
constexpr std::array<Segment, 9> kSegments{{{"clavicle", "shoulder", "shoulder"},
                                            {"shoulder", "upper arm", "upper foreleg"},
                                            {"elbow", "forearm", "lower foreleg"},
                                            {"wrist", "hand", "forefoot"},
                                            {"finger", "hand", "forefoot"},
                                            {"hip", "thigh", "upper hind leg"},
                                            {"knee", "shin", "lower hind leg"},
                                            {"ankle", "foot", "hind foot"},
                                            {"toe", "foot", "hind foot"}}};

std::string with_side(Side side, std::string_view word) {
  return (side == Side::kLeft ? "left " : side == Side::kRight ? "right " : "") + std::string(word);
}

Side take_side(std::string_view& role) {
  for (const auto& [prefix, side] :
       {std::pair{std::string_view("left_"), Side::kLeft}, std::pair{std::string_view("right_"), Side::kRight}}) {
    if (!role.starts_with(prefix)) continue;
    role.remove_prefix(prefix.size());
    return side;
  }
  return Side::kNone;
}

Side to_side(NamedSide side) {
  return side == NamedSide::kLeft ? Side::kLeft : side == NamedSide::kRight ? Side::kRight : Side::kNone;
}

bool is_digit_or_end(Word word) {
  return word == Word::kHand || word == Word::kFinger || word == Word::kFoot || word == Word::kToe;
}

// The part that a word of the body's middle means; empty for another word.
std::string middle_part(Word word) {
  switch (word) {
    case Word::kPelvis:
      return "hips";
    case Word::kSpine:
      return "abdomen";
    case Word::kChest:
      return "chest";
    case Word::kNeck:
      return "neck";
    case Word::kHead:
      return "head";
    case Word::kTail:
      return "tail";
    default:
      return {};
  }
}

// The same of a role.
std::string middle_part(const std::string& role) {
  if (role == "pelvis") return "hips";
  if (role == "spine") return "abdomen";
  if (role == "chest" || role == "neck" || role == "head") return role;
  return role.starts_with("tail") ? "tail" : "";
}

// Names the body part for the role of a limb's joint. Empty for other roles.
PartName limb_segment(std::string_view role, BodyKind kind) {
  const Side side = take_side(role);
  for (const Segment& segment : kSegments) {
    if (side == Side::kNone || segment.role != role) continue;
    return {with_side(side, kind == BodyKind::kQuadruped ? segment.quadruped : segment.biped), side};
  }
  return {};
}

bool is_numbered(const RoleLimb& limb) { return std::isdigit(static_cast<unsigned char>(limb.name.back())) != 0; }

Side side_of(const RoleLimb& limb) { return limb.left ? Side::kLeft : Side::kRight; }

// The part of a thing that is no limb and no trunk. A skirt or hair is one thing on both sides. Ears and wings without
// a side are several.
PartName thing_part(const Hint& hint, Side side) {
  const bool is_pair = hint.thing == "ear" || hint.thing == "wing";
  if (is_pair && side == Side::kNone) return {std::string(hint.thing) + "s"};
  const bool is_weapon = hint.word == Word::kAttachment;
  if (!is_pair && hint.thing != "sleeve" && !is_weapon) side = Side::kNone;
  return {with_side(side, hint.thing), side, is_weapon};
}

// Names the nodes of one rig, parents first.
class Namer {
 public:
  Namer(const SourceRig& rig, const Roles& roles) : rig_(rig), roles_(roles) {
    std::vector<std::string> names;
    for (const Node& node : rig.nodes) names.push_back(node.name);
    hints_ = read_names(names);
    for (const RoleLimb& limb : roles.limbs) {
      if (limb.name == "neck" || limb.name == "tail") continue;
      has_limbs_ = true;
      has_many_legs_ = has_many_legs_ || is_numbered(limb);
    }
  }

  std::vector<PartName> run() {
    for (std::size_t n = 0; n < rig_.nodes.size(); ++n) {
      PartName own = own_part(static_cast<int>(n));
      if (const int parent = rig_.nodes[n].parent; own.name.empty() && parent >= 0) {
        own = parts_[static_cast<std::size_t>(parent)];
        own.inherited = true;
      }
      parts_.push_back(std::move(own));
    }
    return std::move(parts_);
  }

 private:
  // The name that a node's role and name give. Empty if the node belongs to its ancestor's part.
  PartName own_part(int node) const {
    const NodeRole& role = role_of(node);
    const std::string& name = rig_.nodes[static_cast<std::size_t>(node)].name;
    const Hint& hint = hints_[static_cast<std::size_t>(node)];
    const bool is_nameless = hint.thing.empty() && !is_of_body(hint.word);
    // One hand may have several weapons with meshes of their own: the artist's names tell them apart.
    const bool is_mesh_of_name =
        rig_.nodes[static_cast<std::size_t>(node)].is_attachment && (is_nameless || hint.word == Word::kAttachment);
    const bool is_in_slot = hint.thing.empty() && (role.role == "attachment" || hangs_on_slot(node));
    if (is_mesh_of_name || is_in_slot) return {name, parent_side(node), true};
    if (!hint.thing.empty() && (hint.thing == "wing" || !is_in_body(role))) return thing(node, hint);
    if (PartName limb = limb_part(node, hint); !limb.name.empty()) return limb;
    return middle(node, hint, name);
  }

  // A joint of a limb, the trunk, the neck or the head, or above them all.
  static bool is_in_body(const NodeRole& role) {
    const std::string& r = role.role;
    return r != "other" && r != "attachment" && r != "hair" && r != "head_part" && r != "twist" && r != "control";
  }

  // A thing's further joints need not say its side again. A tail on the head is hair.
  PartName thing(int node, const Hint& hint) const {
    if (hint.thing == "tail" && role_of(node).role == "head_part") return {"hair"};
    const int parent = rig_.nodes[static_cast<std::size_t>(node)].parent;
    if (hint.side != NamedSide::kNone || parent < 0) return thing_part(hint, to_side(hint.side));
    if (parts_[static_cast<std::size_t>(parent)].name.ends_with(hint.thing)) return {};
    return thing_part(hint, hint.word == Word::kAttachment ? parent_side(node) : Side::kNone);
  }

  PartName limb_part(int node, const Hint& hint) const {
    const NodeRole& role = role_of(node);
    PartName segment = limb_segment(role.role, roles_.kind);
    if (role.limb < 0) return segment;
    const RoleLimb& limb = roles_.limbs[static_cast<std::size_t>(role.limb)];
    if (is_numbered(limb) && (role.role == "limb" || !segment.name.empty())) return numbered(node, limb);
    // A rig without a hand has its fingers on the forearm.
    if (role.role == "twist" && is_digit_or_end(hint.word) && !is_numbered(limb)) {
      const bool foot = hint.word == Word::kFoot || hint.word == Word::kToe;
      return limb_segment(std::string(limb.left ? "left_" : "right_") + (foot ? "ankle" : "wrist"), roles_.kind);
    }
    return segment;
  }

  // One of several legs or arms of a side: "left leg 2 thigh".
  static PartName numbered(int node, const RoleLimb& limb) {
    const auto at = std::find(limb.nodes.begin(), limb.nodes.end(), node) - limb.nodes.begin();
    std::string name = limb.name;
    std::replace(name.begin(), name.end(), '_', ' ');
    const bool arm = name.find(" arm ") != std::string::npos;
    const bool is_end = at == std::ssize(limb.nodes) || (limb.extremity >= 0 && at >= limb.extremity);
    if (at == 0) return {name + (arm ? " upper arm" : " thigh"), side_of(limb)};
    if (is_end) return {name + (arm ? " hand" : " foot"), side_of(limb)};
    return {name + (arm ? " forearm" : " shin"), side_of(limb)};
  }

  PartName middle(int node, const Hint& hint, const std::string& name) const {
    const NodeRole& role = role_of(node);
    const std::string& r = role.role;
    const bool trunk = r == "pelvis" || r == "spine" || r == "chest";
    if (trunk || r == "neck" || r == "head") {
      // Without limbs nothing tells where on the trunk a bone is; and a finger is no head, whatever the rig's shape.
      if (is_digit_or_end(hint.word) || (trunk && !has_limbs_)) return {name};
      if (has_many_legs_ && (r == "pelvis" || r == "spine")) return {"body"};
      // Rigs disagree about where the hips end and the chest begins: an outspoken name decides.
      if (r == "spine" && (hint.word == Word::kPelvis || hint.word == Word::kChest)) return {middle_part(hint.word)};
    }
    if (r == "hair") return {r};
    if (r == "head_part" && hint.word == Word::kNone) return {};  // of the head, or of a thing on the head
    if (r == "eye" || r == "jaw" || r == "head_part") return {"head"};
    if (r != "other" || role.limb >= 0) return {middle_part(r)};
    if (is_digit_or_end(hint.word)) return {name, to_side(hint.side)};
    if (repeats_parent(node)) return {};
    return {middle_part(hint.word)};
  }

  // A twist joint of the topmost spine joint is named a spine too, and is of the chest.
  bool repeats_parent(int node) const {
    const int parent = rig_.nodes[static_cast<std::size_t>(node)].parent;
    if (parent < 0) return false;
    const auto above = static_cast<std::size_t>(parent);
    return !parts_[above].name.empty() && hints_[above].word == hints_[static_cast<std::size_t>(node)].word;
  }
  // A weapon's own joints are the weapon's, whatever hangs in a slot is a thing of its own.
  bool hangs_on_slot(int node) const {
    const int parent = rig_.nodes[static_cast<std::size_t>(node)].parent;
    return parent >= 0 && role_of(parent).role == "attachment" && role_of(node).role == "other" &&
           hints_[static_cast<std::size_t>(parent)].thing.empty();
  }
  const NodeRole& role_of(int node) const { return roles_.of_node[static_cast<std::size_t>(node)]; }
  Side parent_side(int node) const {
    const int parent = rig_.nodes[static_cast<std::size_t>(node)].parent;
    return parent < 0 ? Side::kNone : parts_[static_cast<std::size_t>(parent)].side;
  }

  const SourceRig& rig_;
  const Roles& roles_;
  std::vector<Hint> hints_;
  bool has_limbs_ = false, has_many_legs_ = false;
  std::vector<PartName> parts_;
};

}  // namespace

std::vector<PartName> name_parts(const SourceRig& rig, const Roles& roles) { return Namer(rig, roles).run(); }

std::vector<PartName> name_meshes(const std::vector<std::string>& names) {
  constexpr std::array<std::string_view, 5> kWorn{"backpack", "bag", "hat", "helmet", "skirt"};
  std::vector<PartName> out;
  for (const Hint& hint : read_names(names)) {
    const bool is_worn = std::find(kWorn.begin(), kWorn.end(), hint.thing) != kWorn.end();
    const bool is_part = !hint.thing.empty() && (hint.word != Word::kCloth || is_worn);
    out.push_back(is_part ? thing_part(hint, to_side(hint.side)) : PartName{});
  }
  return out;
}

int mobility_of(const std::string& part) {
  // By how names end; the longer of two ends comes first.
  constexpr std::pair<std::string_view, int> kMobility[]{
      {"forefoot", 8}, {"hand", 8},  {"lower foreleg", 7},  {"forearm", 7},  {"upper foreleg", 6},
      {"arm", 6},      {"foot", 5},  {"lower hind leg", 4}, {"shin", 4},     {"leg", 3},
      {"thigh", 3},    {"head", 2},  {"neck", 1},           {"shoulder", 1}, {"hips", 0},
      {"abdomen", 0},  {"chest", 0}, {"body", 0},           {"torso", 0}};
  for (const auto& [end, mobility] : kMobility) {
    if (part.ends_with(end)) return mobility;
  }
  return -1;
}

PartName name_part(const std::string& joint) {
  PartName limb = limb_segment(joint, BodyKind::kBiped);
  return limb.name.empty() ? PartName{middle_part(joint)} : limb;
}

}  // namespace spherechain::baker

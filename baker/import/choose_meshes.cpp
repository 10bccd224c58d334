// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/choose_meshes.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <set>

#include "baker/import/named_file.h"
#include "baker/import/notes.h"
#include "baker/mesh/error.h"

namespace spherechain::baker {
namespace {

// "body_LOD1": what it is a level of, and how coarse it is.
struct Level {
  std::string of;
  int number;
};

bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

std::size_t digits_at_end(const std::string& text) {
  std::size_t count = 0;
  while (count < text.size() && is_digit(text[text.size() - 1 - count])) ++count;
  return count;
}

std::optional<Level> level_of(std::string name) {
  for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  // "body_lod1.001" is Blender's name for a second one.
  if (const std::size_t digits = digits_at_end(name); digits == 3 && name.size() > 3 && name[name.size() - 4] == '.')
    name.resize(name.size() - 4);
  const std::size_t digits = digits_at_end(name);
  constexpr std::size_t kDigitsMax = 2;
  if (digits == 0 || digits > kDigitsMax) return {};
  const int number = std::stoi(name.substr(name.size() - digits));
  name.resize(name.size() - digits);
  const auto drop_separator = [&] {
    if (!name.empty() && std::string_view("_- .").find(name.back()) != std::string_view::npos) name.pop_back();
  };
  drop_separator();
  if (!name.ends_with("lod")) return {};
  name.resize(name.size() - 3);
  if (!name.empty() && std::isalpha(static_cast<unsigned char>(name.back())) != 0) return {};  // "explod1"
  drop_separator();
  return Level{name, number};
}

// The level of each node: its own, or that of the nearest ancestor that has one.
std::vector<std::optional<Level>> levels_of(const std::vector<Node>& nodes) {
  std::vector<std::optional<Level>> out;
  for (const Node& node : nodes) {
    out.push_back(level_of(node.name));
    if (!out.back() && node.parent >= 0) out.back() = out[static_cast<std::size_t>(node.parent)];
  }
  return out;
}

void leave_out_coarse(const std::vector<Node>& nodes, const std::vector<ShownMesh>& meshes, std::vector<bool>& chosen,
                      const std::string& file) {
  const std::vector<std::optional<Level>> of_node = levels_of(nodes);
  std::vector<std::optional<Level>> levels;
  std::map<std::string, int> finest;
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    levels.push_back(level_of(meshes[m].name));
    if (!levels.back()) levels.back() = of_node[meshes[m].node];
    if (!chosen[m] || !levels[m]) continue;
    const auto known = finest.try_emplace(levels[m]->of, levels[m]->number).first;
    known->second = std::min(known->second, levels[m]->number);
  }
  std::size_t left_out = 0;
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    const bool is_coarse = meshes[m].is_coarse || (levels[m] && levels[m]->number != finest[levels[m]->of]);
    if (!chosen[m] || !is_coarse) continue;
    chosen[m] = false;
    ++left_out;
  }
  if (left_out == 0) return;
  add_note(file + ": has levels of detail: the finest is read, and " +
           (left_out == 1 ? "1 coarser mesh is" : std::to_string(left_out) + " coarser meshes are") + " left out");
}

// Says of each mesh whether `character` is the name of its skin, or of a node at or above the mesh or its skeleton.
std::vector<bool> taken_by(const std::string& character, const std::vector<Node>& nodes,
                           const std::vector<ShownMesh>& meshes) {
  std::vector<bool> is_below;  // a node of that name
  for (const Node& node : nodes) {
    is_below.push_back(node.name == character || (node.parent >= 0 && is_below[static_cast<std::size_t>(node.parent)]));
  }
  std::vector<bool> out;
  for (const ShownMesh& mesh : meshes) {
    out.push_back(mesh.skin == character || (mesh.node != kNoIndex && is_below[mesh.node]) ||
                  (mesh.top_joint != kNoIndex && is_below[mesh.top_joint]));
  }
  return out;
}

// Returns for each mesh the highest joint at or above its skeleton. Clothes on a part of a skeleton have the body's.
std::vector<Index> skeletons_of(const std::vector<Node>& nodes, const std::vector<ShownMesh>& meshes) {
  std::vector<bool> is_joint(nodes.size(), false);
  for (const ShownMesh& mesh : meshes) {
    if (mesh.top_joint != kNoIndex) is_joint[mesh.top_joint] = true;
  }
  std::vector<Index> highest(nodes.size(), kNoIndex);
  for (Index n = 0; n < nodes.size(); ++n) {
    if (nodes[n].parent >= 0) highest[n] = highest[static_cast<std::size_t>(nodes[n].parent)];
    if (highest[n] == kNoIndex && is_joint[n]) highest[n] = n;
  }
  std::vector<Index> out;
  for (const ShownMesh& mesh : meshes) out.push_back(mesh.top_joint == kNoIndex ? kNoIndex : highest[mesh.top_joint]);
  return out;
}

// The name that takes the meshes of one skeleton, and of no other one: its highest joint's, that of a node above, or
// one that a mesh or its skin has.
std::string name_to_take(Index skeleton, const std::vector<Node>& nodes, const std::vector<ShownMesh>& meshes,
                         const std::vector<Index>& skeletons) {
  constexpr int kAboveMax = 8;
  std::vector<std::string> names;
  int node = static_cast<int>(skeleton);
  for (int i = 0; i < kAboveMax && node >= 0; ++i, node = nodes[static_cast<std::size_t>(node)].parent) {
    names.push_back(nodes[static_cast<std::size_t>(node)].name);
  }
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    if (skeletons[m] != skeleton || meshes[m].node == kNoIndex) continue;
    names.push_back(nodes[meshes[m].node].name);
    names.push_back(meshes[m].skin);
  }
  for (const std::string& name : names) {
    const std::vector<bool> taken = taken_by(name, nodes, meshes);
    bool is_right = !name.empty();
    for (std::size_t m = 0; m < meshes.size() && is_right; ++m) {
      is_right = skeletons[m] == kNoIndex || taken[m] == (skeletons[m] == skeleton);
    }
    if (is_right) return name;
  }
  return names.front();
}

std::string quoted_list(const std::vector<std::string>& names) {
  constexpr std::size_t kNamed = 8;
  std::string out;
  for (std::size_t i = 0; i < std::min(names.size(), kNamed); ++i) out += (i > 0 ? ", " : "") + in_quotes(names[i]);
  return names.size() > kNamed ? out + " ..." : out;
}

std::string choices_of(const std::vector<Node>& nodes, const std::vector<ShownMesh>& meshes) {
  const std::vector<Index> skeletons = skeletons_of(nodes, meshes);
  constexpr std::size_t kLookedAtMax = 64;
  std::set<std::string> names;
  for (std::size_t m = 0; m < std::min(meshes.size(), kLookedAtMax); ++m) {
    names.insert(skeletons[m] == kNoIndex ? nodes[meshes[m].node].name
                                          : name_to_take(skeletons[m], nodes, meshes, skeletons));
  }
  return quoted_list({names.begin(), names.end()});
}

bool stand_apart(const Eigen::AlignedBox3d& a, const Eigen::AlignedBox3d& b, const Vec3& up) {
  constexpr double kAlike = 0.5, kShared = 0.5;  // of the smaller one's extent
  Eigen::Index vertical = 0;
  up.cwiseAbs().maxCoeff(&vertical);
  const Vec3 sizes_a = a.sizes(), sizes_b = b.sizes(), least = sizes_a.cwiseMin(sizes_b);
  // A sword or a hat is no second character.
  if (least[vertical] < kAlike * std::max(sizes_a[vertical], sizes_b[vertical])) return false;
  const Vec3 shared = a.max().cwiseMin(b.max()) - a.min().cwiseMax(b.min());
  for (Eigen::Index k = 0; k < 3; ++k) {
    if (k != vertical && shared[k] < kShared * least[k]) return true;
  }
  return false;
}

}  // namespace

std::vector<bool> choose_meshes(const std::vector<Node>& nodes, const std::vector<ShownMesh>& meshes,
                                const std::string& character, const std::string& file) {
  std::vector<bool> chosen(meshes.size(), character.empty());
  if (!character.empty()) {
    const auto is_any = [&] { return std::find(chosen.begin(), chosen.end(), true) != chosen.end(); };
    chosen = taken_by(character, nodes, meshes);
    if (!is_any()) {  // several nodes may show one mesh: its own name comes last
      for (std::size_t m = 0; m < meshes.size(); ++m) chosen[m] = meshes[m].name == character;
    }
    if (!is_any() && !meshes.empty()) {
      throw Error(ExitCode::kFile, file + ": has no character " + in_quotes(character) + " (--character takes " +
                                       choices_of(nodes, meshes) + ")");
    }
  }
  leave_out_coarse(nodes, meshes, chosen, file);
  return chosen;
}

std::vector<std::string> characters_in(const std::vector<Node>& nodes, const std::vector<SkinnedBox>& skinned,
                                       const Vec3& up) {
  std::vector<ShownMesh> meshes;
  for (const SkinnedBox& one : skinned) meshes.push_back(one.mesh);
  const std::vector<Index> skeletons = skeletons_of(nodes, meshes);
  std::map<Index, Eigen::AlignedBox3d> bodies;
  for (std::size_t m = 0; m < meshes.size(); ++m) bodies[skeletons[m]].extend(skinned[m].box);
  std::vector<Index> apart;
  constexpr std::size_t kMax = 16;
  for (const auto& [joint, box] : bodies) {
    if (apart.size() == kMax) break;
    if (std::all_of(apart.begin(), apart.end(), [&](Index other) { return stand_apart(bodies[other], box, up); }))
      apart.push_back(joint);
  }
  std::vector<std::string> out;
  for (const Index joint : apart) out.push_back(name_to_take(joint, nodes, meshes, skeletons));
  return out.size() > 1 ? out : std::vector<std::string>();
}

std::string characters_text(const std::vector<std::string>& names) {
  return "has " + std::to_string(names.size()) + " characters (" + quoted_list(names) + ")";
}

void note_characters(const std::vector<Node>& nodes, const std::vector<SkinnedBox>& skinned, const Vec3& up,
                     const std::string& file) {
  const std::vector<std::string> names = characters_in(nodes, skinned, up);
  if (names.empty()) return;
  add_note(file + ": " + characters_text(names) + " that are taken for one body (--character NAME takes one)");
}

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/filter/srdf.h"

#include <fmt/format.h>

#include <algorithm>

namespace spherechain::baker {
namespace {

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

// Null where the pair needs a test.
const char* reason_of(PairKind kind) {
  if (needs_test(kind)) return nullptr;
  if (kind == PairKind::kAdjacent) return "Adjacent";
  return kind == PairKind::kAlways ? "Always" : "Never";
}

}  // namespace

std::string srdf_of(const PartFilter& filter, const SourceRig& robot) {
  // Body parts have the names of their bones' nodes.
  std::vector<std::size_t> part_of_bone;
  for (const Bone& bone : robot.bones) {
    const auto part = std::find(filter.parts.begin(), filter.parts.end(), robot.nodes[bone.node].name);
    part_of_bone.push_back(static_cast<std::size_t>(part - filter.parts.begin()));
  }
  std::string out = fmt::format("<?xml version=\"1.0\"?>\n<!-- Written by spherechain -->\n<robot name=\"{}\">\n",
                                escaped(robot.robot.name));
  const std::vector<Index>& bone_of = robot.robot.bone_of;
  for (std::size_t a = 0; a < robot.nodes.size(); ++a) {
    for (std::size_t b = a + 1; b < robot.nodes.size(); ++b) {
      if (bone_of[a] == kNoIndex || bone_of[b] == kNoIndex) continue;
      const std::size_t part_a = part_of_bone[bone_of[a]], part_b = part_of_bone[bone_of[b]];
      if (std::max(part_a, part_b) >= filter.parts.size()) continue;  // no triangle of it is left
      const char* const reason = part_a == part_b ? "Adjacent" : reason_of(filter.of(part_a, part_b).kind);
      if (reason == nullptr) continue;
      out += fmt::format("  <disable_collisions link1=\"{}\" link2=\"{}\" reason=\"{}\"/>\n",
                         escaped(robot.nodes[a].name), escaped(robot.nodes[b].name), reason);
    }
  }
  return out + "</robot>\n";
}

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "baker/report/json_text.h"
#include "baker/report/report.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

std::string limb_name(const Roles& roles, int limb) { return limb < 0 ? "" : roles.limbs[limb].name; }

std::string dump(const ordered_json& json) { return json_text(json, 2) + "\n"; }

}  // namespace

std::string roles_text(const SourceRig& rig, const Roles& roles) {
  std::vector<std::array<std::string, 5>> rows{{"node", "parent", "role", "limb", "reason"}};
  for (std::size_t n = 0; n < rig.nodes.size(); ++n) {
    const int parent = rig.nodes[n].parent;
    const NodeRole& role = roles.of_node[n];
    rows.push_back({rig.nodes[n].name, parent < 0 ? "" : rig.nodes[parent].name, role.role, limb_name(roles, role.limb),
                    role.reason});
  }
  std::array<std::size_t, 4> widths{};
  for (const auto& row : rows) {
    for (std::size_t k = 0; k < widths.size(); ++k) widths[k] = std::max(widths[k], row[k].size());
  }
  std::string text =
      fmt::format("{}, {} nodes, {} limbs\n", body_kind_name(roles.kind), rig.nodes.size(), roles.limbs.size());
  for (const auto& row : rows) {
    for (std::size_t k = 0; k < widths.size(); ++k) text += fmt::format("{:{}}  ", row[k], widths[k]);
    text += row[4] + "\n";
  }
  return text;
}

std::string roles_json(const SourceRig& rig, const Roles& roles) {
  const auto names = [&](const std::vector<int>& nodes) {
    ordered_json list = ordered_json::array();
    for (const int n : nodes) list.push_back(rig.nodes[n].name);
    return list;
  };
  ordered_json out;
  out["kind"] = body_kind_name(roles.kind);
  out["nodes"] = ordered_json::array();
  for (std::size_t n = 0; n < rig.nodes.size(); ++n) {
    const NodeRole& role = roles.of_node[n];
    const int parent = rig.nodes[n].parent;
    out["nodes"].push_back({{"name", rig.nodes[n].name},
                            {"parent", parent < 0 ? ordered_json() : ordered_json(parent)},
                            {"role", role.role},
                            {"limb", role.limb < 0 ? ordered_json() : ordered_json(limb_name(roles, role.limb))},
                            {"reason", role.reason}});
  }
  out["limbs"] = ordered_json::array();
  for (const RoleLimb& limb : roles.limbs) out["limbs"].push_back({{"name", limb.name}, {"nodes", names(limb.nodes)}});
  out["trunk"] = names(roles.trunk);
  out["neck_head"] = names(roles.neck_head);
  return dump(out);
}

}  // namespace spherechain::baker

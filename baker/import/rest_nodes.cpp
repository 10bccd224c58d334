// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/rest_nodes.h"

#include <nlohmann/json.hpp>

#include "baker/import/glb_file.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

std::vector<double> numbers_of(const ordered_json& node, const char* name, std::vector<double> otherwise) {
  const ordered_json& list = entry_of(node, name);
  return list.size() == otherwise.size() ? list.get<std::vector<double>>() : otherwise;
}

Affine local_of(const ordered_json& node) {
  if (node.contains("matrix")) {
    const std::vector<double> m = numbers_of(node, "matrix", std::vector<double>(16, 0));
    return Affine(Eigen::Matrix4d(m.data()).topRows<3>());
  }
  const std::vector<double> t = numbers_of(node, "translation", {0, 0, 0}),
                            r = numbers_of(node, "rotation", {0, 0, 0, 1}), s = numbers_of(node, "scale", {1, 1, 1});
  Affine out;
  out.linear() =
      Eigen::Quaterniond(r[3], r[0], r[1], r[2]).normalized().toRotationMatrix() * Vec3(s.data()).asDiagonal();
  out.translation() = Vec3(t.data());
  return out;
}

}  // namespace

RestNodes::RestNodes(const ordered_json& json) {
  const ordered_json& nodes = entry_of(json, "nodes");
  parent_.assign(nodes.size(), -1);
  children_.resize(nodes.size());
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    local_.push_back(local_of(nodes[n]));
    for (const ordered_json& child : entry_of(nodes[n], "children")) {
      parent_.at(child.get<std::size_t>()) = static_cast<int>(n);
      children_[n].push_back(child.get<int>());
    }
  }
}

Affine RestNodes::world(int node) const {
  Affine out = Affine::Identity();
  for (; node >= 0 && static_cast<std::size_t>(node) < local_.size(); node = parent_[static_cast<std::size_t>(node)]) {
    out = local_[static_cast<std::size_t>(node)] * out;
  }
  return out;
}

void RestNodes::add_below(int node, std::vector<int>& out) const {
  const auto count = static_cast<int>(children_.size());
  std::vector<int> open;
  const auto add_children = [&](int of) {
    if (of < 0 || of >= count) return;
    const std::vector<int>& children = children_[static_cast<std::size_t>(of)];
    open.insert(open.end(), children.rbegin(), children.rend());
  };
  for (add_children(node); !open.empty();) {
    const int next = open.back();
    open.pop_back();
    out.push_back(next);
    add_children(next);
  }
}

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "baker/import/source_rig.h"

namespace spherechain::baker {

// Where a glTF's nodes stand as the file has them.
class RestNodes {
 public:
  explicit RestNodes(const nlohmann::ordered_json& json);

  // A node's space -> the scene's. The map is the identity for a number that is no node's.
  Affine world(int node) const;

  // Appends all nodes below one.
  void add_below(int node, std::vector<int>& out) const;

 private:
  std::vector<Affine> local_;
  std::vector<int> parent_;
  std::vector<std::vector<int>> children_;
};

}  // namespace spherechain::baker

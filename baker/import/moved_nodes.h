// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "baker/import/source_rig.h"

namespace spherechain::baker {

// A scene may have many more nodes than bones, and few that move: the nodes that a pose must compute. They are moved
// themselves, or hang on a node that is, and a bone or a wanted node is at or below them.
class MovedNodes {
 public:
  MovedNodes() = default;
  // `moves`: of each node, whether its own transform changes. `wanted`: nodes besides those of the bones.
  MovedNodes(const SourceRig& rig, const std::vector<std::uint8_t>& moves, const std::vector<Index>& wanted = {});

  const std::vector<Index>& list() const { return list_; }  // parents first
  // The place of a node in the list, or -1.
  int place(Index node) const { return place_[node]; }
  // A node's transform into the scene; `moved`: of those of the list, or of the first of them.
  const Affine& world(Index node, const std::vector<Affine>& moved) const {
    return place_[node] < 0 ? rest_[node] : moved[static_cast<std::size_t>(place_[node])];
  }
  // Each bone's transform of the rest positions.
  std::vector<Affine> deformation(const SourceRig& rig, const std::vector<Affine>& moved) const;

 private:
  std::vector<Index> list_, moved_bones_;
  std::vector<int> place_;
  std::vector<Affine> rest_, bones_at_rest_;
};

}  // namespace spherechain::baker

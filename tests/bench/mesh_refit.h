// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "character.h"

namespace spherechain::bench {

// Goal P3's peer: Embree's tree of the mesh's own triangles, refitted to a pose's vertices, which are copied to it
// first. On one thread.
class MeshRefit {
 public:
  // The meshes outlive this.
  MeshRefit(const PosedCharacter& character, const std::vector<std::vector<float>>& meshes);
  ~MeshRefit();
  void refit(std::size_t mesh);
  // Is the tree's box that of this mesh?
  bool bounds(std::size_t mesh) const;

 private:
  struct Scene;
  std::unique_ptr<Scene> scene_;
};

}  // namespace spherechain::bench

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/layers/cover.h"
#include "baker/layers/posed_tree.h"
#include "baker/layers/rest_view.h"

namespace spherechain::baker {

// Skin of one primitive that shows through another one in a pose: triangles that hang together.
struct PokeSpot {
  Index inner, outer;            // runs of the skin
  std::vector<Index> triangles;  // of the inner one
  std::vector<double> areas;     // of each triangle in the pose
  double area = 0;               // of all
  double height = 0;             // of the triangle that is highest above its cover
  Vec3 point = Vec3::Zero();     // the middle
  Vec3 eye = Vec3::Zero();       // unit vector from there to an eye that sees most of the spot
};

// Finds skin that is hidden at rest below another primitive, and comes through it in a pose. Const calls may run in
// several threads. `skin` and `pokes` must outlive it. Primitives whose triangles have no bone in common are left out:
// the end of a limb swings in its socket.
class PokeFinder {
 public:
  PokeFinder(const LayeredSkin& skin, const RestView& rest, const std::vector<Cover>& covers, const PokeTest& pokes,
             const SourceRig& rig);

  // The spots that are at least 0.12 % of the height above their cover and 0.35 % of it, squared, large: 2 mm and
  // 1 cm2 on a body of 1.7 m. `positions`: of the source's vertices.
  std::vector<PokeSpot> find(const std::vector<Vec3>& positions) const;

  // False if no skin can come through another primitive: find() need not be called.
  bool has_work() const { return !tested_.empty(); }

 private:
  struct Skin {
    Index triangle, outer;  // run
  };
  struct Raised {
    Skin skin;
    double height;
  };
  std::vector<PokeSpot> connect(const std::vector<Raised>& above, const std::vector<Vec3>& positions) const;
  bool is_large(const PokeSpot& spot) const;

  const LayeredSkin& skin_;
  const PokeTest& pokes_;
  PosedTree tree_;
  std::vector<Skin> tested_;
};

}  // namespace spherechain::baker

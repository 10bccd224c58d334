// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "baker/layers/skin.h"

namespace spherechain::baker {

// The piece of the skin that lies over a triangle at rest.
struct Cover {
  Index triangle = kNoIndex;  // of that piece, nearest along the normal; kNoIndex: nothing covers the triangle
  bool is_pierced = false;    // the covered triangle has come through it
};

// The cover of each triangle. `is_inverted`: pieces whose triangles face inwards.
std::vector<Cover> find_covers(const LayeredSkin& skin, const std::vector<char>& is_inverted);

// The weight of the bones that move both triangles, 0 to 1.
double shared_weight(const SourceRig& rig, const Triangle& a, const Triangle& b);

// Tells which covered triangles have come through their cover in a pose. Const calls may run in several threads.
// `skin`, `is_inverted` and `covers` must outlive it.
class PokeTest {
 public:
  PokeTest(const LayeredSkin& skin, const std::vector<char>& is_inverted, const std::vector<Cover>& covers,
           const SourceRig& rig);

  // Normals of the welded vertices in a pose, outwards. `positions`: of the source's vertices.
  std::vector<Vec3> normals(const std::vector<Vec3>& positions) const;

  // False where heights tell nothing: the triangle has no cover, or one that moves in other ways.
  bool is_tested(Index triangle) const { return !near_[triangle].empty(); }

  // The distance of the triangle's middle from its cover; 0 where it is not above.
  double height_above(Index triangle, const std::vector<Vec3>& positions, const std::vector<Vec3>& normals) const;

  // True if the triangle's middle or one of its corners is above its cover, or hardly below.
  bool is_through(Index triangle, const std::vector<Vec3>& positions, const std::vector<Vec3>& normals) const;

 private:
  // A point over the nearest point of a cover.
  struct Height {
    double distance = 0;  // between the two
    double along = 0;     // part of it along the cover's normal; negative below
    bool is_on_rim = true;
    bool is_above() const;
    bool is_below() const;
  };
  Height height(Index triangle, const Vec3& point, const std::vector<Vec3>& positions,
                const std::vector<Vec3>& normals) const;

  const LayeredSkin& skin_;
  const std::vector<char>& is_inverted_;
  const std::vector<Cover>& covers_;
  std::vector<std::vector<Index>> near_;  // triangles of the cover near each covered triangle; empty: not tested
  std::vector<std::array<Index, 3>> neighbours_;
};

}  // namespace spherechain::baker

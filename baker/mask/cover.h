// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "baker/mask/skin.h"

namespace spherechain::baker {

// The piece of the skin that lies over a triangle at rest.
struct Cover {
  Index triangle = kNoIndex;  // of that piece, nearest along the normal; kNoIndex: nothing covers the triangle
  bool is_pierced = false;    // the covered triangle has come through it
};

// The cover of each triangle. `is_inverted`: pieces whose triangles face inwards.
std::vector<Cover> find_covers(const MaskSkin& skin, const std::vector<char>& is_inverted);

// Tells which covered triangles have come through their cover in a pose. Const calls may run in several threads. `skin`
// and `is_inverted` must outlive it.
class PokeTest {
 public:
  PokeTest(const MaskSkin& skin, const std::vector<char>& is_inverted, const std::vector<Cover>& covers,
           const SourceRig& rig);

  // Normals of the welded vertices in a pose, outwards. `positions`: of the source's vertices.
  std::vector<Vec3> normals(const std::vector<Vec3>& positions) const;

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

  const MaskSkin& skin_;
  const std::vector<char>& is_inverted_;
  std::vector<std::vector<Index>> near_;  // triangles of the cover near each covered triangle; empty: not tested
  std::vector<std::array<Index, 3>> neighbours_;
};

}  // namespace spherechain::baker

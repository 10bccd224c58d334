// SPDX-License-Identifier: GPL-3.0-or-later
#include "baked_person.h"

#include <cmath>

using namespace spherechain::baker;

const Bake& baked_person() {
  static const Bake result =
      bake("/usr/share/assimp/models/X/BCN_Epileptic.X", make_settings("balanced", R"({"body": "biped"})", "test"), {});
  return result;
}

const Bake& morphing_person() {
  static const Bake result = [] {
    Bake out = baked_person();
    SourceRig& rig = out.character.rig;
    const double height = out.regions.frame.height;
    for (int m = 0; m < 3; ++m) {
      Morph morph{"grows " + std::to_string(m), {}, {}, 0};
      for (Index v = 0; v < out.character.source_positions.size(); ++v) {
        if (v % 3 == static_cast<Index>(m)) continue;
        morph.vertices.push_back(v);
        morph.deltas.push_back(0.05 * height * Vec3(std::sin(v), std::cos(3.0 * v), m - 1));
      }
      rig.morphs.push_back(std::move(morph));
    }
    for (std::size_t v = 0; v < rig.weights.size(); v += 5) rig.weights[v] = {};
    return rebake(out, out.settings);
  }();
  return result;
}

// SPDX-License-Identifier: MIT
// What tests of refit from bones check, whatever the asset's refit rule.
#pragma once

#include <vector>

#include "jobs.h"
#include "palette.h"

namespace spherechain::test {

struct PosedAsset {
  TinyAsset tiny;
  TinySkin skin;
  std::vector<Matrix> matrices;
  std::vector<float> morph_weights;
};

Refitted refit_posed(const Asset& asset, const PosedAsset& s, RadiusKind radius, Target target = Target::kBest);

// Of both radii, on every target, bit for bit.
using Reference = std::vector<Sphere> (*)(const PosedAsset& s, RadiusKind radius);
void check_exact(const PosedAsset& s, Reference reference);

// Those that RefitJob makes of the skinned mesh, both radii; `tolerance` in the asset's units.
void check_against_mesh(const PosedAsset& s, double tolerance);

void check_close(const std::vector<Sphere>& spheres, const std::vector<Sphere>& expected, double tolerance);

// Every layout and stride, on every target, the same spheres; NaN between the matrices is not read.
void check_layouts(const PosedAsset& s);

// Entries past the asset's spheres stay, matrices past its bones are not read.
void check_longer_arrays(const PosedAsset& s);

}  // namespace spherechain::test

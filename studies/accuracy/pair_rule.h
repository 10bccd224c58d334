// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "baker/play/asset_file.h"

namespace spherechain::baker {

// Which pairs an asset would report with other radii, or another rule for what is near at rest. The asset's own:
//   a pair       |ca - cb| < ra + rb
//   a rest pair  that, and |ca - cb| < rest_scale * (ra + rb): come nearer than a part of its distance at rest
struct RuleChange {
  double scale = 1;                  // of every radius; rest pairs keep the distance they are reported at
  std::optional<double> rest_scale;  // the part of the distance at rest, whatever the asset says
};

// A plain loop over all spheres, apart from the runtime: with no change it reports what the runtime does, bit for bit.
//
// Where larger radii would report a pair sooner than at the asset's own part of its distance at rest, it becomes a near
// pair. That part is the median over the asset's rest pairs; 0.9 where it has none.
class PairRule {
 public:
  PairRule(const OpenAsset& asset, Radius radius, const RuleChange& change);

  // The pairs of spheres refitted at the same kind of radius; sorted.
  std::vector<Pair> pairs(const std::vector<Sphere>& spheres) const;

 private:
  struct Entry {
    Pair pair;
    float rest_scale;  // infinite where it is no rest pair
  };
  float scale_;
  std::vector<Entry> entries_;  // pairs that are not ignored, sorted
};

// Which spheres share a chain: the pairs that a test along the chains finds.
class ChainMembers {
 public:
  explicit ChainMembers(const OpenAsset& asset);

  bool share_one(const Pair& pair) const;
  std::vector<Pair> sharing(const std::vector<Pair>& pairs) const;  // those of spheres in a common chain

 private:
  std::vector<std::vector<bool>> in_;  // a chain's spheres
};

}  // namespace spherechain::baker

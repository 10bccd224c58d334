// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "baker/truth/score.h"
#include "pair_rule.h"

namespace spherechain::baker {

// The score under another rule: of all pairs, and of the pairs that share a chain.
struct CurvePoint {
  RuleChange change;
  Score chains, all_pairs;
};

// The radius scaled from 0.8 to 2, then rest pairs at 0.5 to 1 of their distance at rest.
class Curve {
 public:
  Curve(const OpenAsset& asset, Radius radius);

  // One frame; the depth of what is missed is not measured. `spheres` are refitted at the curve's radius.
  std::vector<CurvePoint> measure(const std::vector<Sphere>& spheres, const FrameTruth& truth,
                                  const std::function<bool(const Pair&)>& is_close,
                                  const std::function<bool(const Pair&)>& is_apart) const;

 private:
  ChainMembers chains_;
  std::vector<RuleChange> changes_;
  std::vector<PairRule> rules_;
};

// Adds one frame to what came before; `sum` may be empty.
void add(std::vector<CurvePoint>& sum, const std::vector<CurvePoint>& frame);

}  // namespace spherechain::baker

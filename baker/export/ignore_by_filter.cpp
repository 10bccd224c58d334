// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/export/ignore_by_filter.h"

#include <algorithm>
#include <map>
#include <utility>

namespace spherechain::baker {
namespace {

struct KindsOfBodies {
  bool any_always = false, any_tested = false;
};

}  // namespace

void ignore_by_filter(const PartFilter& filter, Colliders& colliders) {
  const auto body_of = [&](std::size_t part) {
    const auto& bodies = colliders.bodies;
    const auto it = std::find_if(bodies.begin(), bodies.end(),
                                 [&](const ColliderBody& body) { return body.name == filter.parts[part]; });
    return it->held_by >= 0 ? it->held_by : static_cast<int>(it - bodies.begin());
  };
  std::map<std::pair<int, int>, KindsOfBodies> found;
  for (const FilteredPair& pair : filter.pairs) {
    const int a = body_of(pair.parts[0]), b = body_of(pair.parts[1]);
    if (a == b) continue;
    KindsOfBodies& kinds = found[{std::min(a, b), std::max(a, b)}];
    kinds.any_always |= pair.kind == PairKind::kAlways;
    kinds.any_tested |= needs_test(pair.kind);
  }
  std::map<std::pair<int, int>, IgnoredReason> ignored;
  for (const auto& [pair, kinds] : found) {
    if (!kinds.any_tested) ignored[pair] = kinds.any_always ? IgnoredReason::kAlways : IgnoredReason::kNever;
  }
  for (const IgnoredBodies& pair : colliders.ignored) {
    if (pair.reason == IgnoredReason::kAdjacent || !ignored.contains({pair.a, pair.b})) {
      ignored[{pair.a, pair.b}] = pair.reason;
    }
  }
  colliders.ignored.clear();
  for (const auto& [pair, reason] : ignored) colliders.ignored.push_back({pair.first, pair.second, reason});
}

}  // namespace spherechain::baker

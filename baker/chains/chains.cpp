// SPDX-License-Identifier: GPL-3.0-or-later
#include "chains/chains.h"

#include <algorithm>

namespace spherechain::baker {
namespace {

using Ids = std::vector<std::uint32_t>;

Ids reversed(Ids ids) {
  std::reverse(ids.begin(), ids.end());
  return ids;
}

// Some of the torso's spheres, level by level from the bottom.
template <typename Wanted>
Ids of_torso(const Spheres& spheres, const Wanted& wanted) {
  Ids ids;
  for (const std::uint32_t i : spheres.of_region[kTorso]) {
    if (wanted(spheres.spheres[i])) ids.push_back(i);
  }
  return ids;
}

// A side of the torso from the top down.
Ids side_of_torso(const Spheres& spheres, bool left) {
  const Side other = left ? Side::kRight : Side::kLeft;
  return reversed(of_torso(spheres, [&](const FittedSphere& s) { return !s.extremity && s.side != other; }));
}

// A level from one side to the other.
Ids level_of_torso(const Spheres& spheres, bool top, bool from_left) {
  int level = 0;
  for (const std::uint32_t i : spheres.of_region[kTorso]) {
    if (top && !spheres.spheres[i].extremity) level = std::max(level, spheres.spheres[i].level);
  }
  const Ids ids = of_torso(spheres, [&](const FittedSphere& s) { return !s.extremity && s.level == level; });
  return from_left ? ids : reversed(ids);
}

// From the crown down.
Ids head(const Spheres& spheres) {
  return reversed(of_torso(spheres, [](const FittedSphere& s) { return s.extremity; }));
}

enum class Kind { kSide, kEnd, kDiagonal };

Kind kind_of(const LimbPlace& a, const LimbPlace& b) {
  if (a.top == b.top) return Kind::kEnd;
  return a.left == b.left ? Kind::kSide : Kind::kDiagonal;
}

// The torso's parts between two limbs; the upper limb, if one is, comes first.
std::vector<Ids> between(const Spheres& spheres, const LimbPlace& a, const LimbPlace& b) {
  switch (kind_of(a, b)) {
    case Kind::kEnd:
      return {level_of_torso(spheres, a.top, a.left)};
    case Kind::kSide:
      return {side_of_torso(spheres, a.left)};
    case Kind::kDiagonal:
      return {level_of_torso(spheres, true, a.left), side_of_torso(spheres, b.left)};
  }
  return {};
}

}  // namespace

std::size_t Chains::entries() const {
  std::size_t sum = 0;
  for (const Chain& chain : chains) sum += chain.spheres.size();
  return sum;
}

Chains build_chains(const Spheres& spheres, const std::vector<LimbPlace>& limbs) {
  Chains out;
  for (const Kind kind : {Kind::kSide, Kind::kEnd, Kind::kDiagonal}) {
    for (std::size_t i = 0; i < limbs.size(); ++i) {
      for (std::size_t j = i + 1; j < limbs.size(); ++j) {
        if (kind_of(limbs[i], limbs[j]) != kind) continue;
        const bool in_order = limbs[i].top || !limbs[j].top;
        const LimbPlace &upper = in_order ? limbs[i] : limbs[j], &lower = in_order ? limbs[j] : limbs[i];
        std::vector<Ids> parts{reversed(spheres.of_region[upper.region])};
        if (upper.top) parts.push_back(head(spheres));
        for (Ids& part : between(spheres, upper, lower)) parts.push_back(std::move(part));
        parts.push_back(spheres.of_region[lower.region]);

        Chain chain{"zeta" + std::to_string(out.chains.size()), {upper.region, kTorso, lower.region}, {}};
        for (const Ids& part : parts) {
          out.entries_table1 += part.size();
          for (const std::uint32_t id : part) {
            if (std::find(chain.spheres.begin(), chain.spheres.end(), id) == chain.spheres.end())
              chain.spheres.push_back(id);
          }
        }
        out.chains.push_back(std::move(chain));
      }
    }
  }
  return out;
}

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#include "chains/chains.h"

#include <algorithm>
#include <set>

namespace spherechain::baker {
namespace {

using Ids = std::vector<std::uint32_t>;

Ids reversed(Ids ids) {
  std::reverse(ids.begin(), ids.end());
  return ids;
}

// A side of the torso from the top down.
Ids side_of_torso(const Spheres& spheres, bool left) {
  Ids ids;
  for (const std::uint32_t i : spheres.of_region[kTorso]) {
    if (spheres.spheres[i].side == (left ? Side::kLeft : Side::kRight)) ids.push_back(i);
  }
  return reversed(std::move(ids));
}

// A level from one side to the other.
Ids level_of_torso(const Spheres& spheres, bool top, bool from_left) {
  const int level = top ? spheres.spheres[spheres.of_region[kTorso].back()].level : 0;
  Ids ids;
  for (const std::uint32_t i : spheres.of_region[kTorso]) {
    if (spheres.spheres[i].level == level) ids.push_back(i);
  }
  return from_left ? ids : reversed(std::move(ids));
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

std::vector<std::pair<std::uint32_t, std::uint32_t>> Chains::neighbours() const {
  std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const Chain& chain : chains) {
    for (std::size_t i = 1; i < chain.spheres.size(); ++i) {
      pairs.insert(std::minmax(chain.spheres[i - 1], chain.spheres[i]));
    }
  }
  return {pairs.begin(), pairs.end()};
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

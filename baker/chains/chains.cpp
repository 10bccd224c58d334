// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/chains/chains.h"

#include <algorithm>

namespace spherechain::baker {
namespace {

using Ids = std::vector<std::uint32_t>;

Ids reversed(Ids ids) {
  std::reverse(ids.begin(), ids.end());
  return ids;
}

// Some of the torso's spheres, without the head, level by level from the bottom.
template <typename Wanted>
Ids of_torso(const Spheres& spheres, const Wanted& wanted) {
  Ids ids;
  for (const std::uint32_t i : spheres.of_region[spheres.torso_region()]) {
    if (!spheres.spheres[i].extremity && wanted(spheres.spheres[i])) ids.push_back(i);
  }
  return ids;
}

// A side of the torso from a level down to another.
Ids side_of_torso(const Spheres& spheres, Side side, int from, int to) {
  return reversed(of_torso(
      spheres, [&](const FittedSphere& s) { return s.level <= from && s.level >= to && !opposite(s.side, side); }));
}

// A level from one side to the other.
Ids level_of_torso(const Spheres& spheres, int level, Side from) {
  const Ids ids = of_torso(spheres, [&](const FittedSphere& s) { return s.level == level; });
  return from == Side::kRight ? reversed(ids) : ids;
}

// From the crown down.
Ids head(const Spheres& spheres) {
  Ids ids;
  for (const std::uint32_t i : spheres.of_region[spheres.torso_region()]) {
    if (spheres.spheres[i].extremity) ids.push_back(i);
  }
  return reversed(ids);
}

enum class Kind { kSide, kEnd, kDiagonal };

Kind kind_of(const LimbPlace& a, const LimbPlace& b) {
  if (a.along == b.along) return Kind::kEnd;
  return opposite(a.side, b.side) ? Kind::kDiagonal : Kind::kSide;
}

// The torso's parts between two limbs; the upper limb comes first.
std::vector<Ids> between(const Spheres& spheres, const LimbPlace& a, const LimbPlace& b) {
  const int upper = spheres.level_at(a.along), lower = spheres.level_at(b.along);
  switch (kind_of(a, b)) {
    case Kind::kEnd:
      return {level_of_torso(spheres, upper, a.side)};
    case Kind::kSide:
      return {side_of_torso(spheres, a.side == Side::kNone ? b.side : a.side, upper, lower)};
    case Kind::kDiagonal:
      return {level_of_torso(spheres, upper, a.side), side_of_torso(spheres, b.side, upper, lower)};
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
  if (limbs.size() == 1) {
    const Ids& ids = spheres.of_region[limbs[0].region];
    out.chains.push_back({"zeta0", {limbs[0].region}, ids});
    out.entries_table1 = ids.size();
    return out;
  }
  const int top = spheres.level_at(1);
  for (const Kind kind : {Kind::kSide, Kind::kEnd, Kind::kDiagonal}) {
    for (std::size_t i = 0; i < limbs.size(); ++i) {
      for (std::size_t j = i + 1; j < limbs.size(); ++j) {
        if (kind_of(limbs[i], limbs[j]) != kind) continue;
        const bool in_order = limbs[i].along >= limbs[j].along;
        const LimbPlace &upper = in_order ? limbs[i] : limbs[j], &lower = in_order ? limbs[j] : limbs[i];
        std::vector<Ids> parts{reversed(spheres.of_region[upper.region])};
        if (spheres.level_at(upper.along) == top && upper.along > 0) parts.push_back(head(spheres));
        for (Ids& part : between(spheres, upper, lower)) parts.push_back(std::move(part));
        parts.push_back(spheres.of_region[lower.region]);

        Chain chain{
            "zeta" + std::to_string(out.chains.size()), {upper.region, spheres.torso_region(), lower.region}, {}};
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

Chains build_tree_chains(const Spheres& spheres, const std::vector<std::uint8_t>& parents) {
  const std::uint8_t root = spheres.torso_region();
  std::vector<bool> is_leaf(parents.size(), true);
  for (std::uint8_t region = 0; region < root; ++region) is_leaf[parents[region]] = false;
  is_leaf[root] = false;
  std::vector<std::vector<std::uint8_t>> ways;  // from each leaf to the root
  for (std::uint8_t leaf = 0; leaf < root; ++leaf) {
    if (!is_leaf[leaf]) continue;
    ways.push_back({leaf});
    while (ways.back().back() != root) ways.back().push_back(parents[ways.back().back()]);
  }
  if (ways.empty()) ways.push_back({root});

  Chains out;
  // `down`: regions in whose order from start to tip the chain goes on.
  const auto add = [&](const std::vector<std::uint8_t>& up, const std::vector<std::uint8_t>& down) {
    Chain chain{"zeta" + std::to_string(out.chains.size()), up, {}};
    for (const std::uint8_t region : up) {
      const Ids ids = reversed(spheres.of_region[region]);
      chain.spheres.insert(chain.spheres.end(), ids.begin(), ids.end());
    }
    for (const std::uint8_t region : down) {
      const Ids& ids = spheres.of_region[region];
      chain.regions.push_back(region);
      chain.spheres.insert(chain.spheres.end(), ids.begin(), ids.end());
    }
    out.entries_table1 += chain.spheres.size();
    out.chains.push_back(std::move(chain));
  };
  if (ways.size() == 1) add(ways[0], {});
  for (std::size_t i = 0; i < ways.size(); ++i) {
    for (std::size_t j = i + 1; j < ways.size(); ++j) {
      std::vector<std::uint8_t> up = ways[i], down = ways[j];
      std::uint8_t shared = root;
      while (!up.empty() && !down.empty() && up.back() == down.back()) {
        shared = up.back();
        up.pop_back();
        down.pop_back();
      }
      up.push_back(shared);
      std::reverse(down.begin(), down.end());
      add(up, down);
    }
  }
  return out;
}

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/layers/poke_finder.h"

#include <algorithm>
#include <map>
#include <optional>

#include "baker/layers/views.h"
#include "baker/mesh/surface_query.h"

namespace spherechain::baker {
namespace {

// Lengths are shares of the height, areas of its square.
constexpr double kHeightMin = 0.0012;
constexpr double kAreaMin = 3.5e-5;
constexpr double kSeenMin = 0.025;  // of a triangle's area, mean over the views: less is a fold; free skin has .25
constexpr double kBareMin = 0.02;   // the same at rest: more is no hidden skin
constexpr double kHem = 0.012;      // from skin that is seen at rest
constexpr double kAlikeMin = 0.02;  // weight of common bones: without it a limb ends in its socket

Vec3 cross_of(const Triangle& v, const std::vector<Vec3>& positions) {
  return (positions[v[1]] - positions[v[0]]).cross(positions[v[2]] - positions[v[0]]);
}

void add(PokeSpot& spot, Index triangle, double area) {
  spot.triangles.push_back(triangle);
  spot.areas.push_back(area);
  spot.area += area;
}

// The triangles of `spot` that enough of the eyes see, and the eye that sees most of it.
PokeSpot seen_part(const PokeSpot& spot, const LayeredSkin& skin, const std::vector<Vec3>& positions,
                   const PosedTree& tree, const std::vector<Vec3>& eyes) {
  PokeSpot out{spot.inner, spot.outer, {}, {}, 0, spot.height, spot.point};
  std::vector<double> by_eye(eyes.size());
  for (std::size_t i = 0; i < spot.triangles.size(); ++i) {
    const Index t = spot.triangles[i];
    const Vec3 normal = cross_of(skin.rest.triangles[t], positions).normalized();
    double share = 0;
    for (std::size_t e = 0; e < eyes.size(); ++e) {
      const double cosine = skin.is_two_sided[t] != 0 ? std::abs(normal.dot(eyes[e])) : normal.dot(eyes[e]);
      if (cosine <= 0 || !tree.is_free(t, eyes[e])) continue;
      share += cosine / static_cast<double>(eyes.size());
      by_eye[e] += cosine * spot.areas[i];
    }
    if (share >= kSeenMin) add(out, t, spot.areas[i]);
  }
  out.eye = eyes[static_cast<std::size_t>(std::max_element(by_eye.begin(), by_eye.end()) - by_eye.begin())];
  return out;
}

}  // namespace

PokeFinder::PokeFinder(const LayeredSkin& skin, const RestView& rest, const std::vector<Cover>& covers,
                       const PokeTest& pokes, const SourceRig& rig)
    : skin_(skin), pokes_(pokes), tree_(skin) {
  std::map<Index, std::vector<Index>> bare, hidden;  // by run
  for (Index t = 0; t < covers.size(); ++t) {
    const Index cover = covers[t].triangle;
    if (cover == kNoIndex) {
      if (rest.seen[t] > kBareMin) bare[skin.run[t]].push_back(t);
    } else if (skin.run[cover] != skin.run[t] && !covers[t].is_pierced && pokes.is_tested(t) &&
               rest.seen[t] <= kBareMin &&
               shared_weight(rig, skin.rest.triangles[t], skin.rest.triangles[cover]) >= kAlikeMin) {
      hidden[skin.run[t]].push_back(t);
    }
  }
  for (const auto& [run, triangles] : hidden) {
    std::optional<SurfaceQuery> around;
    if (bare.contains(run)) around.emplace(skin.rest, bare[run]);
    for (const Index t : triangles) {
      if (around && around->closest(triangle_centroid(skin.rest, t)).distance < kHem * skin.height) continue;
      tested_.push_back({t, skin.run[covers[t].triangle]});
    }
  }
}

std::vector<PokeSpot> PokeFinder::find(const std::vector<Vec3>& positions) const {
  const std::vector<Vec3> normals = pokes_.normals(positions);
  std::vector<Raised> above;
  for (const Skin& skin : tested_) {
    const double height = pokes_.height_above(skin.triangle, positions, normals);
    if (height > 0) above.push_back({skin, height});
  }
  std::vector<PokeSpot> spots = connect(above, positions);
  if (spots.empty()) return spots;
  PosedTree tree = tree_;
  tree.pose(positions);
  const std::vector<Vec3> eyes = view_directions(skin_.up, 0);
  for (PokeSpot& spot : spots) spot = seen_part(spot, skin_, positions, tree, eyes);
  std::erase_if(spots, [&](const PokeSpot& spot) { return !is_large(spot); });
  return spots;
}

bool PokeFinder::is_large(const PokeSpot& spot) const {
  return spot.height >= kHeightMin * skin_.height && spot.area >= kAreaMin * skin_.height * skin_.height;
}

// Triangles below the same primitive hang together where they share a vertex.
std::vector<PokeSpot> PokeFinder::connect(const std::vector<Raised>& above, const std::vector<Vec3>& positions) const {
  std::vector<Index> parent(above.size());
  for (Index i = 0; i < parent.size(); ++i) parent[i] = i;
  const auto root = [&](Index i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  std::map<std::pair<Index, Index>, Index> at;  // by vertex and outer run
  for (Index i = 0; i < above.size(); ++i) {
    for (const Index v : skin_.welded.triangles[above[i].skin.triangle]) {
      parent[root(i)] = root(at.try_emplace({v, above[i].skin.outer}, i).first->second);
    }
  }
  std::map<Index, PokeSpot> spots;  // by root
  for (Index i = 0; i < above.size(); ++i) {
    const auto [triangle, outer] = above[i].skin;
    const Triangle& v = skin_.rest.triangles[triangle];
    PokeSpot& spot = spots.try_emplace(root(i), PokeSpot{skin_.run[triangle], outer, {}, {}}).first->second;
    const double area = cross_of(v, positions).norm() / 2;
    add(spot, triangle, area);
    spot.height = std::max(spot.height, above[i].height);
    spot.point += area / 3 * (positions[v[0]] + positions[v[1]] + positions[v[2]]);
  }
  std::vector<PokeSpot> out;
  for (auto& [first, spot] : spots) {
    if (!is_large(spot)) continue;
    spot.point /= spot.area;
    out.push_back(std::move(spot));
  }
  return out;
}

}  // namespace spherechain::baker

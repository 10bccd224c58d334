// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/layers/cover.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "baker/mesh/surface_query.h"
#include "baker/os/parallel.h"

namespace spherechain::baker {
namespace {

// Lengths are shares of the height.
constexpr double kReach = 0.06;        // a cover is not farther away
constexpr double kLining = 0.012;      // between the two sides of thick cloth
constexpr double kStep = 1e-6;         // off a surface, before the next ray
constexpr double kNear = 0.04;         // from the cover at rest to where it may be in a pose
constexpr double kHardlyBelow = 6e-4;  // what is drawn through the cover as often as not
constexpr double kAround = 0.02;       // of a triangle that has come through, where others are still below
constexpr double kBelowMin = 0.3;      // share of their area
constexpr double kOrderMin = 0.5;      // of two pieces each above the other in places: share of the larger area
constexpr double kTilt = 40 * std::numbers::pi / 180;
constexpr int kTilted = 6;          // rays
constexpr double kAlong = 0.7;      // cosine: a point that lies more aside is beyond a rim, not above or below
constexpr double kLike = 0.2;       // cosine between normals of a cover's triangles
constexpr double kSharedMin = 0.1;  // weight of bones that move both
constexpr double kRim = 1e-6;       // barycentric

class Rays {
 public:
  Rays(const LayeredSkin& skin, const std::vector<char>& is_inverted)
      : skin_(skin), is_inverted_(is_inverted), query_(skin.rest, opaque(skin)) {}

  Index cover(Index t) const {
    const Vec3 normal = outward(t);
    if (normal.isZero(0)) return kNoIndex;
    const Vec3 middle = triangle_centroid(skin_.rest, t);
    const auto [found, is_own] = along(t, middle, normal);
    if (!is_own) return found;
    // The own piece is in the way, as the arm is of the armpit.
    const Vec3 side = normal.unitOrthogonal(), other = normal.cross(side);
    for (int k = 0; k < kTilted; ++k) {
      const double angle = 2 * std::numbers::pi * k / kTilted;
      const Vec3 aside = std::cos(angle) * side + std::sin(angle) * other;
      const Ray tilted = along(t, middle, std::cos(kTilt) * normal + std::sin(kTilt) * aside);
      if (tilted.cover != kNoIndex) return tilted.cover;
    }
    return kNoIndex;
  }

  // The triangle of another piece that faces outwards right below this one.
  Index pierced(Index t) const {
    const Vec3 normal = outward(t);
    if (normal.isZero(0)) return kNoIndex;
    const auto hit = query_.first_hit(triangle_centroid(skin_.rest, t) - kStep * skin_.height * normal, -normal);
    const bool is_near = hit && hit->distance < kLining * skin_.height;
    if (!is_near || skin_.piece[hit->triangle] == skin_.piece[t]) return kNoIndex;
    return outward(hit->triangle).dot(normal) > 0 ? hit->triangle : kNoIndex;
  }

 private:
  struct Ray {
    Index cover = kNoIndex;
    bool meets_own = false;
  };

  static std::vector<Index> opaque(const LayeredSkin& skin) {
    std::vector<Index> out;
    for (Index t = 0; t < skin.rest.triangles.size(); ++t) {
      if (skin.is_opaque[t] != 0) out.push_back(t);
    }
    return out;
  }

  Vec3 outward(Index t) const {
    const Vec3 normal = triangle_cross(skin_.rest, t).normalized();
    return is_inverted_[skin_.piece[t]] != 0 ? -normal : normal;
  }

  // A cover is met from behind. Cloth with two sides is met from the front, and soon after from behind.
  Ray along(Index t, const Vec3& from, const Vec3& direction) const {
    const double step = kStep * skin_.height;
    double gone = step, end = kReach * skin_.height;
    bool is_in_cloth = false;
    while (true) {
      const auto hit = query_.first_hit(from + gone * direction, direction);
      if (!hit || gone + hit->distance > end) return {};
      gone += hit->distance + step;
      if (skin_.piece[hit->triangle] == skin_.piece[t]) return {kNoIndex, true};
      if (outward(hit->triangle).dot(direction) > 0) return {hit->triangle, false};
      if (!is_in_cloth) end = std::min(end, gone + kLining * skin_.height);
      is_in_cloth = true;
    }
  }

  const LayeredSkin& skin_;
  const std::vector<char>& is_inverted_;
  SurfaceQuery query_;
};

// Finds triangles by their middles at rest.
class Grid {
 public:
  Grid(const LayeredSkin& skin, double cell) : cell_(cell) {
    for (Index t = 0; t < skin.rest.triangles.size(); ++t) {
      middles_.push_back(triangle_centroid(skin.rest, t));
      directions_.push_back(triangle_cross(skin.rest, t).normalized());
      if (skin.is_opaque[t] != 0) cells_[cell_of(middles_[t])].push_back(t);
    }
  }

  const Vec3& middle(Index t) const { return middles_[t]; }

  // Calls use() for opaque triangles not farther than a cell from `t` that face the same way, itself included.
  template <typename Use>
  void around(Index t, const Use& use) const {
    const Cell at = cell_of(middles_[t]);
    for (int k = 0; k < 27; ++k) {
      const auto found = cells_.find({at[0] + k % 3 - 1, at[1] + k / 3 % 3 - 1, at[2] + k / 9 - 1});
      if (found == cells_.end()) continue;
      for (const Index near : found->second) {
        if ((middles_[near] - middles_[t]).norm() < cell_ && directions_[near].dot(directions_[t]) > kLike) use(near);
      }
    }
  }

 private:
  using Cell = std::array<int, 3>;
  Cell cell_of(const Vec3& p) const {
    return {static_cast<int>(std::floor(p.x() / cell_)), static_cast<int>(std::floor(p.y() / cell_)),
            static_cast<int>(std::floor(p.z() / cell_))};
  }

  double cell_;
  std::vector<Vec3> middles_, directions_;
  std::map<Cell, std::vector<Index>> cells_;
};

// Where two primitives, or two pieces of one, cover each other in places, the one that is below in less of the area is
// not covered: a shirt that a belly has come through is not under the belly.
void drop_wrong_order(const LayeredSkin& skin, std::vector<Cover>& covers) {
  using Pair = std::array<Index, 2>;
  std::map<std::pair<bool, Pair>, double> areas;  // of the first below the second
  const auto key = [&](Index t) {
    const Index cover = covers[t].triangle;
    const bool is_one = skin.run[t] == skin.run[cover];
    const std::vector<Index>& names = is_one ? skin.piece : skin.run;
    return std::pair(is_one, Pair{names[t], names[cover]});
  };
  for (Index t = 0; t < covers.size(); ++t) {
    if (covers[t].triangle != kNoIndex) areas[key(t)] += triangle_area(skin.rest, t);
  }
  for (Index t = 0; t < covers.size(); ++t) {
    if (covers[t].triangle == kNoIndex) continue;
    const auto [is_one, pair] = key(t);
    const auto other = areas.find({is_one, Pair{pair[1], pair[0]}});
    if (other != areas.end() && areas[{is_one, pair}] < kOrderMin * other->second) covers[t] = {};
  }
}

// The mean over the corners.
std::map<Index, double> weights_of(const SourceRig& rig, const Triangle& triangle) {
  std::map<Index, double> out;
  for (const Index v : triangle) {
    for (std::size_t k = 0; k < kMaxInfluences; ++k) {
      if (rig.weights[v].weight[k] > 0) out[rig.weights[v].joint[k]] += rig.weights[v].weight[k] / 3;
    }
  }
  return out;
}

double shared(const std::map<Index, double>& a, const std::map<Index, double>& b) {
  double out = 0;
  for (const auto& [bone, weight] : a) {
    if (const auto found = b.find(bone); found != b.end()) out += std::min(weight, found->second);
  }
  return out;
}

// True if two triangles move alike: bones that move both, or the main bones are parent and child.
bool move_together(const SourceRig& rig, const Triangle& a, const Triangle& b) {
  if (rig.weights.empty()) return true;
  const std::map<Index, double> of_a = weights_of(rig, a), of_b = weights_of(rig, b);
  if (of_a.empty() || of_b.empty()) return of_a.empty() && of_b.empty();
  const auto main = [&](const std::map<Index, double>& weights) {
    const auto most = std::max_element(weights.begin(), weights.end(),
                                       [](const auto& l, const auto& r) { return l.second < r.second; });
    return static_cast<int>(rig.bones[most->first].node);
  };
  const int node_a = main(of_a), node_b = main(of_b);
  const auto parent = [&](int node) { return rig.nodes[static_cast<std::size_t>(node)].parent; };
  return shared(of_a, of_b) >= kSharedMin || node_a == node_b || parent(node_a) == node_b || parent(node_b) == node_a;
}

// Weights of the corners a, b, c at the point of the triangle that is closest to p.
Vec3 closest_weights(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp), d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double of_c = d1 * d4 - d3 * d2, of_b = d5 * d2 - d1 * d6, of_a = d3 * d6 - d5 * d4;
  if (of_c <= 0 && d1 >= 0 && d3 <= 0) return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
  if (of_b <= 0 && d2 >= 0 && d6 <= 0) return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
  if (of_a <= 0 && d4 >= d3 && d5 >= d6) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - w, w};
  }
  return Vec3(of_a, of_b, of_c) / (of_a + of_b + of_c);
}

}  // namespace

double shared_weight(const SourceRig& rig, const Triangle& a, const Triangle& b) {
  return rig.weights.empty() ? 0 : shared(weights_of(rig, a), weights_of(rig, b));
}

std::vector<Cover> find_covers(const LayeredSkin& skin, const std::vector<char>& is_inverted) {
  std::vector<Cover> covers(skin.rest.triangles.size());
  if (std::find(skin.is_opaque.begin(), skin.is_opaque.end(), 1) == skin.is_opaque.end()) return covers;
  const Rays rays(skin, is_inverted);
  std::vector<Index> pierced(covers.size(), kNoIndex);
  run_parallel(thread_count(), covers.size(), [&](std::size_t, std::size_t i) {
    const auto t = static_cast<Index>(i);
    if (skin.is_opaque[t] == 0) return;
    covers[t].triangle = rays.cover(t);
    if (covers[t].triangle == kNoIndex) pierced[t] = rays.pierced(t);
  });
  drop_wrong_order(skin, covers);
  // Skin over other skin has come through it only where the skin around is below.
  const Grid grid(skin, kAround * skin.height);
  for (Index t = 0; t < covers.size(); ++t) {
    if (pierced[t] == kNoIndex) continue;
    double all = 0, below = 0;
    grid.around(t, [&](Index near) {
      if (skin.piece[near] != skin.piece[t]) return;
      const double area = triangle_area(skin.rest, near);
      const Index cover = covers[near].triangle;
      all += area;
      if (cover != kNoIndex && !covers[near].is_pierced && skin.piece[cover] == skin.piece[pierced[t]]) below += area;
    });
    if (below > kBelowMin * all) covers[t] = {pierced[t], true};
  }
  return covers;
}

PokeTest::PokeTest(const LayeredSkin& skin, const std::vector<char>& is_inverted, const std::vector<Cover>& covers,
                   const SourceRig& rig)
    : skin_(skin),
      is_inverted_(is_inverted),
      covers_(covers),
      near_(covers.size()),
      neighbours_(triangle_neighbours(skin.welded)) {
  const Grid grid(skin, kNear * skin.height);
  const std::vector<Vec3> rest_normals = normals(skin.rest.positions);
  run_parallel(thread_count(), covers.size(), [&](std::size_t, std::size_t i) {
    const auto t = static_cast<Index>(i);
    const Index cover = covers[t].triangle;
    if (cover == kNoIndex || !move_together(rig, skin.rest.triangles[t], skin.rest.triangles[cover])) return;
    grid.around(cover, [&](Index near) {
      if (skin.piece[near] == skin.piece[cover]) near_[t].push_back(near);
    });
    // Where the nearest point of the cover contradicts the ray, it tells nothing.
    const Height rest = height(t, grid.middle(t), skin.rest.positions, rest_normals);
    if (covers[t].is_pierced ? !rest.is_above() : !rest.is_below()) near_[t].clear();
  });
}

std::vector<Vec3> PokeTest::normals(const std::vector<Vec3>& positions) const {
  std::vector<Vec3> out(skin_.welded.positions.size(), Vec3::Zero());
  for (std::size_t t = 0; t < skin_.rest.triangles.size(); ++t) {
    const Triangle& corners = skin_.rest.triangles[t];
    const Vec3& a = positions[corners[0]];
    Vec3 cross = (positions[corners[1]] - a).cross(positions[corners[2]] - a);
    if (is_inverted_[skin_.piece[t]] != 0) cross = -cross;
    for (const Index v : skin_.welded.triangles[t]) out[v] += cross;
  }
  for (Vec3& normal : out) normal.normalize();
  return out;
}

bool PokeTest::Height::is_above() const { return !is_on_rim && along >= kAlong * distance; }
bool PokeTest::Height::is_below() const { return !is_on_rim && -along > kAlong * distance; }

PokeTest::Height PokeTest::height(Index triangle, const Vec3& point, const std::vector<Vec3>& positions,
                                  const std::vector<Vec3>& normals) const {
  Index nearest = kNoIndex;
  Vec3 weights = Vec3::Zero(), offset = Vec3::Zero();
  for (const Index t : near_[triangle]) {
    const Triangle& v = skin_.rest.triangles[t];
    const Vec3 w = closest_weights(point, positions[v[0]], positions[v[1]], positions[v[2]]);
    const Vec3 from = point - (w[0] * positions[v[0]] + w[1] * positions[v[1]] + w[2] * positions[v[2]]);
    if (nearest != kNoIndex && !(from.squaredNorm() < offset.squaredNorm())) continue;
    nearest = t;
    weights = w;
    offset = from;
  }
  if (nearest == kNoIndex) return {};
  Vec3 normal = Vec3::Zero();
  Height out;
  out.is_on_rim = false;
  for (std::size_t k = 0; k < 3; ++k) {
    normal += weights[static_cast<Eigen::Index>(k)] * normals[skin_.welded.triangles[nearest][k]];
    const bool is_border = neighbours_[nearest][k] == kNoIndex;
    if (is_border && weights[static_cast<Eigen::Index>((k + 2) % 3)] < kRim) out.is_on_rim = true;
  }
  out.distance = offset.norm();
  out.along = offset.dot(normal.normalized());
  return out;
}

double PokeTest::height_above(Index triangle, const std::vector<Vec3>& positions,
                              const std::vector<Vec3>& normals) const {
  const auto corner = [&](Index t, std::size_t k) -> const Vec3& { return positions[skin_.rest.triangles[t][k]]; };
  const Vec3 point = (corner(triangle, 0) + corner(triangle, 1) + corner(triangle, 2)) / 3;
  // Most skin lies right below the spot of its cover that it lay below at rest: the search is left out.
  const Index cover = covers_[triangle].triangle;
  const Vec3 &a = corner(cover, 0), &b = corner(cover, 1), &c = corner(cover, 2);
  const Vec3 w = closest_weights(point, a, b, c), offset = point - (w[0] * a + w[1] * b + w[2] * c);
  const Vec3 cross = (is_inverted_[skin_.piece[cover]] != 0 ? -1 : 1) * (b - a).cross(c - a);
  if (-offset.dot(cross) > kAlong * offset.norm() * cross.norm()) return 0;
  const Height found = height(triangle, point, positions, normals);
  return found.is_above() ? found.distance : 0;
}

bool PokeTest::is_through(Index triangle, const std::vector<Vec3>& positions, const std::vector<Vec3>& normals) const {
  if (near_[triangle].empty()) return false;
  const Triangle& corners = skin_.rest.triangles[triangle];
  const Vec3 &a = positions[corners[0]], &b = positions[corners[1]], &c = positions[corners[2]];
  for (const Vec3& point : {Vec3((a + b + c) / 3), a, b, c}) {
    const Height found = height(triangle, point, positions, normals);
    if (found.is_above() || (found.is_below() && found.along > -kHardlyBelow * skin_.height)) return true;
  }
  return false;
}

}  // namespace spherechain::baker

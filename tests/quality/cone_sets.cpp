// SPDX-License-Identifier: GPL-3.0-or-later
#include "cone_sets.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "play/player.h"

namespace spherechain::quality {
namespace {

using baker::Index;
using baker::Vec3;

constexpr double kFar = std::numeric_limits<double>::infinity();
constexpr double kQuantile = 0.9, kLargestScale = 2;
constexpr std::size_t kTriangles = 1500;  // of a run, that a thinning looks at

Vec3 center(const Sphere& s) { return {double{s.x}, double{s.y}, double{s.z}}; }
Pair link_of(std::uint32_t a, std::uint32_t b) { return {std::min(a, b), std::max(a, b)}; }

}  // namespace

Cone ConeSet::cone(std::size_t link, const std::vector<Sphere>& spheres) const {
  const auto [a, b] = links[link];
  return {center(spheres[a]), center(spheres[b]), double{spheres[a].radius} * factor[a],
          double{spheres[b].radius} * factor[b]};
}

std::vector<Pair> ConeSet::pairs() const {
  std::vector<Pair> out;
  for (std::uint32_t a = 0; a < links.size(); ++a) {
    for (std::uint32_t b = a + 1; b < links.size(); ++b) {
      if (!ignored[a][b]) out.push_back({a, b});
    }
  }
  return out;
}

std::vector<double> ConeSet::touching_scales(const std::vector<Sphere>& spheres) const {
  std::vector<Cone> posed;
  for (std::size_t i = 0; i < links.size(); ++i) posed.push_back(cone(i, spheres));
  std::vector<double> out;
  for (const Pair& pair : pairs()) {
    const Cone &a = posed[pair.a], &b = posed[pair.b];
    const double axes = ((a.to - a.from).norm() + (b.to - b.from).norm()) / 2;
    const double radii = std::max(a.from_radius, a.to_radius) + std::max(b.from_radius, b.to_radius);
    const bool is_far = ((a.from + a.to) / 2 - (b.from + b.to) / 2).norm() - axes > kLargestScale * radii;
    out.push_back(is_far ? 9 : touching_scale(a, b));
  }
  return out;
}

ConeSets::ConeSets(const baker::AnimatedAsset& animated, const baker::TruthSurface& surface)
    : animated_(animated),
      surface_(surface),
      rest_(refit_spheres(animated.asset(), baker::pack(animated.character().source_positions), SC_RADIUS_DETECT)) {
  const std::vector<Vec3>& p = animated.character().source_positions;
  for (const baker::Triangle& t : surface.corners) {
    centroid_.push_back((p[t[0]] + p[t[1]] + p[t[2]]) / 3);
    area_.push_back((p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]).norm() / 2);
  }
}

double ConeSets::share_along(const Pair& link, const Vec3& point) const {
  const Vec3 from = center(rest_[link.a]), axis = center(rest_[link.b]) - from;
  const double length = axis.squaredNorm();
  return length > 0 ? std::clamp((point - from).dot(axis) / length, 0.0, 1.0) : 0.0;
}

double ConeSets::axis_distance(const Pair& link, const Vec3& point) const {
  const Vec3 from = center(rest_[link.a]), axis = center(rest_[link.b]) - from;
  return (from + share_along(link, point) * axis - point).norm();
}

std::vector<Pair> ConeSets::links_of(const Run& run) const {
  std::vector<Pair> out;
  if (run.size() == 1) return {link_of(run[0], run[0])};
  const auto spheres = animated_.asset()->spheres();
  if (spheres[run[0]].level >= 0) {
    std::map<int, Run> levels;
    for (const auto s : run) levels[spheres[s].level].push_back(s);
    const Run* below = nullptr;
    for (const auto& [level, at] : levels) {
      for (std::size_t i = 0; i + 1 < at.size(); ++i) out.push_back(link_of(at[i], at[i + 1]));
      for (std::size_t i = 0; below != nullptr && i < std::max(at.size(), below->size()); ++i) {
        out.push_back(link_of((*below)[std::min(i, below->size() - 1)], at[std::min(i, at.size() - 1)]));
      }
      below = &at;
    }
    return out;
  }
  Run in{run[0]}, left(run.begin() + 1, run.end());
  while (!left.empty()) {
    double best = kFar;
    std::size_t at = 0;
    Pair link{};
    for (std::size_t i = 0; i < left.size(); ++i) {
      for (const auto s : in) {
        const double distance = (center(rest_[s]) - center(rest_[left[i]])).norm();
        if (distance < best) best = distance, at = i, link = link_of(s, left[i]);
      }
    }
    out.push_back(link);
    in.push_back(left[at]);
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(at));
  }
  return out;
}

// How far the skin is from the cones with the radii that suit it best.
double ConeSets::cost(const Run& run, const std::vector<Index>& triangles) const {
  const std::vector<Pair> links = links_of(run);
  struct Near {
    Pair link;
    double share, distance, area;
  };
  std::vector<Near> near;
  std::map<std::uint32_t, std::pair<double, double>> sums;  // of area times distance, of area
  for (std::size_t k = 0; k < triangles.size(); k += 1 + triangles.size() / kTriangles) {
    Near at{{}, 0, kFar, area_[triangles[k]]};
    for (const Pair& link : links) {
      const double distance = axis_distance(link, centroid_[triangles[k]]);
      if (distance < at.distance) at = {link, share_along(link, centroid_[triangles[k]]), distance, at.area};
    }
    near.push_back(at);
    for (const auto& [sphere, part] : {std::pair(at.link.a, 1 - at.share), std::pair(at.link.b, at.share)}) {
      sums[sphere].first += at.area * part * at.distance;
      sums[sphere].second += at.area * part;
    }
  }
  const auto radius = [&](std::uint32_t s) { return sums[s].second > 0 ? sums[s].first / sums[s].second : 0; };
  double sum = 0;
  for (const Near& n : near) {
    sum += n.area * std::abs(n.distance - (1 - n.share) * radius(n.link.a) - n.share * radius(n.link.b));
  }
  return sum;
}

ConeSets::Run ConeSets::thinned(Run run, double part) const {
  const auto spheres = animated_.asset()->spheres();
  const auto wanted = static_cast<std::size_t>(std::max(2.0, std::round(part * static_cast<double>(run.size()) + 0.5)));
  std::vector<Index> triangles;
  for (Index t = 0; t < surface_.corners.size(); ++t) {
    if (spheres[surface_.sphere[t]].region == spheres[run[0]].region) triangles.push_back(t);
  }
  while (run.size() > wanted) {
    double best = kFar;
    Run next;
    std::set<int> tried;  // of a torso, whole levels go
    for (const auto gone : run) {
      const int level = spheres[gone].level;
      if (level >= 0 && !tried.insert(level).second) continue;
      Run less;
      std::copy_if(run.begin(), run.end(), std::back_inserter(less),
                   [&](auto s) { return level >= 0 ? spheres[s].level != level : s != gone; });
      if (less.size() < 2) continue;
      const double own = cost(less, triangles);
      if (own < best) best = own, next = less;
    }
    if (next.empty()) break;
    run = next;
  }
  return run;
}

ConeSet ConeSets::spheres() const {
  ConeSet set;
  set.name = "spheres";
  for (std::uint32_t i = 0; i < rest_.size(); ++i) set.links.push_back({i, i});
  set.factor.assign(rest_.size(), 1.0);
  set.owner = surface_.sphere;
  set.of_link = surface_.of_sphere;
  ignore_neighbours(set);
  return set;
}

ConeSet ConeSets::cones(double part) const {
  const auto spheres = animated_.asset()->spheres();
  std::vector<Run> runs(animated_.asset()->region_count());
  for (std::uint32_t s = 0; s < spheres.size; ++s) runs[spheres[s].region].push_back(s);
  ConeSet set;
  set.name = part < 1 ? fmt::format("cones, {:.0f} % of the spheres", 100 * part) : "cones";
  for (const Run& run : runs) {
    if (run.empty()) continue;
    const std::vector<Pair> links = links_of(part < 1 && run.size() > 2 ? thinned(run, part) : run);
    set.links.insert(set.links.end(), links.begin(), links.end());
  }
  set.factor.assign(spheres.size, 1.0);
  set.of_link.resize(set.links.size());
  std::vector<std::vector<std::pair<double, double>>> needed(spheres.size);
  for (Index t = 0; t < surface_.corners.size(); ++t) {
    double best = kFar;
    std::uint32_t at = 0;
    for (std::uint32_t i = 0; i < set.links.size(); ++i) {
      const Pair& link = set.links[i];
      if (spheres[link.a].region != spheres[surface_.sphere[t]].region) continue;
      const double share = share_along(link, centroid_[t]);
      const double gap = axis_distance(link, centroid_[t]) - (1 - share) * double{rest_[link.a].radius} -
                         share * double{rest_[link.b].radius};
      if (gap < best) best = gap, at = i;
    }
    set.owner.push_back(at);
    set.of_link[at].push_back(t);
    const double share = share_along(set.links[at], centroid_[t]),
                 distance = axis_distance(set.links[at], centroid_[t]);
    needed[set.links[at].a].emplace_back(distance, area_[t] * (1 - share) + 1e-12);
    needed[set.links[at].b].emplace_back(distance, area_[t] * share + 1e-12);
  }
  for (std::size_t s = 0; s < spheres.size; ++s) {
    if (!needed[s].empty()) set.factor[s] = baker::weighted_quantile(needed[s], kQuantile) / double{rest_[s].radius};
  }
  ignore_neighbours(set);
  return set;
}

void ConeSets::ignore_neighbours(ConeSet& set) const {
  const auto ignored = [&](std::uint32_t a, std::uint32_t b) { return a == b || is_ignored(animated_.asset(), a, b); };
  for (const auto& [a, b] : set.links) {
    auto& row = set.ignored.emplace_back();
    for (const auto& [c, d] : set.links) {
      const bool share = a == c || a == d || b == c || b == d;
      row.push_back(share || (ignored(a, c) && ignored(a, d) && ignored(b, c) && ignored(b, d)));
    }
  }
}

}  // namespace spherechain::quality

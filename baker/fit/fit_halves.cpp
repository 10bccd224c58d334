// SPDX-License-Identifier: GPL-3.0-or-later
// The fit for any body: skin is halved where that gains most, until there are enough spheres.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "baker/fit/bone_weights.h"
#include "baker/fit/fit.h"
#include "baker/fit/piece.h"

namespace spherechain::baker {
namespace {

constexpr double kLittle = 0.01;  // of the error of one sphere for each region: a gain that few spheres do without
constexpr double kJoined = 0.01;  // of the height: a part whose skin is farther from the one it hangs on is apart

struct Region {
  std::vector<Index> triangles;
  std::vector<Piece> pieces;
  std::vector<std::optional<std::pair<Piece, Piece>>> halves;  // of each piece
  std::vector<double> gains;                                   // what halving each piece takes off the error

  void add(const PieceFitter& fitter, Piece piece) {
    pieces.push_back(std::move(piece));
    halves.emplace_back();
    gains.push_back(0);
    look_ahead(fitter, pieces.size() - 1);
  }
  void look_ahead(const PieceFitter& fitter, std::size_t i) {
    halves[i] = fitter.halve(pieces[i]);
    gains[i] =
        halves[i] ? std::max(pieces[i].error - halves[i]->first.error - halves[i]->second.error, 0.01 * pieces[i].error)
                  : 0;
  }
  // Every piece needs a triangle of its own.
  bool is_full() const { return pieces.size() >= triangles.size(); }
  double most_gain() const { return is_full() ? 0 : *std::max_element(gains.begin(), gains.end()); }
  // Each sample to the sphere whose surface is nearest to it, unless a sphere would lose all of its own.
  void share_again(const PieceFitter& fitter) {
    std::vector<Samples> shares(pieces.size());
    for (const std::uint32_t sample : fitter.samples_of(triangles)) {
      std::size_t nearest = 0;
      double least = std::numeric_limits<double>::max();
      for (std::size_t i = 0; i < pieces.size(); ++i) {
        const double error = fitter.error_of(sample, pieces[i].ball);
        if (error >= least) continue;
        least = error;
        nearest = i;
      }
      shares[nearest].push_back(sample);
    }
    if (std::any_of(shares.begin(), shares.end(), [](const auto& share) { return share.empty(); })) return;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      pieces[i] = fitter.fit_from(pieces[i].ball, std::move(shares[i]));
    }
  }
  // Whether any piece could be halved.
  bool halve_best(const PieceFitter& fitter) {
    const auto i = static_cast<std::size_t>(std::max_element(gains.begin(), gains.end()) - gains.begin());
    if (!halves[i] || is_full()) return false;
    std::pair<Piece, Piece> two = std::move(*halves[i]);
    pieces[i] = std::move(two.first);
    look_ahead(fitter, i);
    add(fitter, std::move(two.second));
    return true;
  }
  // The piece of each triangle: the one whose sphere its farthest part is nearest to. A piece without a triangle gets
  // the nearest of those that another can spare.
  std::vector<std::size_t> owners(const PieceFitter& fitter) const {
    std::vector<std::vector<double>> errors;  // of each triangle, by piece
    std::vector<std::size_t> owned(pieces.size());
    std::vector<std::size_t> out;
    for (const Index t : triangles) {
      std::vector<double>& of_triangle = errors.emplace_back(pieces.size());
      const Samples samples = fitter.samples_of({t});
      for (std::size_t i = 0; i < pieces.size(); ++i) {
        for (const std::uint32_t sample : samples)
          of_triangle[i] = std::max(of_triangle[i], fitter.error_of(sample, pieces[i].ball));
      }
      out.push_back(
          static_cast<std::size_t>(std::min_element(of_triangle.begin(), of_triangle.end()) - of_triangle.begin()));
      ++owned[out.back()];
    }
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      if (owned[i] > 0) continue;
      std::size_t best = 0;
      double least = std::numeric_limits<double>::max();
      for (std::size_t k = 0; k < triangles.size(); ++k) {
        const double worse = errors[k][i] / std::max(errors[k][out[k]], std::numeric_limits<double>::min());
        if (owned[out[k]] < 2 || worse >= least) continue;
        least = worse;
        best = k;
      }
      --owned[out[best]];
      out[best] = i;
      owned[i] = 1;
    }
    return out;
  }
};

// Regions that mirror each other, by area and place; the others alone.
std::vector<std::vector<Region*>> mirrored(const Mesh& mesh, const Regions& regions, const std::vector<Region*>& all) {
  constexpr double kSameArea = 0.05, kSamePlace = 0.03;  // of the area; of the height
  struct Place {
    double area = 0;
    Vec3 centroid = Vec3::Zero();
  };
  std::vector<Place> places;
  for (const Region* region : all) {
    Place place;
    for (const Index t : region->triangles) {
      place.area += triangle_area(mesh, t);
      place.centroid += triangle_area(mesh, t) * triangle_centroid(mesh, t);
    }
    place.centroid /= place.area;
    places.push_back(place);
  }
  const BodyFrame& frame = regions.frame;
  const auto are_mirrored = [&](const Place& a, const Place& b) {
    const Vec3 image = a.centroid - 2 * (a.centroid - frame.origin).dot(frame.left) * frame.left;
    return std::abs(a.area - b.area) < kSameArea * a.area && (image - b.centroid).norm() < kSamePlace * frame.height &&
           (a.centroid - b.centroid).norm() > (image - b.centroid).norm();
  };
  std::vector<std::vector<Region*>> groups;
  std::vector<bool> taken(all.size(), false);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (taken[i]) continue;
    std::vector<Region*>& group = groups.emplace_back();
    group.push_back(all[i]);
    for (std::size_t j = i + 1; j < all.size() && group.size() == 1; ++j) {
      if (taken[j] || !are_mirrored(places[i], places[j])) continue;
      group.push_back(all[j]);
      taken[j] = true;
    }
  }
  return groups;
}

// Halves the worst pieces until the spheres, with those kept, are as many as they may be. `area` is that of the pieces.
void share_spheres(const PieceFitter& fitter, std::vector<std::vector<Region*>>& groups, const FitSettings& settings,
                   double area, std::size_t kept) {
  std::size_t spheres = kept;
  for (const std::vector<Region*>& group : groups) spheres += group.size();
  double least_gain = 0;
  for (const std::vector<Region*>& group : groups) {
    for (const Region* region : group) {
      for (const Piece& piece : region->pieces) least_gain += (settings.few ? kLittle : 0) * piece.error;
    }
  }
  for (;;) {
    double far_area = 0;
    for (const std::vector<Region*>& group : groups) {
      for (const Region* region : group) {
        for (const Piece& piece : region->pieces) far_area += piece.far_area;
      }
    }
    const bool is_good = far_area <= kFarAreaGood * area;
    const auto limit =
        static_cast<std::size_t>(settings.spheres.value_or(is_good ? kHalvedSpheres : kHalvedSpheresMax));
    double most = least_gain;
    std::vector<Region*>* next = nullptr;
    for (std::vector<Region*>& group : groups) {
      if (spheres + group.size() > limit) continue;
      double gain = 0;
      for (const Region* region : group) gain += region->most_gain();
      gain /= static_cast<double>(group.size());
      if (gain <= most) continue;
      most = gain;
      next = &group;
    }
    if (next == nullptr) return;
    for (Region* region : *next) spheres += region->halve_best(fitter) ? 1 : 0;
  }
}

// The corners of a sphere's triangles.
std::vector<Vec3> corners_of(const Mesh& skin, const Spheres& spheres, std::uint32_t sphere) {
  std::set<Index> corners;
  for (std::size_t t = 0; t < spheres.of_skin.size(); ++t) {
    if (spheres.of_skin[t] == sphere) corners.insert(skin.triangles[t].begin(), skin.triangles[t].end());
  }
  std::vector<Vec3> out;
  for (const Index v : corners) out.push_back(skin.positions[v]);
  return out;
}

bool are_joined(const Mesh& skin, const Spheres& spheres, std::uint32_t a, std::uint32_t b, double distance) {
  const std::vector<Vec3> of_b = corners_of(skin, spheres, b);
  for (const Vec3& p : corners_of(skin, spheres, a)) {
    for (const Vec3& q : of_b) {
      if ((p - q).squaredNorm() < distance * distance) return true;
    }
  }
  return false;
}

}  // namespace

std::vector<std::pair<std::uint32_t, std::uint32_t>> find_links(const Character& character, const Regions& regions,
                                                                const Spheres& spheres) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> links;
  std::vector<std::vector<Index>> triangles(spheres.spheres.size());
  for (Index t = 0; t < spheres.of_skin.size(); ++t) triangles[spheres.of_skin[t]].push_back(t);
  std::vector<BoneWeights> weights;
  for (const std::vector<Index>& of_sphere : triangles) weights.push_back(mean_weights(character, of_sphere));
  for (std::uint32_t a = 0; a < weights.size(); ++a) {
    for (std::uint32_t b = a + 1; b < weights.size(); ++b) {
      if (overlap(weights[a], weights[b]) > kMovesAlike) links.emplace_back(a, b);
    }
  }
  for (std::size_t region = 0; region < regions.parents.size(); ++region) {
    if (regions.parents[region] == region) continue;
    double least = std::numeric_limits<double>::max();
    std::pair<std::uint32_t, std::uint32_t> nearest;
    for (const std::uint32_t a : spheres.of_region[region]) {
      for (const std::uint32_t b : spheres.of_region[regions.parents[region]]) {
        const double distance = (spheres.spheres[a].ball.center - spheres.spheres[b].ball.center).squaredNorm();
        if (distance >= least) continue;
        least = distance;
        nearest = std::minmax(a, b);
      }
    }
    if (are_joined(character.skin, spheres, nearest.first, nearest.second, kJoined * regions.frame.height)) {
      links.push_back(nearest);
    }
  }
  std::sort(links.begin(), links.end());
  links.erase(std::unique(links.begin(), links.end()), links.end());
  return links;
}

std::vector<std::size_t> share_triangles(const Mesh& skin, const BodyFrame& frame, const std::vector<Index>& triangles,
                                         const std::vector<Ball>& balls) {
  Region region;
  region.triangles = triangles;
  for (const Ball& ball : balls) region.pieces.push_back({{}, ball, 0, 0});
  return region.owners(PieceFitter(skin, kWellFitted * frame.height));
}

Spheres fit_halves(const Character& character, const Regions& regions, const FitSettings& settings,
                   const KeptSpheres& kept) {
  const Mesh& skin = character.skin;
  const PieceFitter fitter(skin, kWellFitted * regions.frame.height);
  std::vector<Region> all(regions.count());
  for (Index t = 0; t < regions.of_skin.size(); ++t) all[regions.of_skin[t]].triangles.push_back(t);
  std::vector<Region*> halved;
  std::size_t kept_spheres = 0;
  double area = 0;
  for (std::size_t id = 0; id < all.size(); ++id) {
    if (kept.keeps(id)) {
      kept_spheres += kept.of_region(id).size();
      continue;
    }
    for (const Index t : all[id].triangles) area += triangle_area(skin, t);
    all[id].add(fitter, fitter.fit(fitter.samples_of(all[id].triangles)));
    halved.push_back(&all[id]);
  }
  std::vector<std::vector<Region*>> groups = mirrored(skin, regions, halved);
  share_spheres(fitter, groups, settings, area, kept_spheres);
  constexpr int kRounds = 2;
  for (Region* region : halved) {
    for (int round = 0; round < kRounds; ++round) region->share_again(fitter);
  }

  Spheres out;
  out.of_region.resize(all.size());
  out.of_skin.resize(skin.triangles.size());
  std::map<std::uint32_t, std::uint32_t> place;  // of each kept sphere
  for (std::uint8_t id = 0; id < all.size(); ++id) {
    const auto add = [&](const FittedSphere& sphere) {
      out.of_region[id].push_back(static_cast<std::uint32_t>(out.spheres.size()));
      out.spheres.push_back(sphere);
      out.spheres.back().region = id;
    };
    if (kept.keeps(id)) {
      for (const std::uint32_t sphere : kept.of_region(id)) {
        place[sphere] = static_cast<std::uint32_t>(out.spheres.size());
        add(kept.spheres->spheres[sphere]);
      }
      for (const Index t : all[id].triangles) {
        out.of_skin[t] = nearest_sphere(out, out.of_region[id], triangle_centroid(skin, t));
      }
      continue;
    }
    const Polyline& line = id < regions.limbs.size() ? regions.limbs[id].line : regions.spine;
    const Vec3 axis = (line.points().back() - line.points().front()).normalized();
    std::vector<Piece>& pieces = all[id].pieces;
    std::stable_sort(pieces.begin(), pieces.end(),
                     [&](const Piece& a, const Piece& b) { return a.ball.center.dot(axis) < b.ball.center.dot(axis); });
    const std::vector<std::size_t> owners = all[id].owners(fitter);
    for (std::size_t k = 0; k < owners.size(); ++k) {
      out.of_skin[all[id].triangles[k]] = static_cast<std::uint32_t>(out.spheres.size() + owners[k]);
    }
    for (const Piece& piece : pieces) add({piece.ball, id, -1, Side::kNone, axis, false});
  }
  out.links = find_links(character, regions, out);
  if (kept.spheres != nullptr) {
    for (const auto& [a, b] : kept.spheres->links) {
      if (place.count(a) > 0 && place.count(b) > 0) out.links.push_back(std::minmax(place[a], place[b]));
    }
    std::sort(out.links.begin(), out.links.end());
    out.links.erase(std::unique(out.links.begin(), out.links.end()), out.links.end());
  }
  return out;
}

}  // namespace spherechain::baker

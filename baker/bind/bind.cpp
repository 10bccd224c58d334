// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/bind/bind.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "baker/bind/neighbours.h"
#include "baker/fit/bone_weights.h"
#include "baker/mesh/surface_query.h"

namespace spherechain::baker {
namespace {

// Section 5.1: a triangle belongs to the sphere closest to it, here of its own region.
std::vector<std::uint32_t> assign_triangles(const Mesh& mesh, const std::vector<std::uint8_t>& region_of_triangle,
                                            const Spheres& spheres) {
  std::vector<std::uint32_t> owner;
  owner.reserve(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    owner.push_back(nearest_sphere(spheres, spheres.of_region[region_of_triangle[t]], triangle_centroid(mesh, t)));
  }
  return owner;
}

// Triangles of pieces too small to be body (eyes, teeth, buttons): they may move on their own, so they carry no sphere.
// Where much of the skin is in such pieces (armour, a robot), those that lie on the body are the body. Triangles that
// follow the bones are never loose.
std::vector<bool> loose_triangles(const Character& character, const Regions& regions) {
  const std::vector<bool>& by_bones = regions.by_bones;
  if (regions.is_tree() && std::find(by_bones.begin(), by_bones.end(), false) == by_bones.end()) {
    return std::vector<bool>(character.skin.triangles.size(), false);
  }
  constexpr double kSmall = 0.01, kMuch = 0.2;  // of the area
  constexpr double kOnBody = 0.005;             // of the height
  const Mesh& skin = character.skin;
  const Components pieces = connected_components(skin);
  std::vector<double> area(pieces.count, 0.0);
  for (std::size_t t = 0; t < skin.triangles.size(); ++t) area[pieces.of_triangle[t]] += triangle_area(skin, t);
  const double total = surface_area(skin);
  std::vector<bool> loose;
  double small = 0;
  for (const double a : area) {
    loose.push_back(a < kSmall * total);
    if (loose.back()) small += a;
  }
  if (small > kMuch * total) {
    const SurfaceQuery body(regions.body.mesh);
    std::vector<double> distance(pieces.count, 0.0);
    for (std::size_t t = 0; t < skin.triangles.size(); ++t) {
      const Index piece = pieces.of_triangle[t];
      if (loose[piece])
        distance[piece] += triangle_area(skin, t) / area[piece] * body.closest(triangle_centroid(skin, t)).distance;
    }
    for (std::size_t piece = 0; piece < loose.size(); ++piece) {
      if (distance[piece] < kOnBody * regions.frame.height) loose[piece] = false;
    }
  }
  std::vector<bool> of_triangle;
  for (std::size_t t = 0; t < skin.triangles.size(); ++t) {
    of_triangle.push_back(loose[pieces.of_triangle[t]] && !regions.is_by_bones(regions.of_skin[t]));
  }
  return of_triangle;
}

// Neighbours on the body: linked, or with neighbouring regions, on the skin or, across its gaps, on the body.
SpherePairs find_ignored(const Character& character, const Regions& regions, const Spheres& spheres,
                         const std::vector<std::uint32_t>& owner, double gap) {
  SpherePairs ignored(spheres.links.begin(), spheres.links.end());
  add_neighbours(character.skin, owner, gap, ignored);
  if (regions.is_tree()) return ignored;
  add_neighbours(regions.body.mesh, assign_triangles(regions.body.mesh, regions.of_triangle, spheres), gap, ignored);
  return ignored;
}

// Where a triangle's area counts: the march and the disk take its centroid. The fit by halves also has spheres of few
// large triangles, and takes corners and the middles of edges.
enum class AreaAt { kCentroid, kCorners };

// The smallest radius around the centre that holds this share of the region's area.
double area_quantile(const Mesh& mesh, const std::vector<Index>& triangles, const Vec3& center, double share,
                     AreaAt at) {
  std::vector<std::pair<double, double>> rings;
  for (const Index t : triangles) {
    const auto add = [&](const Vec3& p) { rings.emplace_back((p - center).norm(), triangle_area(mesh, t)); };
    if (at == AreaAt::kCentroid) {
      add(triangle_centroid(mesh, t));
      continue;
    }
    const Triangle& v = mesh.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) {
      add(mesh.positions[v[k]]);
      add(0.5 * (mesh.positions[v[k]] + mesh.positions[v[(k + 1) % 3]]));
    }
  }
  return weighted_quantile(std::move(rings), share);
}

// Skins whose weights overlap by more keep their shape: they err no more with weights ten times as large as skins that
// move alike with theirs.
constexpr double kMovesAsOne = 0.98, kIllPosedAsOne = kIllPosed * (1 - kMovesAlike) / (1 - kMovesAsOne);

// All triangles within some radii of a sphere's centre.
std::vector<Index> triangles_around(const Mesh& mesh, const FittedSphere& sphere, double radii) {
  std::vector<Index> around;
  for (Index t = 0; t < mesh.triangles.size(); ++t) {
    if ((triangle_centroid(mesh, t) - sphere.ball.center).norm() < radii * sphere.ball.radius) around.push_back(t);
  }
  return around;
}

// Selects the triangles that share more than `least` of their weights with the others.
std::vector<Index> moving_alike(const Character& character, const std::vector<Index>& triangles,
                                const BoneWeights& weights, double least) {
  if (least <= 0) return triangles;
  std::vector<Index> alike;
  for (const Index t : triangles) {
    if (overlap(mean_weights(character, {t}), weights) > least) alike.push_back(t);
  }
  return alike;
}

// Computes the sphere's centre and spread as its pivots reproduce them in the rest pose.
BoundSphere carried(const Mesh& mesh, const FittedSphere& sphere, RefitRule rule, std::vector<BoundPivot> pivots) {
  BoundSphere bound{sphere.ball, 0, 0, std::move(pivots), 0};
  Vec3 center = Vec3::Zero();
  double sum = 0;
  for (const BoundPivot& pivot : bound.pivots) {
    center += pivot.weight * triangle_centroid(mesh, pivot.triangle);
    bound.weight_sum += std::abs(pivot.weight);
  }
  for (const BoundPivot& pivot : bound.pivots) {
    const double squared = (triangle_centroid(mesh, pivot.triangle) - center).squaredNorm();
    sum += rule == RefitRule::kPaper ? std::sqrt(squared) : squared;
  }
  const double mean = sum / static_cast<double>(bound.pivots.size());
  bound.spread = rule == RefitRule::kPaper ? mean : std::sqrt(mean);
  if (rule == RefitRule::kPaper) {
    bound.rest = {center, bound.spread};
  } else if ((center - sphere.ball.center).norm() > 1e-6 * sphere.ball.radius) {
    bound.rest.center = center;
  }
  return bound;
}

// Never below the fit radius: a sphere's region may lie all inside it.
double detect_ratio(const Mesh& mesh, const std::vector<Index>& surrounding, const Ball& ball, double quantile,
                    AreaAt at) {
  return std::max(1.0, area_quantile(mesh, surrounding, ball.center, quantile, at) / ball.radius);
}

BoundSphere bind_sphere(const Character& character, const std::vector<Index>& surrounding, const FittedSphere& sphere,
                        bool on_torso, AreaAt at, const BodyFrame& frame, const BindSettings& settings) {
  const Mesh& mesh = character.skin;
  // Ray 0 of the rings points there too: pivots turn with the body.
  const Vec3 reference = on_torso ? frame.forward : Vec3(frame.up + 0.7 * frame.left + 0.3 * frame.forward);
  const auto choose = [&](const std::vector<Index>& among, double magnitudes_max) {
    return choose_pivots(mesh, among, sphere, reference, settings.rule, settings.pivots, magnitudes_max);
  };
  constexpr double kEverywhere = std::numeric_limits<double>::infinity();
  std::vector<BoundPivot> pivots;
  // The radius follows how far pivots are apart: those that other bones move would blow it up. Few and large triangles:
  // those beyond the region's border carry the sphere too.
  const BoneWeights weights =
      settings.rule == RefitRule::kMoments ? mean_weights(character, surrounding) : BoneWeights{};
  // The end of a sword has no skin around it: all of the sword carries it.
  for (const auto& [alike, magnitudes_max] :
       {std::pair{kMovesAlike, kIllPosed}, std::pair{kMovesAsOne, kIllPosedAsOne}, std::pair{0.65, kIllPosed},
        std::pair{0.5, kIllPosed}, std::pair{0.0, kIllPosed}}) {
    if (weights.empty() && alike > 0) continue;
    if (pivots.empty()) pivots = choose(moving_alike(character, surrounding, weights, alike), magnitudes_max);
    for (const double radii : {2.0, 4.0, 8.0, kEverywhere}) {
      if (!pivots.empty() || (radii == kEverywhere && alike != kMovesAsOne)) break;
      pivots = choose(moving_alike(character, triangles_around(mesh, sphere, radii), weights, alike), magnitudes_max);
    }
  }
  if (pivots.empty() && settings.rule == RefitRule::kMoments) {
    pivots = choose_nearest_pivots(mesh, triangles_around(mesh, sphere, 8), sphere, reference, settings.pivots);
  }
  if (pivots.empty() && settings.rule == RefitRule::kMoments) {
    constexpr std::size_t kFew = 4;  // one triangle's centroid has no distance from itself
    pivots = choose_even_pivots(
        mesh, surrounding.size() < kFew ? triangles_around(mesh, sphere, kEverywhere) : surrounding, sphere);
  }
  BoundSphere bound = carried(mesh, sphere, settings.rule, std::move(pivots));
  bound.detect_radius =
      sphere.detect_radius
          ? *sphere.detect_radius
          : detect_ratio(mesh, surrounding, sphere.ball, settings.detect_quantile, at) * bound.rest.radius;
  bound.keeps_detect_radius = sphere.detect_radius.has_value();
  return bound;
}

// The paper's: pairs that touch at rest, or would soon, are reported where they have come nearer than that.
std::vector<BoundPair> find_rest_pairs(const std::vector<BoundSphere>& spheres, const SpherePairs& ignored,
                                       double BoundSphere::*detect) {
  std::vector<BoundPair> pairs;
  for (std::uint32_t a = 0; a < spheres.size(); ++a) {
    for (std::uint32_t b = a + 1; b < spheres.size(); ++b) {
      if (ignored.count({a, b}) > 0) continue;
      const double distance = (spheres[a].rest.center - spheres[b].rest.center).norm();
      const double sum =
          detect ? spheres[a].*detect + spheres[b].*detect : spheres[a].rest.radius + spheres[b].rest.radius;
      const auto rest_scale = static_cast<float>(kPaperRestScale * distance / sum);
      if (rest_scale < 1) pairs.push_back({a, b, rest_scale});
    }
  }
  return pairs;
}

}  // namespace

std::vector<std::uint32_t> assign_triangles(const Mesh& skin, const Regions& regions, const Spheres& spheres) {
  return regions.is_tree() ? spheres.of_skin : assign_triangles(skin, regions.of_skin, spheres);
}

Attempt<Binding> bind_spheres(const Character& character, const Regions& regions, const Spheres& spheres,
                              const BindSettings& settings) {
  Binding out;
  out.rule = settings.rule;
  const Mesh& skin = character.skin;
  out.sphere_of_triangle = assign_triangles(skin, regions, spheres);

  std::vector<std::vector<Index>> surrounding(spheres.spheres.size());
  const std::vector<bool> loose = loose_triangles(character, regions);
  for (Index t = 0; t < out.sphere_of_triangle.size(); ++t) {
    if (!loose[t]) surrounding[out.sphere_of_triangle[t]].push_back(t);
  }
  for (std::size_t i = 0; i < spheres.spheres.size(); ++i) {
    const FittedSphere& sphere = spheres.spheres[i];
    const bool by_bones = regions.is_by_bones(sphere.region);
    const bool on_torso = !by_bones && sphere.region == regions.torso_region();
    const AreaAt at = by_bones ? AreaAt::kCorners : AreaAt::kCentroid;
    BoundSphere bound = bind_sphere(character, surrounding[i], sphere, on_torso, at, regions.frame, settings);
    if (bound.pivots.empty() || !(bound.spread > 0)) {
      return Reason{"the skin is too small for sphere " + std::to_string(i) + ", of the " +
                    regions.name(sphere.region) + ": its " + std::to_string(surrounding[i].size()) +
                    " triangles, and those around them, do not tell how it moves and grows"};
    }
    out.spheres.push_back(std::move(bound));
  }
  const SpherePairs ignored =
      find_ignored(character, regions, spheres, out.sphere_of_triangle, settings.neighbour_gap * regions.frame.height);
  out.ignored.assign(ignored.begin(), ignored.end());
  if (settings.rule != RefitRule::kPaper) return out;
  out.rest_fit = find_rest_pairs(out.spheres, ignored, nullptr);
  out.rest_detect = find_rest_pairs(out.spheres, ignored, &BoundSphere::detect_radius);
  return out;
}

}  // namespace spherechain::baker

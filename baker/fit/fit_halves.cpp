// SPDX-License-Identifier: GPL-3.0-or-later
// The fit for any body: the skin of each region is halved where its sphere fits worst, until there are enough.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>

#include "fit/fit.h"
#include "mesh/even_directions.h"
#include "mesh/surface_query.h"

namespace spherechain::baker {
namespace {

constexpr std::size_t kSampled = 2000;      // triangles of a piece that place its sphere
constexpr std::size_t kFewTriangles = 400;  // of a piece whose ball encloses the middles of edges too
constexpr double kEnclosed = 0.95;          // of a piece's area, by its ball
constexpr double kFarCounts = 2;            // times the limit: the error of skin beyond it, besides its distance
constexpr double kProtrusionCounts = 0.1;   // as much as skin that is as far from its sphere
constexpr double kMovesAlike = 0.8;         // of the mean weights of two spheres' skin
constexpr double kJoined = 0.01;  // of the height: a part whose skin is farther from the one it hangs on is apart

// Triangles with one sphere.
struct Piece {
  std::vector<Index> triangles;
  Ball ball;
  // The skin's area times its distance from the sphere, and the same of the sphere where it is outside the skin. What
  // is farther than a limit counts more.
  double error;
  double far_area;  // of the skin farther than a limit
};

class Halver {
 public:
  // Farther than `far` from its sphere the skin is badly fitted.
  Halver(const Mesh& mesh, double far) : mesh_(mesh), surface_(mesh), far_(far) {}

  // The ball around all but the outermost skin, which goes a quarter at a time: a spike moves the centre until it is
  // gone.
  Piece enclose(std::vector<Index> triangles) const {
    constexpr int kRounds = 4;
    struct Sample {
      Vec3 point;
      double area, distance;
    };
    const bool edges = triangles.size() <= kFewTriangles;
    std::vector<Sample> samples;
    double area = 0;
    const std::size_t step = (triangles.size() + kSampled - 1) / kSampled;
    for (std::size_t i = 0; i < triangles.size(); i += step) {
      const Triangle& v = mesh_.triangles[triangles[i]];
      const double own = triangle_area(mesh_, triangles[i]), share = own / (edges ? 6 : 3);
      for (std::size_t k = 0; k < 3; ++k) {
        samples.push_back({mesh_.positions[v[k]], share, 0});
        if (edges) samples.push_back({0.5 * (mesh_.positions[v[k]] + mesh_.positions[v[(k + 1) % 3]]), share, 0});
      }
      area += own;
    }
    const auto ball_of_samples = [&] {
      std::vector<Vec3> points;
      points.reserve(samples.size());
      for (const Sample& sample : samples) points.push_back(sample.point);
      return minimum_enclosing_ball(points);
    };
    Ball ball = ball_of_samples();
    double enclosed = area;
    for (int round = 1; round <= kRounds; ++round) {
      for (Sample& sample : samples) sample.distance = (sample.point - ball.center).norm();
      std::stable_sort(samples.begin(), samples.end(),
                       [](const Sample& a, const Sample& b) { return a.distance < b.distance; });
      const double keep = (1 - (1 - kEnclosed) * round / kRounds) * area;
      bool fewer = false;
      while (samples.size() > 3 && enclosed - samples.back().area >= keep) {
        enclosed -= samples.back().area;
        samples.pop_back();
        fewer = true;
      }
      if (fewer) ball = ball_of_samples();
    }
    return adjust(std::move(triangles), ball);
  }

  // As the paper adjusts a torso sphere: inwards, to where the skin is nearest to the sphere's surface. A patch of skin
  // has its ball's centre on the skin; a tube has it inside, and its normals cancel.
  Piece adjust(std::vector<Index> triangles, const Ball& ball) const {
    constexpr int kSteps = 12;
    constexpr double kFarthest = 1.5;  // radii
    Vec3 normal = Vec3::Zero();
    double area = 0;
    for (const Index t : triangles) {
      normal += 0.5 * triangle_cross(mesh_, t);
      area += triangle_area(mesh_, t);
    }
    // No deeper than half of the way to the skin on the other side: there the sphere would come out.
    const auto opposite = surface_.first_hit(ball.center - 1e-3 * ball.radius * normal.normalized(), -normal);
    const double deepest =
        opposite ? std::min(kFarthest * normal.norm() / area * ball.radius, 0.5 * opposite->distance) : 0;
    const Vec3 inwards = -deepest * normal.normalized();
    Piece best{{}, ball, std::numeric_limits<double>::max(), 0};
    for (int step = 0; step <= kSteps; ++step) {
      const Piece moved = measure(triangles, {ball.center + static_cast<double>(step) / kSteps * inwards, ball.radius});
      if (moved.error < best.error) best = moved;
    }
    best.triangles = std::move(triangles);
    return best;
  }

  // The best sphere around a ball's centre. Its radius is one of a few quantiles of the skin's distance: a sphere that
  // lies half outside the skin at the median is better smaller. The detect radius reaches the rest.
  Piece measure(const std::vector<Index>& triangles, const Ball& ball) const {
    constexpr double kSmallest = 0.25;  // of the ball: of a few triangles the middles may all be at its centre
    std::vector<std::pair<double, double>> distances;
    distances.reserve(triangles.size());
    for (const Index t : triangles) {
      distances.emplace_back((triangle_centroid(mesh_, t) - ball.center).norm(), triangle_area(mesh_, t));
    }
    Piece best{{}, ball, std::numeric_limits<double>::max(), 0};
    for (const double quantile : {0.5, 0.35, 0.2, 0.1}) {
      const double radius = std::max(weighted_quantile(distances, quantile), kSmallest * ball.radius);
      Piece piece{{}, {ball.center, radius}, 0, 0};
      for (const auto& [distance, own] : distances) {
        const double off = std::abs(distance - radius);
        piece.error += own * penalty(off);
        if (off > far_) piece.far_area += own;
      }
      if (piece.error < best.error) piece.error += kProtrusionCounts * protrusion(piece.ball);
      if (piece.error < best.error) best = piece;
    }
    return best;
  }

  // Across the longest extent, in its middle. One half is empty where there is nothing to cut.
  std::pair<std::vector<Index>, std::vector<Index>> halve(const std::vector<Index>& triangles) const {
    Vec3 centroid = Vec3::Zero();
    double area = 0;
    for (const Index t : triangles) {
      centroid += triangle_area(mesh_, t) * triangle_centroid(mesh_, t);
      area += triangle_area(mesh_, t);
    }
    centroid /= area;
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const Index t : triangles) {
      for (const Index v : mesh_.triangles[t]) {
        const Vec3 d = mesh_.positions[v] - centroid;
        covariance += triangle_area(mesh_, t) * d * d.transpose();
      }
    }
    const Vec3 axis = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors().col(2);
    double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();
    for (const Index t : triangles) {
      const double along = triangle_centroid(mesh_, t).dot(axis);
      low = std::min(low, along);
      high = std::max(high, along);
    }
    std::pair<std::vector<Index>, std::vector<Index>> halves;
    for (const Index t : triangles) {
      (triangle_centroid(mesh_, t).dot(axis) > 0.5 * (low + high) ? halves.first : halves.second).push_back(t);
    }
    return halves;
  }

 private:
  double penalty(double distance) const { return distance + (distance > far_ ? kFarCounts * far_ : 0); }

  // The area of a sphere outside the skin, times how far it is outside.
  double protrusion(const Ball& ball) const {
    double sum = 0;
    for (const Vec3& direction : directions_) {
      const Vec3 point = ball.center + ball.radius * direction;
      const SurfaceHit hit = surface_.closest(point);
      if ((point - hit.point).dot(triangle_cross(mesh_, hit.triangle)) > 0) sum += penalty(hit.distance);
    }
    const double area = 4 * std::numbers::pi * ball.radius * ball.radius;
    return area * sum / static_cast<double>(directions_.size());
  }

  const Mesh& mesh_;
  SurfaceQuery surface_;
  double far_;
  std::vector<Vec3> directions_ = even_directions(32);
};

struct Region {
  std::vector<Index> triangles;
  std::vector<Piece> pieces;

  double worst() const {
    double most = 0;
    for (const Piece& piece : pieces) most = std::max(most, piece.error);
    return most;
  }
  // Each triangle to the sphere whose surface is nearest to it, unless a sphere would lose all of its own.
  void share_again(const Halver& halver, const Mesh& mesh) {
    std::vector<std::vector<Index>> shares(pieces.size());
    for (const Index t : triangles) {
      const Vec3 p = triangle_centroid(mesh, t);
      std::size_t nearest = 0;
      for (std::size_t i = 1; i < pieces.size(); ++i) {
        if (std::abs(signed_f(pieces[i].ball, p)) < std::abs(signed_f(pieces[nearest].ball, p))) nearest = i;
      }
      shares[nearest].push_back(t);
    }
    if (std::any_of(shares.begin(), shares.end(), [](const auto& share) { return share.empty(); })) return;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      pieces[i] = halver.measure(shares[i], pieces[i].ball);
      pieces[i].triangles = std::move(shares[i]);
    }
  }
  // Whether the worst piece could be halved; else it is done with.
  bool halve_worst(const Halver& halver) {
    const auto worst = std::max_element(pieces.begin(), pieces.end(),
                                        [](const Piece& a, const Piece& b) { return a.error < b.error; });
    auto [one, other] = halver.halve(worst->triangles);
    if (one.empty() || other.empty()) {
      worst->error = 0;
      return false;
    }
    *worst = halver.enclose(std::move(one));
    pieces.push_back(halver.enclose(std::move(other)));
    return true;
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
void share_spheres(const Halver& halver, std::vector<std::vector<Region*>>& groups, const FitSettings& settings,
                   double area, std::size_t kept) {
  std::size_t spheres = kept;
  for (const std::vector<Region*>& group : groups) spheres += group.size();
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
    double most = 0;
    std::vector<Region*>* next = nullptr;
    for (std::vector<Region*>& group : groups) {
      if (spheres + group.size() > limit || group.front()->worst() <= most) continue;
      most = group.front()->worst();
      next = &group;
    }
    if (next == nullptr) return;
    for (Region* region : *next) spheres += region->halve_worst(halver) ? 1 : 0;
  }
}

// The bones that move each sphere's skin, with their mean weights.
std::vector<std::map<Index, double>> mean_weights(const Character& character, const Spheres& spheres) {
  std::vector<std::map<Index, double>> means(spheres.spheres.size());
  if (character.rig.weights.empty()) return means;
  std::vector<double> area(means.size(), 0.0);
  for (std::size_t t = 0; t < spheres.of_skin.size(); ++t) {
    const double share = triangle_area(character.skin, t) / 3;
    for (const Index corner : character.source_triangles[character.skin_source_triangle[t]]) {
      const VertexWeights& weights = character.rig.weights[corner];
      for (std::size_t k = 0; k < kMaxInfluences; ++k) {
        if (weights.weight[k] > 0) means[spheres.of_skin[t]][weights.joint[k]] += share * weights.weight[k];
      }
      area[spheres.of_skin[t]] += share;
    }
  }
  for (std::size_t i = 0; i < means.size(); ++i) {
    for (auto& [bone, weight] : means[i]) weight /= area[i];
  }
  return means;
}

double overlap(const std::map<Index, double>& a, const std::map<Index, double>& b) {
  double sum = 0;
  for (const auto& [bone, weight] : a) {
    const auto other = b.find(bone);
    if (other != b.end()) sum += std::min(weight, other->second);
  }
  return sum;
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

std::vector<std::pair<std::uint32_t, std::uint32_t>> find_links(const Character& character, const Regions& regions,
                                                                const Spheres& spheres) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> links;
  const std::vector<std::map<Index, double>> weights = mean_weights(character, spheres);
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

}  // namespace

Spheres fit_halves(const Character& character, const Regions& regions, const FitSettings& settings,
                   const KeptSpheres& kept) {
  const Mesh& skin = character.skin;
  const Halver halver(skin, kWellFitted * regions.frame.height);
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
    all[id].pieces.push_back(halver.enclose(all[id].triangles));
    halved.push_back(&all[id]);
  }
  std::vector<std::vector<Region*>> groups = mirrored(skin, regions, halved);
  share_spheres(halver, groups, settings, area, kept_spheres);
  constexpr int kRounds = 2;
  for (Region* region : halved) {
    for (int round = 0; round < kRounds; ++round) region->share_again(halver, skin);
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
    for (const Piece& piece : pieces) {
      for (const Index t : piece.triangles) out.of_skin[t] = static_cast<std::uint32_t>(out.spheres.size());
      add({piece.ball, id, -1, Side::kNone, axis, false});
    }
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

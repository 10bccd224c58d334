// SPDX-License-Identifier: GPL-3.0-or-later
// The climbing disk of section 3.2: N_s = 2 spheres a level, one for each half of the disk.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "fit/fit.h"
#include "fit/march.h"
#include "mesh/error.h"
#include "mesh/ring.h"

namespace spherechain::baker {
namespace {

struct Level {
  double height;             // along frame.up from frame.origin
  Vec3 disk;                 // centre of the disk
  std::array<Ball, 2> half;  // phi1: left, right

  double radius() const { return std::max(half[0].radius, half[1].radius); }
};

class TorsoDisk {
 public:
  TorsoDisk(const Mesh& mesh, const Regions& regions, int rays)
      : torso_(mesh, triangles_of_region(regions, kTorso)), frame_(regions.frame), regions_(regions), rays_(rays) {}

  // Nothing where a half of the disk meets no skin.
  std::optional<Level> at(double height) const {
    // Rays leave through shoulders and hips where limbs were cut off: those meet nothing and say nothing.
    const Ring first = cast_ring(torso_, axis_at(height), frame_.up, frame_.left, rays_);
    const Vec3 centroid = first.section_centroid();
    Level level{height, centroid, {}};
    // The halves are those of the body: the disk stays in the plane of symmetry.
    level.disk -= (centroid - frame_.origin).dot(frame_.left) * frame_.left;
    const Ring disk = cast_ring(torso_, level.disk, frame_.up, frame_.left, rays_);
    for (std::size_t side = 0; side < 2; ++side) {
      const auto ball = half_ball(disk, side == 0 ? 1.0 : -1.0);
      if (!ball) return std::nullopt;
      level.half[side] = *ball;
    }
    return level;
  }

 private:
  // On the straight line from hip to chest and beyond.
  Vec3 axis_at(double height) const {
    const auto h = [&](const Vec3& p) { return (p - frame_.origin).dot(frame_.up); };
    const double f = (height - h(regions_.hip)) / (h(regions_.chest) - h(regions_.hip));
    return regions_.hip + f * (regions_.chest - regions_.hip);
  }

  // phi1: "located in the center of the diameter" (section 3.1): the middle of the half-section's extent sideways and
  // front to back, and half of the larger extent.
  std::optional<Ball> half_ball(const Ring& disk, double sign) const {
    double side = 0, front = -std::numeric_limits<double>::max(), back = std::numeric_limits<double>::max();
    int count = 0;
    for (const auto& hit : disk.hits) {
      if (!hit) continue;
      const Vec3 d = hit->point - disk.center;
      if (sign * d.dot(frame_.left) < -1e-9 * frame_.height) continue;
      side = std::max(side, sign * d.dot(frame_.left));
      front = std::max(front, d.dot(frame_.forward));
      back = std::min(back, d.dot(frame_.forward));
      ++count;
    }
    if (count < 3 || side <= 0 || front <= back) return std::nullopt;
    return Ball{disk.center + 0.5 * sign * side * frame_.left + 0.5 * (front + back) * frame_.forward,
                0.5 * std::max(side, front - back)};
  }

  SurfaceQuery torso_;
  const BodyFrame& frame_;
  const Regions& regions_;
  int rays_;
};

// The sphere adjustment: towards the disk's centre in its plane, scaled down, to the least mean |F|. The radius with
// the least mean |F| around a centre is the median distance.
Ball adjust(const Ball& phi1, const Vec3& disk, const Vec3& up, const Mesh& mesh, const std::vector<Index>& vertices) {
  if (vertices.empty()) return phi1;
  Vec3 towards = disk - phi1.center;
  towards -= towards.dot(up) * up;
  Ball best = phi1;
  double least = f_error(phi1, mesh, vertices).mean_abs;
  constexpr int kSteps = 200;
  for (int i = 0; i <= kSteps; ++i) {
    Ball candidate{phi1.center + static_cast<double>(i) / kSteps * towards, 0};
    std::vector<double> distances;
    distances.reserve(vertices.size());
    for (const Index v : vertices) distances.push_back((mesh.positions[v] - candidate.center).norm());
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    candidate.radius = std::min(*middle, phi1.radius);
    const double mean = f_error(candidate, mesh, vertices).mean_abs;
    if (mean < least) {
      least = mean;
      best = candidate;
    }
  }
  return best;
}

double mean_depth(const Level& a, const Level& b) {
  return 0.5 * (penetration_depth(a.half[0], b.half[0]) + penetration_depth(a.half[1], b.half[1]));
}

// The disk climbs by delta from the crotch; between two of its positions a level's place is found by bisection. The
// first level stands on the crotch, the others overlap the one below by PD, the last ends below the neck.
std::vector<Level> place_levels(const TorsoDisk& disk, const Regions& regions, const FitSettings& settings) {
  const double bottom = regions.torso.crotch, neck = regions.torso.neck;
  const double step = settings.delta * regions.frame.height;
  const auto first = [&](double from, const auto& reached) -> std::optional<Level> {
    const auto height = first_where(from, neck, step, [&](double h) {
      const auto level = disk.at(h);
      return level && reached(*level);
    });
    return height ? disk.at(*height) : std::nullopt;
  };
  std::vector<Level> levels;
  auto level = first(bottom, [&](const Level& l) { return l.height - bottom >= l.radius(); });
  while (level && level->height < neck - 0.5 * level->radius()) {
    levels.push_back(*level);
    level = first(level->height,
                  [&](const Level& l) { return mean_depth(levels.back(), l) <= settings.penetration_depth; });
  }
  return levels;
}

// The heights between which a level's fits are judged: halfway to its neighbours, as far on the side without one, its
// radius where it has none.
std::pair<double, double> band_of(const std::vector<Level>& levels, std::size_t i) {
  const bool has_below = i > 0, has_above = i + 1 < levels.size();
  const double h = levels[i].height;
  double below = has_below ? 0.5 * (h - levels[i - 1].height) : levels[i].radius();
  double above = has_above ? 0.5 * (levels[i + 1].height - h) : levels[i].radius();
  if (has_below && !has_above) above = below;
  if (has_above && !has_below) below = above;
  return {h - below, h + above};
}

}  // namespace

void fit_torso(const Mesh& mesh, const Regions& regions, const FitSettings& settings, const std::string& file,
               Spheres& out) {
  const BodyFrame& frame = regions.frame;
  const std::vector<Level> levels = place_levels(TorsoDisk(mesh, regions, settings.rays), regions, settings);
  if (levels.empty()) {
    throw Error(ExitCode::kSegmentation, file + ": the torso has no level between hip and neck that a disk fits in");
  }
  std::vector<bool> in_torso(mesh.positions.size(), false);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (regions.of_triangle[t] != kTorso) continue;
    for (const Index v : mesh.triangles[t]) in_torso[v] = true;
  }
  // A vertex in the plane of symmetry is both halves'.
  const double on_plane = 1e-6 * frame.height;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const auto [low, high] = band_of(levels, i);
    for (const Side side : {Side::kLeft, Side::kRight}) {
      const double sign = side == Side::kLeft ? 1 : -1;
      TorsoFit fit{levels[i].half[side == Side::kLeft ? 0 : 1], {}, {}, {}};
      for (Index v = 0; v < mesh.positions.size(); ++v) {
        const double h = (mesh.positions[v] - frame.origin).dot(frame.up);
        const double across = sign * (mesh.positions[v] - levels[i].disk).dot(frame.left);
        if (in_torso[v] && h >= low && h < high && across >= -on_plane) fit.vertices.push_back(v);
      }
      fit.phi1_adjusted = adjust(fit.phi1, levels[i].disk, frame.up, mesh, fit.vertices);
      fit.phi2 = fit.vertices.empty() ? fit.phi1 : minimum_enclosing_ball(mesh, fit.vertices);
      out.spheres.push_back({fit.phi1_adjusted, kTorso, static_cast<int>(i), side, frame.up, false});
      out.torso.push_back(std::move(fit));
    }
    out.level_heights.push_back(levels[i].height);
  }
}

}  // namespace spherechain::baker

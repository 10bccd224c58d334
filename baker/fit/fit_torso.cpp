// SPDX-License-Identifier: GPL-3.0-or-later
// The climbing disk of section 3.2: N_s spheres a level, one for each part of the disk.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "baker/fit/fit.h"
#include "baker/fit/march.h"
#include "baker/mesh/ring.h"

namespace spherechain::baker {
namespace {

// A part of the disk between two planes along the body; phi1 in it.
struct Part {
  Side side;
  double right, left;  // along frame.left from the disk's centre; the outermost parts end at the skin
  Ball ball;
};

struct Level {
  double height;            // along frame.up from frame.origin
  Vec3 disk;                // centre of the disk
  std::vector<Part> parts;  // from left to right

  double radius() const {
    double radius = 0;
    for (const Part& part : parts) radius = std::max(radius, part.ball.radius);
    return radius;
  }
};

class TorsoDisk {
 public:
  TorsoDisk(const Mesh& mesh, const Regions& regions, const FitSettings& settings)
      : torso_(mesh, triangles_of_region(regions, regions.torso_region())),
        frame_(regions.frame),
        regions_(regions),
        rays_(settings.rays),
        parts_(settings.spheres_per_level) {}

  // Nothing where a part of the disk meets no skin.
  std::optional<Level> at(double height) const {
    // Rays leave through shoulders and hips where limbs were cut off: those meet nothing and say nothing.
    const Ring first = cast_ring(torso_, axis_at(height), frame_.up, frame_.left, rays_);
    const Vec3 centroid = first.section_centroid();
    Level level{height, centroid, {}};
    // The sides are those of the body: the disk stays in the plane of symmetry.
    level.disk -= (centroid - frame_.origin).dot(frame_.left) * frame_.left;
    const Ring disk = cast_ring(torso_, level.disk, frame_.up, frame_.left, rays_);
    double left = 0, right = 0;
    for (const auto& hit : disk.hits) {
      if (!hit) continue;
      const double across = (hit->point - disk.center).dot(frame_.left);
      left = std::max(left, across);
      right = std::max(right, -across);
    }
    // Parts of equal width on either side of the plane of symmetry.
    const auto plane = [&](int i) {
      const double f = 1 - 2.0 * i / parts_;
      return f * (f > 0 ? left : right);
    };
    for (int i = 0; i < parts_; ++i) {
      const auto ball = phi1(disk, plane(i + 1), plane(i));
      if (!ball) return std::nullopt;
      const Side side = 2 * i + 1 == parts_ ? Side::kNone : 2 * i < parts_ ? Side::kLeft : Side::kRight;
      level.parts.push_back({side, plane(i + 1), plane(i), *ball});
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

  // "Located in the center of the diameter" (section 3.1): the middle of the part's extent sideways and front to back,
  // and half of the larger extent.
  std::optional<Ball> phi1(const Ring& disk, double right, double left) const {
    double front = -std::numeric_limits<double>::max(), back = std::numeric_limits<double>::max();
    int count = 0;
    const double on_plane = 1e-9 * frame_.height;
    for (const auto& hit : disk.hits) {
      if (!hit) continue;
      const Vec3 d = hit->point - disk.center;
      if (d.dot(frame_.left) < right - on_plane || d.dot(frame_.left) > left + on_plane) continue;
      front = std::max(front, d.dot(frame_.forward));
      back = std::min(back, d.dot(frame_.forward));
      ++count;
    }
    if (count < 3 || left <= right || front <= back) return std::nullopt;
    return Ball{disk.center + 0.5 * (left + right) * frame_.left + 0.5 * (front + back) * frame_.forward,
                0.5 * std::max(left - right, front - back)};
  }

  SurfaceQuery torso_;
  const BodyFrame& frame_;
  const Regions& regions_;
  int rays_, parts_;
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
  double sum = 0;
  for (std::size_t i = 0; i < a.parts.size(); ++i) sum += penetration_depth(a.parts[i].ball, b.parts[i].ball);
  return sum / static_cast<double>(a.parts.size());
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

// The heights between which a level's fits are measured: halfway to its neighbours, as far on the side without one, its
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

std::optional<Reason> fit_torso(const Mesh& mesh, const Regions& regions, const FitSettings& settings, Spheres& out) {
  const BodyFrame& frame = regions.frame;
  if (triangles_of_region(regions, regions.torso_region()).empty()) return Reason{"the torso has no skin"};
  const std::vector<Level> levels = place_levels(TorsoDisk(mesh, regions, settings), regions, settings);
  if (levels.empty()) return Reason{"the torso has no level between hip and neck that a disk fits in"};
  std::vector<bool> in_torso(mesh.positions.size(), false);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (regions.of_triangle[t] != regions.torso_region()) continue;
    for (const Index v : mesh.triangles[t]) in_torso[v] = true;
  }
  // A vertex in the plane between two parts is both parts'.
  const double on_plane = 1e-6 * frame.height;
  constexpr double kEverything = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const auto [low, high] = band_of(levels, i);
    for (const Part& part : levels[i].parts) {
      const double left = &part == &levels[i].parts.front() ? kEverything : part.left + on_plane,
                   right = &part == &levels[i].parts.back() ? -kEverything : part.right - on_plane;
      TorsoFit fit{part.ball, {}, {}, {}, static_cast<std::uint32_t>(out.spheres.size())};
      for (Index v = 0; v < mesh.positions.size(); ++v) {
        const double h = (mesh.positions[v] - frame.origin).dot(frame.up);
        const double across = (mesh.positions[v] - levels[i].disk).dot(frame.left);
        if (in_torso[v] && h >= low && h < high && across >= right && across <= left) fit.vertices.push_back(v);
      }
      fit.phi1_adjusted = adjust(fit.phi1, levels[i].disk, frame.up, mesh, fit.vertices);
      fit.phi2 = fit.vertices.empty() ? fit.phi1 : minimum_enclosing_ball(mesh, fit.vertices);
      out.spheres.push_back(
          {fit.phi1_adjusted, regions.torso_region(), static_cast<int>(i), part.side, frame.up, false});
      out.torso.push_back(std::move(fit));
    }
    out.level_heights.push_back(levels[i].height);
  }
  return std::nullopt;
}

}  // namespace spherechain::baker

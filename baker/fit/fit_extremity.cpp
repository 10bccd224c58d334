// SPDX-License-Identifier: GPL-3.0-or-later
// Head, hands and feet, past neck, wrist and ankle where the paper stops. The march is the limbs', but fingers, toes
// and a mouth leave no one ring of skin to touch: a sphere's surface halves the section's skin.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "fit/fit.h"
#include "fit/march.h"
#include "mesh/ring.h"

namespace spherechain::baker {
namespace {

// The skin across an axis. Positions `s` are along it, in the mesh's own space.
class Sections {
 public:
  Sections(const Mesh& mesh, std::vector<Index> triangles, const Vec3& axis, const Vec3& reference, int rays)
      : mesh_(mesh), triangles_(std::move(triangles)), axis_(axis), rays_(rays) {
    u_ = (reference - reference.dot(axis) * axis).normalized();
    for (const Vec3& p : mesh.positions) along_.push_back(p.dot(axis));
    for (const Index t : triangles_) {
      for (const Index v : mesh.triangles[t]) {
        low_ = std::min(low_, along_[v]);
        high_ = std::max(high_, along_[v]);
      }
    }
  }

  double low() const { return low_; }
  double high() const { return high_; }

  // In the middle of the section's outline and as far from it as the rays are long on average. Nothing where there is
  // no skin.
  std::optional<Ball> at(double s) const {
    const std::vector<Segment> skin = cut(s);
    Vec3 center = Vec3::Zero();
    double length = 0;
    for (const Segment& segment : skin) {
      const double l = (segment.b - segment.a).norm();
      center += 0.5 * l * (segment.a + segment.b);
      length += l;
    }
    if (!(length > 0)) return std::nullopt;
    center /= length;
    for (int pass = 0; pass < 2; ++pass) center = outline(skin, center).section_centroid();
    // A ray stands for as much skin as it is long: in a section as flat as a palm few rays meet much of it.
    double sum = 0, squares = 0;
    for (const auto& hit : outline(skin, center).hits) {
      if (!hit) continue;
      sum += hit->distance;
      squares += hit->distance * hit->distance;
    }
    if (!(sum > 0)) return std::nullopt;
    return Ball{center, squares / sum};
  }

 private:
  struct Segment {
    Vec3 a, b;
  };

  std::vector<Segment> cut(double s) const {
    std::vector<Segment> skin;
    for (const Index t : triangles_) {
      const Triangle& v = mesh_.triangles[t];
      std::array<Vec3, 2> ends;
      std::size_t count = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const Index a = v[k], b = v[(k + 1) % 3];
        if ((along_[a] < s) == (along_[b] < s)) continue;
        const double f = (s - along_[a]) / (along_[b] - along_[a]);
        ends[count++] = mesh_.positions[a] + f * (mesh_.positions[b] - mesh_.positions[a]);
      }
      if (count == 2) skin.push_back({ends[0], ends[1]});
    }
    return skin;
  }

  // A ring whose rays end where they leave the last skin they meet.
  Ring outline(const std::vector<Segment>& skin, const Vec3& center) const {
    Ring ring{center, axis_, u_, axis_.cross(u_), {}};
    for (int k = 0; k < rays_; ++k) {
      const double angle = 2 * std::numbers::pi * k / rays_;
      const Vec3 along = std::cos(angle) * ring.u + std::sin(angle) * ring.v, across = axis_.cross(along);
      double farthest = 0;
      for (const Segment& segment : skin) {
        const double a = (segment.a - center).dot(across), b = (segment.b - center).dot(across);
        if ((a < 0) == (b < 0)) continue;
        farthest = std::max(farthest, (segment.a + a / (a - b) * (segment.b - segment.a) - center).dot(along));
      }
      ring.hits.push_back(farthest > 0 ? std::optional(SurfaceHit{center + farthest * along, farthest, kNoIndex})
                                       : std::nullopt);
    }
    return ring;
  }

  const Mesh& mesh_;
  std::vector<Index> triangles_;
  Vec3 axis_, u_;
  int rays_;
  std::vector<double> along_;
  double low_ = std::numeric_limits<double>::max(), high_ = std::numeric_limits<double>::lowest();
};

// From `start` on, neighbours overlapping by PD, until one reaches the end.
std::vector<Ball> march(const Sections& sections, double start, double step, double depth) {
  const auto reaches_end = [&](double s) {
    const auto ball = sections.at(s);
    return !ball || s + ball->radius >= sections.high();
  };
  const double end = first_where(start, sections.high() + step, step, reaches_end).value_or(start);
  std::vector<Ball> balls{*sections.at(start)};
  const auto far_enough = [&](double s) {
    const auto ball = sections.at(s);
    return ball && penetration_depth(balls.back(), *ball) <= depth;
  };
  double s = start;
  while (const auto next = first_where(s, end, step, far_enough)) {
    s = *next;
    balls.push_back(*sections.at(s));
  }
  if (const auto closing = sections.at(end)) {
    if (penetration_depth(balls.back(), *closing) >= kClosingDepth) balls.pop_back();
    balls.push_back(*closing);
  }
  return balls;
}

// The direction in which the skin is longest, pointing away from `from`.
Vec3 longest_axis(const Mesh& mesh, const std::vector<Index>& triangles, const Vec3& from) {
  Vec3 centroid = Vec3::Zero();
  double area = 0;
  for (const Index t : triangles) {
    centroid += triangle_area(mesh, t) * triangle_centroid(mesh, t);
    area += triangle_area(mesh, t);
  }
  centroid /= area;
  // A triangle's second moment is that of its corners and, nine times, its centroid.
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
  for (const Index t : triangles) {
    const auto add = [&](const Vec3& p, double weight) {
      moment += weight * triangle_area(mesh, t) * (p - centroid) * (p - centroid).transpose();
    };
    for (const Index v : mesh.triangles[t]) add(mesh.positions[v], 1);
    add(triangle_centroid(mesh, t), 9);
  }
  const Vec3 axis = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(moment).eigenvectors().col(2);
  return axis.dot(centroid - from) < 0 ? Vec3(-axis) : axis;
}

// The skin past wrist or ankle: beyond the plane across the limb's end, in one piece with the tip.
std::vector<Index> triangles_past_end(const Mesh& mesh, const Regions& regions, std::uint8_t region) {
  const Limb& limb = regions.limbs[region];
  const double window = 0.02 * regions.frame.height;
  const Vec3 end = limb.line.at(limb.extremity), outward = limb.line.tangent(limb.extremity - window, window);
  Mesh beyond{mesh.positions, {}};
  std::vector<Index> triangles;
  double nearest = std::numeric_limits<double>::max();
  std::size_t tip = 0;
  for (const Index t : triangles_of_region(regions, region)) {
    const Vec3 centroid = triangle_centroid(mesh, t);
    if ((centroid - end).dot(outward) <= 0) continue;
    const double distance = (centroid - limb.line.points().back()).norm();
    if (distance < nearest) {
      nearest = distance;
      tip = triangles.size();
    }
    triangles.push_back(t);
    beyond.triangles.push_back(mesh.triangles[t]);
  }
  const Components pieces = connected_components(beyond);
  std::vector<Index> piece;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (pieces.of_triangle[i] == pieces.of_triangle[tip]) piece.push_back(triangles[i]);
  }
  return piece;
}

}  // namespace

std::vector<FittedSphere> fit_hand_or_foot(const Mesh& mesh, const Regions& regions, std::uint8_t region,
                                           const Ball& last, const FitSettings& settings) {
  const std::vector<Index> triangles = triangles_past_end(mesh, regions, region);
  if (triangles.empty()) return {};
  const Limb& limb = regions.limbs[region];
  const Vec3 axis = longest_axis(mesh, triangles, limb.line.at(limb.extremity));
  const Sections sections(mesh, triangles, axis,
                          Vec3(regions.frame.up + 0.7 * regions.frame.left + 0.3 * regions.frame.forward),
                          settings.rays);
  const double step = settings.delta * regions.frame.height;
  // The first sphere stands inside the near end: a foot's is the heel, behind the ankle.
  const auto inside = [&](double s) {
    const auto ball = sections.at(s);
    return ball && s - sections.low() >= ball->radius && penetration_depth(last, *ball) <= settings.penetration_depth;
  };
  const auto start = first_where(sections.low(), sections.high(), step, inside);
  if (!start) return {};
  const std::vector<Ball> balls = march(sections, *start, step, settings.penetration_depth);
  // Hands and feet are thicker than wrist and ankle; a stump is not, and the limb's last sphere fills it.
  const auto thicker = [&](const Ball& ball) { return ball.radius > last.radius; };
  if (std::none_of(balls.begin(), balls.end(), thicker)) return {};
  std::vector<FittedSphere> spheres;
  for (const Ball& ball : balls) spheres.push_back({ball, region, -1, Side::kNone, axis, true});
  return spheres;
}

std::vector<FittedSphere> fit_head(const Mesh& mesh, const Regions& regions, const Spheres& torso,
                                   const FitSettings& settings) {
  const BodyFrame& frame = regions.frame;
  const Sections sections(mesh, triangles_of_region(regions, kTorso), frame.up, frame.left, settings.rays);
  const double step = settings.delta * frame.height;
  const int top = static_cast<int>(torso.level_heights.size()) - 1;
  const auto far_enough = [&](double s) {
    const auto ball = sections.at(s);
    return ball && std::all_of(torso.spheres.begin(), torso.spheres.end(), [&](const FittedSphere& sphere) {
             return sphere.level < top || penetration_depth(sphere.ball, *ball) <= settings.penetration_depth;
           });
  };
  const double neck = frame.origin.dot(frame.up) + regions.torso.neck;
  const auto start = first_where(neck, sections.high(), step, far_enough);
  if (!start) return {};
  std::vector<FittedSphere> spheres;
  for (const Ball& ball : march(sections, *start, step, settings.penetration_depth)) {
    const int level = top + 1 + static_cast<int>(spheres.size());
    spheres.push_back({ball, kTorso, level, Side::kNone, frame.up, true});
  }
  return spheres;
}

}  // namespace spherechain::baker

// SPDX-License-Identifier: GPL-3.0-or-later
// Head, hands and feet, past neck, wrist and ankle where the paper stops. The march is the limbs', but fingers, toes
// and a mouth leave no one ring of skin to touch: a sphere's surface halves the section's skin.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "baker/fit/fit.h"
#include "baker/fit/march.h"
#include "baker/mesh/decompose.h"
#include "baker/mesh/ring.h"

namespace spherechain::baker {
namespace {

// Share of the limb's last sphere: a chain of growing spheres cannot start at a heel's point.
constexpr double kThinExtremity = 0.25;

// Share of a step: where the skin is folded to nothing, spheres without size would always touch.
constexpr double kThinnest = 0.02;

// The skin across an axis. Positions `s` are along it, in the mesh's own space.
class Sections {
 public:
  Sections(Mesh skin, const Vec3& axis, const Vec3& reference, int rays)
      : skin_(std::move(skin)), axis_(axis), rays_(rays) {
    u_ = (reference - reference.dot(axis) * axis).normalized();
    for (const Vec3& p : skin_.positions) along_.push_back(p.dot(axis));
    for (const Triangle& triangle : skin_.triangles) {
      for (const Index v : triangle) {
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
    const std::vector<Segment> cut = cut_at(s);
    Vec3 center = Vec3::Zero();
    double length = 0;
    for (const Segment& segment : cut) {
      const double l = (segment.b - segment.a).norm();
      center += 0.5 * l * (segment.a + segment.b);
      length += l;
    }
    if (!(length > 0)) return std::nullopt;
    center /= length;
    for (int pass = 0; pass < 2; ++pass) center = outline(cut, center).section_centroid();
    // A ray stands for as much skin as it is long: in a section as flat as a palm few rays meet much of it.
    double sum = 0, squares = 0;
    for (const auto& hit : outline(cut, center).hits) {
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

  std::vector<Segment> cut_at(double s) const {
    std::vector<Segment> cut;
    for (const Triangle& v : skin_.triangles) {
      std::array<Vec3, 2> ends;
      std::size_t count = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const Index a = v[k], b = v[(k + 1) % 3];
        if ((along_[a] < s) == (along_[b] < s)) continue;
        const double f = (s - along_[a]) / (along_[b] - along_[a]);
        ends[count++] = skin_.positions[a] + f * (skin_.positions[b] - skin_.positions[a]);
      }
      if (count == 2) cut.push_back({ends[0], ends[1]});
    }
    return cut;
  }

  // A ring whose rays end where they leave the last skin they meet.
  Ring outline(const std::vector<Segment>& cut, const Vec3& center) const {
    Ring ring{center, axis_, u_, axis_.cross(u_), {}};
    for (int k = 0; k < rays_; ++k) {
      const double angle = 2 * std::numbers::pi * k / rays_;
      const Vec3 along = std::cos(angle) * ring.u + std::sin(angle) * ring.v, across = axis_.cross(along);
      double farthest = 0;
      for (const Segment& segment : cut) {
        const double a = (segment.a - center).dot(across), b = (segment.b - center).dot(across);
        if ((a < 0) == (b < 0)) continue;
        farthest = std::max(farthest, (segment.a + a / (a - b) * (segment.b - segment.a) - center).dot(along));
      }
      ring.hits.push_back(farthest > 0 ? std::optional(SurfaceHit{center + farthest * along, farthest, kNoIndex})
                                       : std::nullopt);
    }
    return ring;
  }

  Mesh skin_;
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
    return ball && ball->radius >= kThinnest * step && penetration_depth(balls.back(), *ball) <= depth;
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
Vec3 longest_axis(const Mesh& skin, const Vec3& from) {
  const Vec3 centroid = surface_centroid(skin);
  // A triangle's second moment is that of its corners and, nine times, its centroid.
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
  for (std::size_t t = 0; t < skin.triangles.size(); ++t) {
    const auto add = [&](const Vec3& p, double weight) {
      moment += weight * triangle_area(skin, t) * (p - centroid) * (p - centroid).transpose();
    };
    for (const Index v : skin.triangles[t]) add(skin.positions[v], 1);
    add(triangle_centroid(skin, t), 9);
  }
  const Vec3 axis = principal_axes(moment).vectors.col(2);
  return axis.dot(centroid - from) < 0 ? Vec3(-axis) : axis;
}

struct Plane {
  Vec3 point, normal;
  double distance(const Vec3& p) const { return (p - point).dot(normal); }
};

// Across wrist or ankle, facing outwards.
Plane end_of_limb(const Regions& regions, const Limb& limb) {
  const double window = 0.02 * regions.frame.height;
  return {limb.line.at(limb.extremity), limb.line.tangent(limb.extremity - window, window)};
}

// The piece of a region with its tip beyond the plane, cut along it: triangles of any size end there alike.
Mesh skin_beyond(const Plane& plane, const Mesh& mesh, const std::vector<Index>& region, const Vec3& tip) {
  Mesh beyond{mesh.positions, {}};
  double nearest = std::numeric_limits<double>::max();
  std::size_t at_tip = 0;
  for (const Index t : region) {
    const Triangle& v = mesh.triangles[t];
    if (std::none_of(v.begin(), v.end(), [&](Index i) { return plane.distance(mesh.positions[i]) > 0; })) continue;
    const double distance = (triangle_centroid(mesh, t) - tip).norm();
    if (distance < nearest) {
      nearest = distance;
      at_tip = beyond.triangles.size();
    }
    beyond.triangles.push_back(v);
  }
  const Components pieces = connected_components(beyond);
  Mesh skin;
  for (std::size_t t = 0; t < beyond.triangles.size(); ++t) {
    if (pieces.of_triangle[t] != pieces.of_triangle[at_tip]) continue;
    const auto first = static_cast<Index>(skin.positions.size());
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &a = mesh.positions[beyond.triangles[t][k]], &b = mesh.positions[beyond.triangles[t][(k + 1) % 3]];
      const double da = plane.distance(a), db = plane.distance(b);
      if (da > 0) skin.positions.push_back(a);
      if ((da > 0) != (db > 0)) skin.positions.emplace_back(a + da / (da - db) * (b - a));
    }
    for (auto corner = first + 2; corner < skin.positions.size(); ++corner) {
      skin.triangles.push_back({first, corner - 1, corner});
    }
  }
  return skin;
}

}  // namespace

std::vector<FittedSphere> fit_hand_or_foot(const Mesh& mesh, const Regions& regions, std::uint8_t region,
                                           const Ball& last, const FitSettings& settings) {
  const Limb& limb = regions.limbs[region];
  const BodyFrame& frame = regions.frame;
  const Plane end = end_of_limb(regions, limb);
  Mesh skin = skin_beyond(end, mesh, triangles_of_region(regions, region), limb.line.points().back());
  if (skin.triangles.empty()) return {};
  const Vec3 axis = longest_axis(skin, end.point);
  const Sections sections(std::move(skin), axis, frame.up + 0.7 * frame.left + 0.3 * frame.forward, settings.rays);
  const double step = settings.delta * frame.height;
  // A hand goes on from the limb's last sphere; a foot turns, and its first sphere stands in its end behind the ankle.
  const bool turns = axis.dot(end.normal) < 0.7;
  const auto inside = [&](double s) {
    const auto ball = sections.at(s);
    return ball && s - sections.low() >= ball->radius && ball->radius >= kThinExtremity * last.radius &&
           (turns || penetration_depth(last, *ball) <= settings.penetration_depth);
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
  Mesh skin{mesh.positions, {}};
  for (const Index t : triangles_of_region(regions, regions.torso_region()))
    skin.triangles.push_back(mesh.triangles[t]);
  const Sections sections(std::move(skin), frame.up, frame.left, settings.rays);
  const double step = settings.delta * frame.height;
  const int top = static_cast<int>(torso.level_heights.size()) - 1;
  const auto far_enough = [&](double s) {
    const auto ball = sections.at(s);
    return ball && std::all_of(torso.spheres.begin(), torso.spheres.end(), [&](const FittedSphere& sphere) {
             return sphere.level < top || penetration_depth(sphere.ball, *ball) <= settings.penetration_depth;
           });
  };
  const double neck = frame.origin.dot(frame.up) + regions.torso.neck;
  // A trunk that ends far below the neck leaves room for more: from its top level on.
  const auto at_neck = sections.at(neck);
  const bool far = at_neck && std::none_of(torso.spheres.begin(), torso.spheres.end(), [&](const FittedSphere& sphere) {
                     return penetration_depth(sphere.ball, *at_neck) > 0;
                   });
  const double from = far ? frame.origin.dot(frame.up) + torso.level_heights.back() : neck;
  const auto start = first_where(from, sections.high(), step, far_enough);
  if (!start) return {};
  std::vector<FittedSphere> spheres;
  for (const Ball& ball : march(sections, *start, step, settings.penetration_depth)) {
    const int level = top + 1 + static_cast<int>(spheres.size());
    spheres.push_back({ball, regions.torso_region(), level, Side::kNone, frame.up, true});
  }
  return spheres;
}

}  // namespace spherechain::baker

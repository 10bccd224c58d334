// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fit/piece.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "baker/mesh/area_samples.h"
#include "baker/mesh/decompose.h"
#include "baker/mesh/even_directions.h"

namespace spherechain::baker {
namespace {

constexpr std::size_t kSampled = 200;      // points of a piece that place its sphere
constexpr double kFarCounts = 2;           // times the limit: the error of skin beyond it, besides its distance
constexpr double kProtrusionCounts = 0.1;  // as much as skin that is as far from its sphere
constexpr double kSmallest = 0.1;          // times the limit: the least radius
constexpr int kDirections = 16;            // points of a sphere that tell how far it is outside the skin

}  // namespace

PieceFitter::PieceFitter(const Mesh& skin, double far)
    : mesh_(skin), far_(far), surface_(skin), directions_(even_directions(kDirections)) {
  first_.reserve(skin.triangles.size() + 1);
  for (std::size_t t = 0; t < skin.triangles.size(); ++t) {
    first_.push_back(samples_.size());
    for_each_area_sample(skin, t, far, [&](const Vec3& p, double area) {
      samples_.push_back({p, area, static_cast<Index>(t)});
    });
  }
  first_.push_back(samples_.size());
}

double PieceFitter::penalty(double distance) const { return distance + (distance > far_ ? kFarCounts * far_ : 0); }

// The area of a sphere outside the skin, times how far it is outside; or more than the bound.
double PieceFitter::protrusion(const Ball& ball, double bound) const {
  const double area = 4 * std::numbers::pi * ball.radius * ball.radius / static_cast<double>(directions_.size());
  double sum = 0;
  for (const Vec3& direction : directions_) {
    const Vec3 point = ball.center + ball.radius * direction;
    const SurfaceHit hit = surface_.closest(point);
    if ((point - hit.point).dot(triangle_cross(mesh_, hit.triangle)) > 0) sum += area * penalty(hit.distance);
    if (sum >= bound) return std::numeric_limits<double>::max();
  }
  return sum;
}

Samples PieceFitter::samples_of(const std::vector<Index>& triangles) const {
  Samples out;
  for (const Index t : triangles) {
    for (std::size_t i = first_[t]; i < first_[t + 1]; ++i) out.push_back(static_cast<std::uint32_t>(i));
  }
  return out;
}

double PieceFitter::error_of(std::uint32_t sample, const Ball& ball) const {
  const Sample& at = samples_[sample];
  return at.area * penalty(std::abs((at.point - ball.center).norm() - ball.radius));
}

Piece PieceFitter::measured(Samples samples, const Ball& ball) const {
  Piece piece{std::move(samples), ball, 0, 0};
  for (const std::uint32_t i : piece.samples) {
    const double off = std::abs((samples_[i].point - ball.center).norm() - ball.radius);
    piece.error += samples_[i].area * penalty(off);
    if (off > far_) piece.far_area += samples_[i].area;
  }
  piece.error += kProtrusionCounts * protrusion(ball, std::numeric_limits<double>::max());
  return piece;
}

// Evenly along the area.
std::vector<PieceFitter::Sample> PieceFitter::some_samples(const Samples& samples) const {
  double area = 0;
  for (const std::uint32_t i : samples) area += samples_[i].area;
  std::vector<Sample> out;
  const double each = samples.size() <= kSampled ? 0 : area / static_cast<double>(kSampled);
  double waiting = 0;
  for (const std::uint32_t i : samples) {
    waiting += samples_[i].area;
    if (waiting < each) continue;
    out.push_back({samples_[i].point, waiting, samples_[i].triangle});
    waiting = 0;
  }
  if (waiting > 0 && !out.empty()) out.back().area += waiting;
  return out;
}

// Moves centre and radius in ever smaller steps while the error falls: along the axes, and inwards while the sphere's
// outer side stays where it is.
Ball PieceFitter::search(Ball ball, const std::vector<Sample>& samples, const Vec3& normal) const {
  constexpr int kHalvings = 4, kTries = 60;
  const double smallest = kSmallest * far_;
  const auto error = [&](const Ball& at, double bound) {
    double sum = 0;
    for (const Sample& sample : samples) {
      sum += sample.area * penalty(std::abs((sample.point - at.center).norm() - at.radius));
      if (sum >= bound) return std::numeric_limits<double>::max();
    }
    return sum + kProtrusionCounts * protrusion(at, (bound - sum) / kProtrusionCounts);
  };
  std::vector<std::pair<Vec3, double>> moves;
  if (normal.norm() > 0) {
    moves.emplace_back(-normal, 1);
    moves.emplace_back(normal, -1);
    moves.emplace_back(-normal, 0);
    moves.emplace_back(normal, 0);
  }
  moves.emplace_back(Vec3::Zero(), -1);
  moves.emplace_back(Vec3::Zero(), 1);
  for (Eigen::Index k = 0; k < 3; ++k) {
    moves.emplace_back(Vec3::Unit(k), 0);
    moves.emplace_back(-Vec3::Unit(k), 0);
  }
  double least = error(ball, std::numeric_limits<double>::max());
  double step = 2 * far_;
  for (int halving = 0; halving <= kHalvings; ++halving, step *= 0.5) {
    bool any = true;
    for (int tries = 0; any && tries < kTries; ++tries) {
      any = false;
      for (const auto& [direction, growth] : moves) {
        const Ball moved{ball.center + step * direction, ball.radius + step * growth};
        if (moved.radius < smallest) continue;
        const double now = error(moved, least);
        if (now >= least) continue;
        least = now;
        ball = moved;
        any = true;
      }
    }
  }
  return ball;
}

Piece PieceFitter::fit_from(const Ball& ball, Samples samples) const {
  Vec3 normal = Vec3::Zero();
  for (const std::uint32_t i : samples) {
    normal += samples_[i].area * triangle_cross(mesh_, samples_[i].triangle).normalized();
  }
  if (normal.norm() > 0) normal.normalize();
  const Ball found = search(ball, some_samples(samples), normal);
  return measured(std::move(samples), found);
}

// From the middle of the skin, with its mean distance.
Piece PieceFitter::fit(Samples samples) const {
  Vec3 center = Vec3::Zero();
  double area = 0;
  for (const std::uint32_t i : samples) {
    center += samples_[i].area * samples_[i].point;
    area += samples_[i].area;
  }
  center /= area;
  double radius = 0;
  for (const std::uint32_t i : samples) radius += samples_[i].area / area * (samples_[i].point - center).norm();
  return fit_from({center, std::max(radius, kSmallest * far_)}, std::move(samples));
}

std::optional<std::pair<Piece, Piece>> PieceFitter::halve(const Piece& piece) const {
  constexpr double kAsLong = 0.6;  // of the longest: variance along another axis that is worth a try
  Vec3 centroid = Vec3::Zero();
  double area = 0;
  for (const std::uint32_t i : piece.samples) {
    centroid += samples_[i].area * samples_[i].point;
    area += samples_[i].area;
  }
  centroid /= area;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const std::uint32_t i : piece.samples) {
    const Vec3 d = samples_[i].point - centroid;
    covariance += samples_[i].area * d * d.transpose();
  }
  const PrincipalAxes eigen = principal_axes(covariance);
  std::optional<std::pair<Piece, Piece>> best;
  for (const Eigen::Index column : {2, 1}) {
    if (eigen.values[column] < kAsLong * eigen.values[2]) break;
    const Vec3 axis = eigen.vectors.col(column);
    double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();
    for (const std::uint32_t i : piece.samples) {
      const double along = samples_[i].point.dot(axis);
      low = std::min(low, along);
      high = std::max(high, along);
    }
    std::pair<Samples, Samples> halves;
    for (const std::uint32_t i : piece.samples) {
      (samples_[i].point.dot(axis) > 0.5 * (low + high) ? halves.first : halves.second).push_back(i);
    }
    if (halves.first.empty() || halves.second.empty()) continue;
    std::pair<Piece, Piece> cut{fit(std::move(halves.first)), fit(std::move(halves.second))};
    halves = {};
    for (const std::uint32_t i : piece.samples) {
      (error_of(i, cut.first.ball) < error_of(i, cut.second.ball) ? halves.first : halves.second).push_back(i);
    }
    if (!halves.first.empty() && !halves.second.empty()) {
      std::pair<Piece, Piece> shared{fit_from(cut.first.ball, std::move(halves.first)),
                                     fit_from(cut.second.ball, std::move(halves.second))};
      if (shared.first.error + shared.second.error < cut.first.error + cut.second.error) cut = std::move(shared);
    }
    if (!best || cut.first.error + cut.second.error < best->first.error + best->second.error) best = std::move(cut);
  }
  return best;
}

}  // namespace spherechain::baker

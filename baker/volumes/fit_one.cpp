// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/volumes/fit_one.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "baker/mesh/decompose.h"

namespace spherechain::baker {
namespace {

using Eigen::VectorXd;

constexpr double kOutsideWeight = 4;

// Where samples lie: their mean and main axes, the longest first, and how far they reach along each.
struct SampleAxes {
  Vec3 mean = Vec3::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();  // from the mean
};

Vec3 mean_of(const std::vector<BodySample>& samples, const std::vector<int>& own) {
  Vec3 mean = Vec3::Zero();
  double area = 0;
  for (const int i : own) {
    const BodySample& sample = samples[static_cast<std::size_t>(i)];
    mean += sample.area * sample.point;
    area += sample.area;
  }
  return mean / area;
}

SampleAxes axes_of(const std::vector<BodySample>& samples, const std::vector<int>& own) {
  SampleAxes out;
  out.mean = mean_of(samples, own);
  out.axes = main_axes(samples, own);
  out.low.setConstant(INFINITY);
  out.high.setConstant(-INFINITY);
  for (const int i : own) {
    const Vec3 local = out.axes.transpose() * (samples[static_cast<std::size_t>(i)].point - out.mean);
    out.low = out.low.cwiseMin(local);
    out.high = out.high.cwiseMax(local);
  }
  return out;
}

// A volume as numbers that least squares may change.
class Numbers {
 public:
  Numbers(VolumeShape shape, const SampleAxes& at)
      : shape_(shape), reach_(std::max((at.high - at.low).norm() / 2, 1e-6)) {}

  VectorXd of(const Volume& volume) {
    if (const auto* ball = std::get_if<BallVolume>(&volume)) {
      return (VectorXd(4) << ball->center, ball->radius).finished();
    }
    if (const auto* cone = std::get_if<ConeVolume>(&volume)) {
      if (shape_ == VolumeShape::kCapsules) return (VectorXd(7) << cone->a, cone->b, cone->radius_a).finished();
      return (VectorXd(8) << cone->a, cone->b, cone->radius_a, cone->radius_b).finished();
    }
    if (const auto* ellipsoid = std::get_if<EllipsoidVolume>(&volume)) {
      turn_ = ellipsoid->rotation;
      return (VectorXd(9) << ellipsoid->center, Vec3::Zero(), ellipsoid->radii).finished();
    }
    const auto& box = std::get<BoxVolume>(volume);
    turn_ = box.rotation;
    return (VectorXd(9) << box.center, Vec3::Zero(), box.half).finished();
  }

  // No radius is below a thousandth of the samples' reach, or above it.
  Volume volume(const VectorXd& x) const {
    const auto size = [&](Eigen::Index i) { return std::clamp(x[i], 1e-3 * reach_, reach_); };
    switch (shape_) {
      case VolumeShape::kSpheres:
        return BallVolume{x.head<3>(), size(3)};
      case VolumeShape::kCapsules:
        return ConeVolume{x.head<3>(), x.segment<3>(3), size(6), size(6)};
      case VolumeShape::kCones:
        return ConeVolume{x.head<3>(), x.segment<3>(3), size(6), size(7)};
      default: {
        const Vec3 v = x.segment<3>(3);
        const Eigen::Quaterniond turn =
            v.norm() > 0 ? Eigen::Quaterniond(Eigen::AngleAxisd(v.norm(), v.normalized())) * turn_ : turn_;
        const Vec3 sizes(size(6), size(7), size(8));
        if (shape_ == VolumeShape::kBoxes) return BoxVolume{x.head<3>(), turn, sizes};
        return EllipsoidVolume{x.head<3>(), turn, sizes};
      }
    }
  }

  // How far each may be changed for a derivative.
  double step() const { return 1e-5 * reach_; }

 private:
  VolumeShape shape_;
  double reach_;
  Eigen::Quaterniond turn_ = Eigen::Quaterniond::Identity();
};

Volume first_guess(VolumeShape shape, const SampleAxes& at, int axis, const std::vector<BodySample>& samples,
                   const std::vector<int>& own) {
  const Vec3 half = (at.high - at.low) / 2;
  const Vec3 center = at.mean + at.axes * (at.high + at.low) / 2;
  if (shape == VolumeShape::kEllipsoids) return EllipsoidVolume{center, Eigen::Quaterniond(at.axes), half};
  if (shape == VolumeShape::kBoxes) return BoxVolume{center, Eigen::Quaterniond(at.axes), half};
  const Vec3 along = at.axes.col(axis);
  double area = 0, around = 0;
  for (const int i : own) {
    const BodySample& sample = samples[static_cast<std::size_t>(i)];
    Vec3 v = sample.point - center;
    if (shape != VolumeShape::kSpheres) v -= along.dot(v) * along;
    area += sample.area;
    around += sample.area * v.norm();
  }
  const double radius = around / area;
  if (shape == VolumeShape::kSpheres) return BallVolume{center, radius};
  const Vec3 end = std::max(half[axis] - radius, 0.1 * half[axis]) * along;
  return ConeVolume{center - end, center + end, radius, radius};
}

class Residuals {
 public:
  Residuals(const BodySkin& skin, const std::vector<int>& own) : skin_(skin), is_own_(skin.samples.size(), false) {
    double area = 0;
    for (const int i : own) {
      is_own_[static_cast<std::size_t>(i)] = true;
      area += skin.samples[static_cast<std::size_t>(i)].area;
    }
    reach_weight_ = std::sqrt(kOutsideWeight * area);
  }

  void of(const Volume& volume, VectorXd& out) const {
    const std::vector<BodySample>& samples = skin_.samples;
    out.resize(static_cast<Eigen::Index>(samples.size() + skin_.reach.size()));
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double distance = signed_distance(volume, samples[i].point);
      const double weight = is_own_[i] ? (distance > 0 ? kOutsideWeight : 1.0) : (distance > 0 ? 0.0 : 1.0);
      out[static_cast<Eigen::Index>(i)] = std::sqrt(samples[i].area * weight) * distance;
    }
    for (std::size_t k = 0; k < skin_.reach.size(); ++k) {
      const Vec3& direction = reach_directions()[k];
      out[static_cast<Eigen::Index>(samples.size() + k)] =
          reach_weight_ * std::max(0.0, direction.dot(support(volume, direction)) - skin_.reach[k]);
    }
  }

 private:
  const BodySkin& skin_;
  std::vector<bool> is_own_;
  double reach_weight_ = 0;
};

// The method of Levenberg and Marquardt with differences for derivatives. Returns the sum of squares.
double descend(Numbers& numbers, const Residuals& residuals, int steps_max, Volume& volume) {
  VectorXd x = numbers.of(volume), at, moved_at;
  residuals.of(volume, at);
  double error = at.squaredNorm(), damping = 1e-2;
  Eigen::MatrixXd slope(at.size(), x.size());
  for (int step = 0; step < steps_max; ++step) {
    for (Eigen::Index k = 0; k < x.size(); ++k) {
      VectorXd moved_x = x;
      moved_x[k] += numbers.step();
      residuals.of(numbers.volume(moved_x), moved_at);
      slope.col(k) = (moved_at - at) / numbers.step();
    }
    const Eigen::MatrixXd normal = slope.transpose() * slope;
    const VectorXd gradient = slope.transpose() * at;
    const double size = std::max(normal.diagonal().maxCoeff(), 1e-300);
    double next_error = error;
    for (; damping < 1e6; damping *= 8) {
      Eigen::MatrixXd damped = normal;
      damped.diagonal() += damping * (normal.diagonal().array() + 1e-6 * size).matrix();
      const Volume next = numbers.volume(x - damped.ldlt().solve(gradient));
      residuals.of(next, moved_at);
      next_error = moved_at.squaredNorm();
      if (!(next_error < error)) continue;
      volume = next;
      break;
    }
    if (!(next_error < error)) break;
    x = numbers.of(volume);
    at = moved_at;
    const bool is_done = next_error > error * (1 - 1e-4);
    error = next_error;
    damping = std::max(damping / 8, 1e-6);
    if (is_done) break;
  }
  return error;
}

bool is_of(VolumeShape shape, const Volume& volume) {
  constexpr std::size_t kIndex[] = {0, 1, 1, 2, 3};
  return volume.index() == kIndex[static_cast<std::size_t>(shape)];
}

}  // namespace

Eigen::Matrix3d main_axes(const std::vector<BodySample>& samples, const std::vector<int>& own) {
  const Vec3 mean = mean_of(samples, own);
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const int i : own) {
    const BodySample& sample = samples[static_cast<std::size_t>(i)];
    const Vec3 v = sample.point - mean;
    spread += sample.area * v * v.transpose();
  }
  const Eigen::Matrix3d vectors = principal_axes(spread).vectors;
  Eigen::Matrix3d out;
  out << vectors.col(2), vectors.col(1), vectors.col(2).cross(vectors.col(1));
  return out;
}

const std::vector<Vec3>& reach_directions() {
  static const std::vector<Vec3> kDirections = [] {
    std::vector<Vec3> out;
    for (int x = -1; x <= 1; ++x) {
      for (int y = -1; y <= 1; ++y) {
        for (int z = -1; z <= 1; ++z) {
          if (x != 0 || y != 0 || z != 0) out.push_back(Vec3(x, y, z).normalized());
        }
      }
    }
    return out;
  }();
  return kDirections;
}

Volume fit_one(VolumeShape shape, const BodySkin& skin, const std::vector<int>& own,
               const std::optional<Volume>& start) {
  constexpr int kStepsMax = 20, kStepsToChoose = 4;
  const SampleAxes at = axes_of(skin.samples, own);
  const Residuals residuals(skin, own);
  if (start && is_of(shape, *start)) {
    Volume out = *start;
    Numbers numbers(shape, at);
    descend(numbers, residuals, kStepsMax, out);
    return out;
  }
  // A stout body's longest axis is not always that of its best capsule.
  const int axes = shape == VolumeShape::kCones || shape == VolumeShape::kCapsules ? 3 : 1;
  Volume best;
  double least = INFINITY;
  for (int axis = 0; axis < axes; ++axis) {
    Numbers numbers(shape, at);
    Volume one = first_guess(shape, at, axis, skin.samples, own);
    const double error = descend(numbers, residuals, kStepsToChoose, one);
    if (error < least || axis == 0) {
      least = error;
      best = one;
    }
  }
  Numbers numbers(shape, at);
  descend(numbers, residuals, kStepsMax, best);
  return best;
}

Volume grown(const Volume& volume, const std::vector<BodySample>& samples, const std::vector<int>& own,
             double coverage) {
  std::vector<std::pair<double, double>> distances;
  for (const int i : own) {
    const BodySample& sample = samples[static_cast<std::size_t>(i)];
    distances.emplace_back(signed_distance(volume, sample.point), sample.area);
  }
  return padded(volume, std::max(weighted_quantile(std::move(distances), coverage), 0.0));
}

}  // namespace spherechain::baker

// SPDX-License-Identifier: MIT
#include "runtime/src/step/approach.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace spherechain {
namespace {

double least_of(double a, double b, double c) { return std::min(a, std::min(b, c)); }
double greatest_of(double a, double b, double c) { return std::max(a, std::max(b, c)); }

// The moves of the corners of triangles a and b along one CornerPaths, relative to each other.
class Pass {
 public:
  explicit Pass(const CornerPaths& way) : way_(way) {
    for (std::size_t k = 0; k < 6; ++k) {
      moves_[k] = way.to.p[k] - way.from.p[k];
    }
    double most = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 3; j < 6; ++j) {
        const Double3 relative = moves_[j] - moves_[i];
        most = std::max(most, dot(relative, relative));
      }
    }
    const double least = way.step / std::sqrt(most);  // infinite where nothing moves
    // The farther the corners move, the longer the least step: this limits the number of times looked at.
    least_step_ = least >= way.shortest ? least : std::min(way.shortest * way.shortest / least, 256 * way.shortest);
  }

  double least_step() const { return least_step_; }

  // The latest time until which a plane is known to part the triangles from `time` on that keeps its direction, one
  // that parts them at `seen`; `time` where there is none. Ends where that is past the limit.
  double open_until(double time, double seen, double limit) const {
    const SixCorners now = way_.at(time), then = way_.at(seen);
    const Double3* const a = then.p;
    const Double3* const b = then.p + 3;
    const Double3 edges_a[3] = {a[1] - a[0], a[2] - a[1], a[0] - a[2]};
    const Double3 edges_b[3] = {b[1] - b[0], b[2] - b[1], b[0] - b[2]};
    const Double3 normal_a = cross(edges_a[0], edges_a[1]), normal_b = cross(edges_b[0], edges_b[1]);
    double latest = time;
    const auto is_past = [&](const Double3& direction) {
      latest = std::max(latest, closing(direction, now, time));
      return latest > limit;
    };
    if (is_past(normal_a) || is_past(normal_b)) {
      return latest;
    }
    for (const Double3& edge_a : edges_a) {
      for (const Double3& edge_b : edges_b) {
        if (is_past(cross(edge_a, edge_b))) {
          return latest;
        }
      }
    }
    for (std::size_t i = 0; i < 3; ++i) {
      if (is_past(cross(normal_a, edges_a[i])) || is_past(cross(normal_b, edges_b[i]))) {
        return latest;
      }
    }
    return latest;
  }

 private:
  // When the gap along the direction is no more than the stray; infinite: never.
  double closing(const Double3& direction, const SixCorners& now, double time) const {
    double at[6], along[6];
    for (std::size_t k = 0; k < 6; ++k) {
      at[k] = dot(direction, now.p[k] - now.p[0]);
      along[k] = dot(direction, moves_[k]);
    }
    const double above = least_of(at[3], at[4], at[5]) - greatest_of(at[0], at[1], at[2]);
    const double below = least_of(at[0], at[1], at[2]) - greatest_of(at[3], at[4], at[5]);
    const double stray = way_.stray > 0 ? way_.stray * length(direction) : 0;
    if (!(above > stray) && !(below > stray)) {
      return time;
    }
    const double sign = above > below ? 1 : -1;
    double until = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 3; j < 6; ++j) {
        const double approach = sign * (along[i] - along[j]);
        if (approach > 0) {
          until = std::min(until, time + (sign * (at[j] - at[i]) - stray) / approach);
        }
      }
    }
    return until;
  }

  const CornerPaths& way_;
  Double3 moves_[6];
  double least_step_;
};

bool is_finite(const SixCorners& corners) {
  double sum = 0;
  for (const Double3& p : corners.p) {
    sum += std::abs(p.x) + std::abs(p.y) + std::abs(p.z);
  }
  return std::isfinite(sum);
}

}  // namespace

SixCorners CornerPaths::at(double t) const {
  if (t >= 1) {
    return to;
  }
  SixCorners out;
  for (std::size_t k = 0; k < 6; ++k) {
    out.p[k] = from.p[k] + t * (to.p[k] - from.p[k]);
  }
  return out;
}

Approach approach(const CornerPaths& way, double limit) {
  if (!is_finite(way.from) || !is_finite(way.to)) {
    return {Outcome::kApart, 1};
  }
  const Pass pass(way);
  const bool is_fine = way.stray <= way.step / 4;
  double time = pass.open_until(0, 0.5, limit);  // most that miss are parted so all the time
  if (time > limit) {
    return {Outcome::kApart, limit};
  }
  for (;;) {
    const double open = pass.open_until(time, time, limit);
    if (open > limit) {
      return {Outcome::kApart, limit};
    }
    if (open - time < pass.least_step()) {
      if (!is_fine) {
        return {Outcome::kTooCoarse, time};
      }
      const SixCorners now = way.at(time);
      if (triangles_intersect(now.triangle(0), now.triangle(3))) {
        return {Outcome::kTouch, time};
      }
    }
    if (time >= 1) {
      return {Outcome::kApart, limit};
    }
    time = std::min(std::max(open, time + pass.least_step()), 1.0);
    if (time > limit) {
      return {Outcome::kApart, limit};
    }
  }
}

}  // namespace spherechain

// SPDX-License-Identifier: MIT
#include "step/approach.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace spherechain {
namespace {

constexpr double kShortest = 1.0 / 65536;

// What the corners of a and of b do to each other.
class Pass {
 public:
  explicit Pass(const Way& way) : way_(way) {
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
    least_step_ = std::max(way.step / std::sqrt(most), kShortest);  // infinite where nothing moves
  }

  double least_step() const { return least_step_; }

  // The latest time until which a plane that parts the triangles at `time`, and keeps its direction, is known to part
  // them; `time` where there is none.
  double open_until(double time, double limit) const {
    const SixCorners now = way_.at(time);
    const Double3* const a = now.p;
    const Double3* const b = now.p + 3;
    const Double3 edges_a[3] = {a[1] - a[0], a[2] - a[1], a[0] - a[2]};
    const Double3 edges_b[3] = {b[1] - b[0], b[2] - b[1], b[0] - b[2]};
    const Double3 normal_a = cross(edges_a[0], edges_a[1]), normal_b = cross(edges_b[0], edges_b[1]);
    double latest = time;
    const auto try_direction = [&](Double3 direction) {
      if (latest <= limit && normalize(direction)) {
        latest = std::max(latest, closing(direction, now, time));
      }
    };
    try_direction(normal_a);
    try_direction(normal_b);
    for (std::size_t i = 0; i < 3 && latest <= limit; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        try_direction(cross(edges_a[i], edges_b[j]));
      }
    }
    for (std::size_t i = 0; i < 3 && latest <= limit; ++i) {
      try_direction(cross(normal_a, edges_a[i]));
      try_direction(cross(normal_b, edges_b[i]));
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
    const double above = std::min({at[3], at[4], at[5]}) - std::max({at[0], at[1], at[2]});
    const double below = std::min({at[0], at[1], at[2]}) - std::max({at[3], at[4], at[5]});
    if (!(above > way_.stray) && !(below > way_.stray)) {
      return time;
    }
    const double sign = above > below ? 1 : -1;
    double until = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 3; j < 6; ++j) {
        const double approach = sign * (along[i] - along[j]);
        if (approach > 0) {
          until = std::min(until, time + (sign * (at[j] - at[i]) - way_.stray) / approach);
        }
      }
    }
    return until;
  }

  const Way& way_;
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

SixCorners Way::at(double t) const {
  if (t >= 1) {
    return to;
  }
  SixCorners out;
  for (std::size_t k = 0; k < 6; ++k) {
    out.p[k] = from.p[k] + t * (to.p[k] - from.p[k]);
  }
  return out;
}

Approach approach(const Way& way, double limit) {
  if (!is_finite(way.from) || !is_finite(way.to)) {
    return {Outcome::kApart, 1};
  }
  const Pass pass(way);
  const bool is_fine = way.stray <= way.step / 4;
  double time = 0;
  for (;;) {
    const double open = pass.open_until(time, limit);
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

// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/score/limmt.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace spherechain::baker {
namespace {

constexpr double kSlide = 1.70, kFast = 44.22, kCollision = 0.17, kUnsteady = 0.28, kGround = 216.62, kAir = 24.19;
constexpr double kFootHeight = 0.05, kFootSpeed = 0.10, kFootTimes = 5, kJointSpeed = 30, kMargin = 0.01,
                 kAirHeight = 0.05, kAirSeconds = 1, kUnsteadyTimes = 0.01;
constexpr int kCollisionsMost = 10;

Eigen::Quaterniond rotation_of(const sc_transform& t) {
  return {double{t.rotation[3]}, double{t.rotation[0]}, double{t.rotation[1]}, double{t.rotation[2]}};
}

// The speeds of all coordinates from one frame to the next: of the root's place, then three angles a joint.
std::vector<double> speeds(const LimmtFrame& from, const LimmtFrame& to, double fps) {
  std::vector<double> out;
  for (std::size_t k = 0; k < 3; ++k) out.push_back((to.root[k] - from.root[k]) * fps);
  for (std::size_t j = 0; j < to.joints.size(); ++j) {
    const Eigen::AngleAxisd turn(rotation_of(from.joints[j]).inverse() * rotation_of(to.joints[j]));
    const double angle = turn.angle() > std::numbers::pi ? turn.angle() - 2 * std::numbers::pi : turn.angle();
    for (int k = 0; k < 3; ++k) out.push_back(angle * fps * turn.axis()[k]);
  }
  return out;
}

// The share of frames in the middle of a second in which the lowest point stays off the ground.
double air_share(const std::vector<LimmtFrame>& frames, double fps) {
  const auto count = static_cast<int>(frames.size()), window = std::max(1, static_cast<int>(kAirSeconds * fps));
  int in_air = 0;
  for (int f = 0; f < count; ++f) {
    const int first = f - window / 2;
    bool flies = first >= 0 && first + window <= count;
    for (int g = first; flies && g < first + window; ++g)
      flies = frames[static_cast<std::size_t>(g)].lowest > kAirHeight;
    in_air += flies ? 1 : 0;
  }
  return static_cast<double>(in_air) / count;
}

}  // namespace

double limmt_score(const std::vector<LimmtFrame>& frames, double fps) {
  if (frames.empty()) return 100;
  double slide = 0, fast = 0, collision = 0, unsteady = 0, ground = 0;
  std::vector<double> before;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const LimmtFrame &now = frames[f], &last = frames[f == 0 ? 0 : f - 1];
    const std::vector<double> speed = speeds(last, now, fps);
    for (std::size_t foot = 0; foot < now.feet.size(); ++foot) {
      if (now.foot_heights[foot] >= kFootHeight) continue;
      const double s = fps * std::hypot(now.feet[foot][0] - last.feet[foot][0], now.feet[foot][1] - last.feet[foot][1]);
      slide += kFootTimes * std::max(0.0, s - kFootSpeed);
    }
    double too_fast = 0, change = 0;
    for (std::size_t k = 0; k < speed.size(); ++k) {
      if (k >= 3) too_fast += std::max(0.0, std::abs(speed[k]) - kJointSpeed);
      if (f > 1) change += std::pow((speed[k] - before[k]) * fps, 2);
    }
    fast += speed.size() > 3 ? too_fast / static_cast<double>(speed.size() - 3) : 0;
    unsteady += kUnsteadyTimes * std::sqrt(change);
    collision += std::min(now.self_collisions, kCollisionsMost);
    ground += std::max(0.0, -now.lowest - kMargin);
    before = speed;
  }
  const double lost = kSlide * slide + kFast * fast + kCollision * collision + kUnsteady * unsteady + kGround * ground;
  return std::max(0.0, 100 - lost / static_cast<double>(frames.size()) - kAir * air_share(frames, fps));
}

}  // namespace spherechain::baker

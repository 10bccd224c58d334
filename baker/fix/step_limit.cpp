// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/step_limit.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace spherechain::baker {
namespace {

constexpr double kTip = 0.06;        // heights from a wrist to the middle of its hand
constexpr double kNearLimit = 0.5;   // share of the limit: smaller steps need no constraint
constexpr double kStepWeight = 3e6;  // of a residual of one height, relative to the cost of a radian at a shoulder

bool has_joint_below(const TurnedClip& clip, Index joint) {
  for (Index j = 0; j < clip.count(); ++j) {
    const std::vector<Index> above = clip.above_joint(j);
    if (j != joint && std::find(above.begin(), above.end(), joint) != above.end()) return true;
  }
  return false;
}

// The middle of what hangs on a limb's last joint, in its axes; zero for other joints.
Vec3 middle_beyond(const TurnedClip& clip, const std::vector<Affine>& axes, Index joint, double height) {
  const std::vector<Index> above = clip.above_joint(joint);
  if (above.size() < 2 || has_joint_below(clip, joint)) return Vec3::Zero();
  const Vec3 out = axes[joint].translation() - axes[above[1]].translation();
  if (out.norm() == 0) return Vec3::Zero();
  return axes[joint].linear().inverse() * (kTip * height / out.norm() * out);
}

std::vector<EndPoint> end_points(const TurnedClip& clip, double height) {
  const std::vector<Affine> axes = clip.pose_of(0, std::vector<Vec3>(clip.count(), Vec3::Zero())).axes;
  std::vector<EndPoint> out;
  for (Index j = 0; j < clip.count(); ++j) out.push_back({j, middle_beyond(clip, axes, j, height)});
  return out;
}

}  // namespace

EndSteps::EndSteps(const TurnedClip& clip, const Turns& turns, double height)
    : height_(height), below_(clip.count()), ends_(end_points(clip, height)) {
  for (std::size_t e = 0; e < ends_.size(); ++e) {
    for (const Index above : clip.above_joint(ends_[e].joint)) below_[above].push_back(e);
  }
  const std::vector<Vec3> none(clip.count(), Vec3::Zero());
  for (int f = 0; f < clip.frames(); ++f) {
    const std::vector<Affine> source = clip.pose_of(f, none).axes, turned = clip.pose(f, turns).axes;
    for (const EndPoint& end : ends_) {
      before_.emplace_back(source[end.joint] * end.own);
      after_.emplace_back(turned[end.joint] * end.own);
    }
  }
}

double EndSteps::extra(std::size_t end, int frame) const {
  if (frame == 0) return 0;
  const Vec3 own = before(end, frame) - before(end, frame - 1), now = after(end, frame) - after(end, frame - 1);
  return (now.norm() - own.norm()) / height_;
}

double EndSteps::moved(Index joint, int frame) const {
  double most = 0;
  for (const std::size_t end : below_[joint]) most = std::max(most, (after(end, frame) - before(end, frame)).norm());
  return most / height_;
}

void add_step_limits(const TurnedClip& clip, double height, const Turns& turns, std::vector<Constraint>& constraints) {
  const EndSteps steps(clip, turns, height);
  for (int f = 1; f < clip.frames(); ++f) {
    std::vector<std::pair<TurnedClip::Pose, std::vector<Vec3>>> poses;  // of both frames; filled where one is needed
    for (std::size_t e = 0; e < steps.ends().size(); ++e) {
      if (steps.extra(e, f) < kNearLimit * EndSteps::kStepTarget) continue;
      for (int g = f - 1; poses.size() < 2; ++g) poses.emplace_back(clip.pose(g, turns), clip.turns_at(g, turns));
      const Vec3 own = steps.before(e, f) - steps.before(e, f - 1), now = steps.after(e, f) - steps.after(e, f - 1);
      Constraint limit;
      limit.weight = 0;
      limit.weight_above = kStepWeight / (height * height);
      limit.target = own.norm() + EndSteps::kStepTarget * height - now.norm();
      for (int k = 0; k < 2; ++k) {
        const auto& [pose, all] = poses[static_cast<std::size_t>(k)];
        for (const Index above : clip.above_joint(steps.ends()[e].joint)) {
          const Eigen::Matrix3d moves = turn_moves(pose.axes[above], steps.after(e, f - 1 + k), all[above]);
          const Vec3 by = (k == 0 ? -1.0 : 1.0) * (moves.transpose() * now.normalized());
          limit.target += by.dot(all[above]);
          limit.terms.push_back({f - 1 + k, above, by});
        }
      }
      constraints.push_back(std::move(limit));
    }
  }
}

}  // namespace spherechain::baker

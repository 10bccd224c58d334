// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/constraints.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace spherechain::baker {
namespace {

// Lengths, in heights.
constexpr double kReach = 0.1;       // distance of the points that a joint carries
constexpr double kStillHand = 3e-3;  // largest motion of a planted hand in kHoldTime
constexpr double kOnGround = 0.03;   // largest height of a planted hand above the clip's lowest ankle
constexpr double kNearHands = 0.25;  // largest distance of hands that hold one thing
constexpr double kSameHandPose = 4e-3;
constexpr double kHoldTime = 0.5;  // seconds
// Weights of a residual of one height, relative to the cost of a radian at a shoulder.
constexpr double kPinnedWeight = 1e7, kJoinedHandsWeight = 1e5;
constexpr double kHingeWeight = 1e5;  // of a residual of one radian

// Three points that a joint carries, in its own axes.
std::array<Vec3, 3> carried(const Affine& axes, double height) {
  const double reach = kReach * height / axes.linear().col(0).norm();
  return {Vec3(0, 0, 0), Vec3(reach, 0, 0), Vec3(0, reach, 0)};
}

// Adds the derivatives of a point's position by the turns of `joint` and of all joints above it.
void add_moves(const TurnedClip& clip, const TurnedClip::Pose& pose, const std::vector<Vec3>& now, Index joint,
               const Vec3& at, double sign, std::array<std::map<Index, Vec3>, 3>& by) {
  for (const Index above : clip.above_joint(joint)) {
    const Eigen::Matrix3d moves = turn_moves(pose.axes[above], at, now[above]);
    for (int axis = 0; axis < 3; ++axis) {
      by[static_cast<std::size_t>(axis)].try_emplace(above, Vec3::Zero()).first->second +=
          sign * moves.row(axis).transpose();
    }
  }
}

void add_constraints(const std::array<std::map<Index, Vec3>, 3>& by, const Vec3& missing, int frame,
                     const std::vector<Vec3>& now, double weight, std::vector<Constraint>& constraints) {
  for (int axis = 0; axis < 3; ++axis) {
    Constraint constraint;
    constraint.weight = constraint.weight_above = weight;
    constraint.target = missing[axis];
    for (const auto& [joint, d] : by[static_cast<std::size_t>(axis)]) {
      constraint.target += d.dot(now[joint]);
      constraint.terms.push_back({frame, joint, d});
    }
    if (!constraint.terms.empty()) constraints.push_back(std::move(constraint));
  }
}

}  // namespace

void add_pinned_joints(const TurnedClip& clip, const std::vector<Index>& joints, int frame, double height,
                       const Turns& turns, std::vector<Constraint>& constraints) {
  if (joints.empty()) return;
  const TurnedClip::Pose pose = clip.pose(frame, turns);
  const TurnedClip::Pose wanted = clip.pose(frame, Turns(turns.size(), Vec3::Zero()));
  const std::vector<Vec3> now = clip.turns_at(frame, turns);
  for (const Index pinned : joints) {
    for (const Vec3& own : carried(pose.axes[pinned], height)) {
      const Vec3 at = pose.axes[pinned] * own, to = wanted.axes[pinned] * own;
      std::array<std::map<Index, Vec3>, 3> by;
      add_moves(clip, pose, now, pinned, at, 1, by);
      add_constraints(by, to - at, frame, now, kPinnedWeight / (height * height), constraints);
    }
  }
}

void add_hand_constraint(const TurnedClip& clip, Index one, Index other, int frame, double height, const Turns& turns,
                         std::vector<Constraint>& constraints) {
  const TurnedClip::Pose pose = clip.pose(frame, turns);
  const TurnedClip::Pose wanted = clip.pose(frame, Turns(turns.size(), Vec3::Zero()));
  const std::vector<Vec3> now = clip.turns_at(frame, turns);
  const Affine seen = wanted.axes[other].inverse() * wanted.axes[one];
  for (const Vec3& own : carried(pose.axes[one], height)) {
    const Vec3 at = pose.axes[one] * own, to = pose.axes[other] * (seen * own);
    std::array<std::map<Index, Vec3>, 3> by;
    add_moves(clip, pose, now, one, at, 1, by);
    add_moves(clip, pose, now, other, to, -1, by);
    add_constraints(by, to - at, frame, now, kJoinedHandsWeight / (height * height), constraints);
  }
}

void add_hinge_limits(const TurnedClip& clip, const std::vector<Index>& joints, int frame,
                      std::vector<Constraint>& constraints) {
  for (const Index below : joints) {
    for (const Index joint : clip.above_joint(below)) {
      const std::optional<Hinge>& hinge = clip.joints()[joint].hinge;
      if (!hinge) continue;
      const double bend = clip.bend(frame, joint);
      constraints.push_back({{{frame, joint, hinge->axis}}, hinge->min_bend - bend, kHingeWeight, 0});
      constraints.push_back({{{frame, joint, -hinge->axis}}, bend - hinge->max_bend, kHingeWeight, 0});
    }
  }
}

std::vector<std::vector<Index>> planted_hands(const TurnedClip& clip, const std::vector<Index>& hands,
                                              const std::vector<Index>& feet, const Vec3& up, double height) {
  const auto frames = static_cast<std::size_t>(clip.frames());
  std::vector<std::vector<Index>> out(frames);
  if (feet.empty() || hands.empty()) return out;
  const Turns none(frames * clip.count(), Vec3::Zero());
  std::vector<std::vector<Vec3>> places(hands.size());
  double ground = HUGE_VAL;
  for (int f = 0; f < clip.frames(); ++f) {
    const TurnedClip::Pose pose = clip.pose(f, none);
    for (const Index foot : feet) ground = std::min(ground, up.dot(pose.axes[foot].translation()));
    for (std::size_t h = 0; h < hands.size(); ++h) places[h].push_back(pose.axes[hands[h]].translation());
  }
  const auto reach = static_cast<std::size_t>(std::ceil(kHoldTime / 2 * clip.fps()));
  for (std::size_t h = 0; h < hands.size(); ++h) {
    for (std::size_t f = 0; f < frames; ++f) {
      bool stands = up.dot(places[h][f]) < ground + kOnGround * height;
      for (std::size_t g = f - std::min(f, reach); stands && g <= std::min(f + reach, frames - 1); ++g) {
        stands = (places[h][g] - places[h][f]).norm() < kStillHand * height;
      }
      if (stands) out[f].push_back(hands[h]);
    }
  }
  return out;
}

std::vector<char> frames_with_joined_hands(const TurnedClip& clip, Index one, Index other, double height) {
  const auto frames = static_cast<std::size_t>(clip.frames());
  const Turns none(frames * clip.count(), Vec3::Zero());
  std::vector<std::array<Vec3, 3>> seen;  // points of one, as the other sees them, in the rest pose's lengths
  for (int f = 0; f < clip.frames(); ++f) {
    const TurnedClip::Pose pose = clip.pose(f, none);
    const double scale = pose.axes[other].linear().col(0).norm();
    seen.emplace_back();
    std::size_t k = 0;
    for (const Vec3& own : carried(pose.axes[one], height)) {
      seen.back()[k++] = scale * (pose.axes[other].inverse() * (pose.axes[one] * own));
    }
  }
  const auto reach = static_cast<std::size_t>(std::ceil(kHoldTime / 2 * clip.fps()));
  std::vector<char> out(frames, 0);
  for (std::size_t f = 0; f < frames; ++f) {
    bool holds = seen[f][0].norm() < kNearHands * height;
    for (std::size_t g = f - std::min(f, reach); holds && g <= std::min(f + reach, frames - 1); ++g) {
      for (std::size_t k = 0; k < 3; ++k) holds &= (seen[g][k] - seen[f][k]).norm() < kSameHandPose * height;
    }
    out[f] = holds ? 1 : 0;
  }
  return out;
}

}  // namespace spherechain::baker

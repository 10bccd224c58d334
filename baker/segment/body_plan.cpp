// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/segment/body_plan.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "baker/mesh/decompose.h"
#include "baker/segment/branches.h"

namespace spherechain::baker {
namespace {

// Fingers are 4 % of the tree's longest path (hand to foot), a head is 14 %.
constexpr double kBranchLengthMin = 0.07;
// Cosine from which a direction tells one way along an axis from the other.
constexpr double kAlong = 0.3;

Polyline join(const Polyline& a, const Polyline& b) {
  std::vector<Vec3> points = a.points();
  points.insert(points.end(), b.points().begin(), b.points().end());
  return Polyline(std::move(points));
}

// The curves from `node` to every tip that is reached without branch `barred`.
void collect_tips(const BranchTree& tree, Index node, Index barred, const Polyline& so_far,
                  std::vector<Polyline>& out) {
  for (const Index b : tree.at[node]) {
    if (b == barred) continue;
    const BranchTree::Branch& branch = tree.branches[b];
    const bool forward = branch.from == node;
    const Polyline line = join(so_far, forward ? branch.line : branch.line.reversed());
    const Index end = forward ? branch.to : branch.from;
    if (tree.is_tip(end)) {
      out.push_back(line);
    } else {
      collect_tips(tree, end, b, line, out);
    }
  }
}

// The tree cut at one inner branch.
struct Split {
  Polyline spine;               // from the side of `lower` to the side of `upper`
  std::vector<Polyline> lower;  // from the spine's ends to the tips
  std::vector<Polyline> upper;
};

// The longest inner branch with the given number of tips on either side.
std::optional<Split> split_tree(const BranchTree& tree, std::size_t lower, std::size_t upper) {
  std::optional<Split> best;
  for (Index b = 0; b < tree.branches.size(); ++b) {
    const BranchTree::Branch& branch = tree.branches[b];
    if (tree.is_tip(branch.from) || tree.is_tip(branch.to)) continue;
    for (const bool forward : {true, false}) {
      const Index low = forward ? branch.from : branch.to, high = forward ? branch.to : branch.from;
      Split split{forward ? branch.line : branch.line.reversed(), {}, {}};
      collect_tips(tree, low, b, Polyline(), split.lower);
      collect_tips(tree, high, b, Polyline(), split.upper);
      if (split.lower.size() == lower && split.upper.size() == upper &&
          (!best || split.spine.length() > best->spine.length())) {
        best = std::move(split);
      }
    }
  }
  return best;
}

Vec3 chord(const Polyline& line) { return line.points().back() - line.points().front(); }

// Cosine between a branch and the direction in which the spine leaves towards it.
double alignment(const Polyline& branch, const Vec3& outward) {
  return chord(branch).normalized().dot(outward.normalized());
}

// Where the toes are from the ankle: the last tenth of each leg against its middle.
Vec3 toe_direction(const std::vector<const Polyline*>& legs) {
  Vec3 sum = Vec3::Zero();
  for (const Polyline* leg : legs) sum += leg->points().back() - leg->at(0.85 * leg->length());
  return sum;
}

// Axes from up and a lateral axis of unknown sign.
BodyFrame orient(const Vec3& up_roughly, const Vec3& lateral, const Vec3& towards_front) {
  BodyFrame frame;
  frame.left = lateral.normalized();
  frame.up = (up_roughly - up_roughly.dot(frame.left) * frame.left).normalized();
  frame.forward = frame.left.cross(frame.up);
  if (frame.forward.dot(towards_front) < 0) {
    frame.left = -frame.left;
    frame.forward = -frame.forward;
  }
  return frame;
}

void place(BodyFrame& frame, const Mesh& mesh) {
  double low = mesh.positions[0].dot(frame.up), high = low;
  for (const Vec3& p : mesh.positions) {
    low = std::min(low, p.dot(frame.up));
    high = std::max(high, p.dot(frame.up));
  }
  const Vec3 centroid = surface_centroid(mesh);
  frame.height = high - low;
  frame.origin = centroid + (low - centroid.dot(frame.up)) * frame.up;
}

Reason no_biped(const std::string& what) {
  return {what + " (a biped has five long branches: head, two arms, two legs)"};
}

// Which of the five branches is missing from a tree with four tips.
Reason missing_branch(const BranchTree& tree, const std::optional<Vec3>& facing) {
  if (std::optional<Split> split = split_tree(tree, 2, 2)) {
    const auto legs_like = [](const std::vector<Polyline>& side, const Vec3& outward) {
      return alignment(side[0], outward) > 0.5 && alignment(side[1], outward) > 0.5;
    };
    if (!legs_like(split->lower, -chord(split->spine))) {
      std::swap(split->lower, split->upper);
      split->spine = split->spine.reversed();
    }
    const Vec3 up = chord(split->spine);
    if (legs_like(split->lower, -up)) {
      std::vector<Polyline>& top = split->upper;
      if (alignment(top[0], up) > alignment(top[1], up)) std::swap(top[0], top[1]);
      if (alignment(top[1], up) < 0.5)
        return no_biped("the head is missing: nothing goes on from the chest but two arms");
      const Polyline &arm = top[0], &leg_a = split->lower[0], &leg_b = split->lower[1];
      const Vec3 across = leg_a.points().back() - leg_b.points().back();
      const BodyFrame frame = orient(up, across, facing.value_or(toe_direction({&leg_a, &leg_b})));
      const bool left = (arm.points().back() - split->spine.points().back()).dot(frame.left) > 0;
      return no_biped(std::string("the ") + (left ? "right" : "left") + " arm is missing");
    }
  }
  // One junction, or no pair of legs: the longest branch runs through the torso into the only leg.
  for (Index node = 0; node < tree.at.size(); ++node) {
    if (tree.at[node].size() < 3) continue;
    std::vector<Polyline> branches;
    collect_tips(tree, node, kNoIndex, Polyline(), branches);
    std::sort(branches.begin(), branches.end(), [](const auto& a, const auto& b) { return a.length() > b.length(); });
    const Polyline& leg = branches.front();
    const Vec3 up = -chord(leg);
    std::vector<Polyline> others(branches.begin() + 1, branches.end());
    std::sort(others.begin(), others.end(),
              [&](const auto& a, const auto& b) { return alignment(a, up) < alignment(b, up); });
    const Vec3 across = others[0].points().back() - others[1].points().back();
    const BodyFrame frame = orient(up, across, facing.value_or(toe_direction({&leg})));
    const Vec3 middle = 0.5 * (others[0].points().back() + others[1].points().back());
    const bool left = (leg.points().back() - middle).dot(frame.left) > 0;
    return no_biped(std::string("the ") + (left ? "right" : "left") + " leg is missing");
  }
  return no_biped("one of the long branches is missing: four are there");
}

}  // namespace

BodyFrame with_up(BodyFrame frame, const Vec3& up, const Mesh& mesh) {
  frame.up = (up - up.dot(frame.left) * frame.left).normalized();
  frame.forward = frame.left.cross(frame.up);
  place(frame, mesh);
  return frame;
}

Vec3 lateral_axis(const Mesh& mesh, const Vec3& roughly) {
  const Vec3 centroid = surface_centroid(mesh);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3 d = triangle_centroid(mesh, t) - centroid;
    covariance += triangle_area(mesh, t) * d * d.transpose();
  }
  const PrincipalAxes axes = principal_axes(covariance);
  const Vec3 tips = roughly.normalized();
  for (int k = 0; k < 3; ++k) {
    const Vec3 axis = axes.vectors.col(k);
    if (std::abs(axis.dot(tips)) > 0.95) return axis.dot(tips) > 0 ? axis : Vec3(-axis);
  }
  return tips;
}

std::size_t count_ends(const CurveSkeleton& skeleton) {
  return find_long_branches(skeleton, kBranchLengthMin).tip_count();
}

bool looks_like_biped(const CurveSkeleton& skeleton) {
  const BranchTree tree = find_long_branches(skeleton, kBranchLengthMin);
  const std::optional<Split> split = tree.tip_count() == 5 ? split_tree(tree, 2, 3) : std::nullopt;
  constexpr double kGoesOn = 0.5;
  return split && std::all_of(split->lower.begin(), split->lower.end(),
                              [&](const Polyline& leg) { return alignment(leg, -chord(split->spine)) > kGoesOn; });
}

std::optional<Reason> check_facing(const std::optional<Vec3>& facing, const Vec3& axis, const char* name) {
  if (!facing || std::abs(facing->stableNormalized().dot(axis.normalized())) >= kAlong) return std::nullopt;
  return Reason{std::string("the facing direction in the settings is not along the character's ") + name +
                    " (mend 'facing', or leave it out)",
                Reason::Cause::kSettings};
}

Attempt<BodyPlan> find_biped_plan(const Mesh& mesh, const CurveSkeleton& skeleton, const std::optional<Vec3>& facing) {
  const BranchTree tree = find_long_branches(skeleton, kBranchLengthMin);
  const std::size_t tips = tree.tip_count();
  if (tips == 4) return missing_branch(tree, facing);
  if (tips < 4) return no_biped("arms or legs are missing: the shape has " + std::to_string(tips) + " ends");
  if (tips > 5) return no_biped("the shape has " + std::to_string(tips) + " long branches, which is no biped");
  std::optional<Split> split = split_tree(tree, 2, 3);
  if (!split) {
    return no_biped("the branches do not leave a torso: there is no hip with two legs and no chest with two arms");
  }

  const Vec3 up = chord(split->spine);
  std::vector<Polyline>& top = split->upper;
  std::sort(top.begin(), top.end(), [&](const auto& a, const auto& b) { return alignment(a, up) < alignment(b, up); });
  std::vector<Polyline>& legs = split->lower;

  Vec3 across_arms = top[0].points().back() - top[1].points().back();
  const Vec3 across_legs = legs[0].points().back() - legs[1].points().back();
  if (across_arms.dot(across_legs) < 0) across_arms = -across_arms;

  BodyPlan plan;
  const Vec3 toes = toe_direction({&legs[0], &legs[1]});
  plan.frame =
      orient(up, lateral_axis(mesh, across_arms.normalized() + across_legs.normalized()), facing.value_or(toes));
  plan.facing = facing ? "forward is the direction in the settings" : "forward is where the feet point";
  if (auto reason = check_facing(facing, plan.frame.forward, "forward axis")) return *reason;
  if (!facing && std::abs(plan.frame.forward.dot(toes.normalized())) < kAlong) {
    return Reason{"the feet do not say which way the character faces (set 'facing' in the settings)"};
  }
  place(plan.frame, mesh);
  plan.spine = split->spine;
  plan.head = top[2];
  const auto is_left = [&](const Polyline& line) {
    return (line.points().back() - plan.frame.origin).dot(plan.frame.left);
  };
  const bool arm0_left = is_left(top[0]) > is_left(top[1]), leg0_left = is_left(legs[0]) > is_left(legs[1]);
  plan.limbs = {{kRegionNames[0], Side::kLeft, 1, top[arm0_left ? 0 : 1]},
                {kRegionNames[1], Side::kRight, 1, top[arm0_left ? 1 : 0]},
                {kRegionNames[2], Side::kLeft, 0, legs[leg0_left ? 0 : 1]},
                {kRegionNames[3], Side::kRight, 0, legs[leg0_left ? 1 : 0]}};
  return plan;
}

}  // namespace spherechain::baker
